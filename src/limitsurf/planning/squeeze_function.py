"""The squeeze function of a part (paper, Lemma 6): where each orientation comes to rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.planning.turn_function import TurnFunction
from limitsurf.tolerances import ANGLE

__all__ = ["SqueezeFunction", "squeeze_function"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SqueezeFunction:
    """A step function on the orientations modulo pi: ``[breaks[i], breaks[i+1]) -> images[i]``.

    Attributes
    ----------
    breaks : (k,) float
        Unstable orientations, ascending in [0, pi) [rad]; the last step ends at
        ``breaks[0] + pi``. Empty for a neutral part, which stays as it is.
    images : (k,) float
        Stable orientations, ``breaks[i] < images[i]``, not reduced modulo pi [rad].
    period : float
        The smallest turn that leaves the function unchanged [rad]: squeezing cannot tell
        orientations apart that differ by it.
    """

    breaks: Array
    images: Array
    period: float

    def __call__(self, phi: ArrayLike) -> Array:
        """Return the orientation after a squeeze towards a line at world angle 0, in [0, pi)."""
        reduced = np.mod(np.asarray(phi, dtype=np.float64), np.pi)
        if len(self.breaks) == 0:
            return reduced
        step = np.searchsorted(self.breaks, reduced, side="right") - 1  # -1: the last step
        return np.mod(self.images[step], np.pi)

    @property
    def ends(self) -> Array:
        """Right ends of the steps."""
        return np.append(self.breaks[1:], self.breaks[:1] + np.pi)

    def __repr__(self) -> str:
        """Return the steps in degrees."""
        steps = ", ".join(
            f"[{a:.2f}, {b:.2f}) -> {s:.2f}"
            for a, b, s in np.degrees(np.column_stack([self.breaks, self.ends, self.images]))
        )
        return f"SqueezeFunction({steps or 'identity'}; period {np.degrees(self.period):.4g} deg)"


def squeeze_function(turn: TurnFunction) -> SqueezeFunction:
    """Return the squeeze function that belongs to a turn function.

    Parameters
    ----------
    turn : TurnFunction
        From `turn_function`.

    Examples
    --------
    >>> from limitsurf.planning.turn_function import turn_function
    >>> from limitsurf.geometry.part import Part
    >>> squeeze_function(turn_function(Part([(0, 0), (2, 0), (2, 1), (0, 1)])))
    SqueezeFunction([90.00, 270.00) -> 180.00; period 180 deg)
    """
    if turn.neutral:
        return SqueezeFunction(np.empty(0), np.empty(0), np.pi)
    before_first = turn.stable < turn.unstable[0]
    images = np.sort(np.where(before_first, turn.stable + np.pi, turn.stable))
    return SqueezeFunction(turn.unstable, images, _period(turn.unstable, images))


def _period(breaks: Array, images: Array) -> float:
    """Return the smallest pi/d under which the steps map onto one another."""
    k = len(breaks)
    for copies in range(k, 1, -1):
        if k % copies:
            continue
        shift, turn = k // copies, np.pi / copies
        same = all(
            np.max(np.abs(np.append(x[shift:], x[:shift] + np.pi) - x - turn)) <= ANGLE
            for x in (breaks, images)
        )
        if same:
            return float(turn)
    return float(np.pi)
