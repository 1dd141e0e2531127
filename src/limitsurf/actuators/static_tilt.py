r"""Tilt of a resonator under a constant voltage on one side, and its pull-in.

The torque :math:`V^2 f(\vartheta)` grows as the gap closes; equilibrium :math:`k\vartheta =
V^2 f(\vartheta)` has a stable root up to the voltage :math:`V_p^2 = \max k\vartheta/f(\vartheta)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.constants import epsilon_0
from scipy.optimize import brentq, minimize_scalar

from limitsurf.errors import BeyondPullIn, InputError
from limitsurf.kernels.rim_torque import RimSide, rim_shape
from limitsurf.sets.arguments import as_number

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["equilibrium", "pull_in", "torque"]


def _side(resonator: TorsionalResonator) -> tuple[RimSide, float]:
    """Return the side that goes down and the sign of the tilt that lowers it."""
    right, left = resonator.levers
    down = resonator.driven == "+x"
    lever = right if down else left
    return RimSide(lever, resonator.grid_length, resonator.clearance), -1.0 if down else 1.0


def _checked(voltage: float) -> float:
    volts = as_number("voltage", voltage)
    if not (np.isfinite(volts) and volts >= 0.0):
        raise InputError("voltage", "must be finite and not negative", value=voltage)
    return volts


def torque(resonator: TorsionalResonator, voltage: float, tilt: float = 0.0) -> float:
    """Return the torque [N m] on the grid at a tilt [rad]; positive raises +x."""
    side, sign = _side(resonator)
    if not sign * as_number("tilt", tilt) * side.lever < side.gap:
        raise InputError("tilt", "puts the edge beyond its electrode", value=tilt)
    strength = 0.5 * epsilon_0 * resonator.effective_width * _checked(voltage) ** 2
    return float(sign * strength * rim_shape(side, -sign * tilt))


def _pull_in(resonator: TorsionalResonator) -> tuple[float, float]:
    """Return the share of the gap that is left open to the stable tilt, and the voltage [V]."""
    side, _ = _side(resonator)
    strength = 0.5 * epsilon_0 * resonator.effective_width

    def square(share: float) -> float:
        tilt = share * side.gap / side.lever
        return float(resonator.stiffness * tilt / (strength * rim_shape(side, -tilt)))

    best = minimize_scalar(
        lambda u: -square(u), bounds=(1e-6, 1 - 1e-9), method="bounded", options={"xatol": 1e-12}
    )
    return float(best.x), float(np.sqrt(square(best.x)))


def pull_in(resonator: TorsionalResonator) -> float:
    """Return the pull-in voltage [V]."""
    return _pull_in(resonator)[1]


def equilibrium(resonator: TorsionalResonator, voltage: float) -> float:
    """Return the stable tilt [rad] at a constant voltage [V].

    Raises
    ------
    BeyondPullIn
        There is none.

    Examples
    --------
    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> one = TorsionalResonator.from_model("resonator1994")
    >>> round(1e9 * equilibrium(one, 50.0) * one.levers[1])  # nm at the edge
    17
    """
    _checked(voltage)
    share, limit = _pull_in(resonator)
    if voltage >= limit:
        raise BeyondPullIn(voltage, limit)
    side, sign = _side(resonator)
    strength = 0.5 * epsilon_0 * resonator.effective_width * voltage**2

    def excess(tilt: float) -> float:
        return float(resonator.stiffness * tilt - strength * rim_shape(side, -tilt))

    return float(sign * brentq(excess, 0.0, share * side.gap / side.lever, xtol=1e-18))
