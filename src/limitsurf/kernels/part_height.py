r"""Where a part floats on two oscillating tips: mean normal force = weight carried.

The tip at the lever x [m] (positive to the right of the rod) reaches
:math:`z + x\vartheta_0 + |x| A` at its peak. A part whose underside is q below the highest peak
is penetrated by each tip by q less the distance of the two peaks. The sum of the mean forces is
convex and increases with q, so Newton's method started above the root comes down to it.
"""

from __future__ import annotations

from typing import NamedTuple

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.tip_contact import ContactLaw, Push, tip_averages

__all__ = ["Float", "Tips", "float_part"]


class Tips(NamedTuple):
    """Levers (right > 0, left < 0) and heights above the rod at rest of the two tips [m]."""

    right: float
    left: float
    right_height: float
    left_height: float


class Float(NamedTuple):
    """How the part floats.

    `ok` is false if a tip would never leave the part; `height` of its underside above the rod,
    penetrations at the two peaks [m]; the averages of the two tips, each in the phase of its own
    height.
    """

    ok: bool
    height: float
    right_depth: float
    left_depth: float
    right: Push
    left: Push


@compiled
def _at_depth(tips: Tips, tilt: float, amplitude: float, law: ContactLaw, depth: float) -> Float:
    """Return the state for a penetration of the highest peak, whether or not it carries."""
    a_right, a_left = tips.right * amplitude, -tips.left * amplitude
    top_right = tips.right_height + tips.right * tilt + a_right
    top_left = tips.left_height + tips.left * tilt + a_left
    height = max(top_right, top_left) - depth
    in_right = depth - max(top_left - top_right, 0.0)  # not top - height: light touches keep digits
    in_left = depth - max(top_right - top_left, 0.0)
    return Float(
        in_right <= 2.0 * a_right and in_left <= 2.0 * a_left,
        height,
        in_right,
        in_left,
        tip_averages(law, a_right, in_right),
        tip_averages(law, a_left, in_left),
    )


@compiled
def float_part(tips: Tips, tilt: float, amplitude: float, law: ContactLaw, load: float) -> Float:
    """Return how a load [N] floats on tips that swing by `amplitude` about `tilt` [rad]."""
    depth = 2.0 * amplitude * max(tips.right, -tips.left)
    state = _at_depth(tips, tilt, amplitude, law, depth)
    for i in range(60):
        excess = state.right.mean + state.left.mean - load
        if i == 0 and excess < 0.0:
            return Float(
                False,
                state.height,
                state.right_depth,
                state.left_depth,
                state.right,
                state.left,
            )
        step = excess / (state.right.slope + state.left.slope)
        if not step > 2e-16 * depth:
            return state
        depth = depth - step
        state = _at_depth(tips, tilt, amplitude, law, depth)
    return state
