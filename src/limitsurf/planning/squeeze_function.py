"""The squeeze function of a part (paper, Lemma 6): where each orientation comes to rest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_numbers
from limitsurf.tolerances import ANGLE

__all__ = [
    "LEAST_DIFFERENCE",
    "SqueezeFunction",
    "smallest_period",
    "spread_of_copies",
    "squeeze_function",
]

Array = NDArray[np.float64]

#: Steps of a part that is symmetric are one if they differ by less than this times what its copies
#: differ by: a plan must not rely on differences as small as the errors of the steps.
LEAST_DIFFERENCE = 8.0
_TRIPLE = 1e-4  # rad; triple roots of U', where two equilibria merge, are known to about 1e-5


@dataclass(frozen=True, eq=False)
class SqueezeFunction:
    """A step function on orientations: ``[breaks[i], ends[i]) -> images[i]``.

    Attributes
    ----------
    breaks, ends : (k,) float
        Left and right ends of the steps, ascending, the first in [0, modulus) [rad]. Where a step
        ends before the next one begins, starts between the two may come to either image; a step
        that ends before it begins is sure of no start, but its image counts in every arc across
        it. Empty for a neutral part, which stays as it is.
    images : (k,) float
        Orientations at rest, in the order of the steps, not reduced [rad].
    period : float
        The smallest turn that leaves the function unchanged [rad]: squeezing cannot tell
        orientations apart that differ by it.
    modulus : float
        Orientations count modulo this [rad]: pi towards a line without direction, 2 pi where the
        part comes from a known side of the line.
    """

    breaks: Array
    ends: Array
    images: Array
    period: float
    modulus: float = np.pi

    @property
    def steps(self) -> int:
        """Number of steps in one period."""
        return round(len(self.breaks) * self.period / self.modulus)

    def __call__(self, phi: ArrayLike) -> Array:
        """Return the orientation after a squeeze towards a line at world angle 0, reduced.

        Between two steps, where either image may come, that of the step before.
        """
        return np.mod(self.follow(phi), self.modulus)

    def follow(self, phi: ArrayLike) -> Array:
        """Return the orientation after a squeeze, not reduced: phi and how far the part turns."""
        start = as_numbers("phi", phi)
        if len(self.breaks) == 0:
            return start
        turns = self.modulus * np.floor((start - self.breaks[0]) / self.modulus)
        step = np.searchsorted(self.breaks, start - turns, side="right") - 1
        return np.asarray(self.images[np.maximum(step, 0)] + turns)

    def __repr__(self) -> str:
        """Return the steps in degrees."""
        steps = ", ".join(
            f"[{a:.2f}, {b:.2f}) -> {s:.2f}"
            for a, b, s in np.degrees(np.column_stack([self.breaks, self.ends, self.images]))
        )
        return f"SqueezeFunction({steps or 'identity'}; period {np.degrees(self.period):.4g} deg)"


class EquilibriaOfSqueeze(Protocol):
    """What a squeeze function is made from: a turn function or a diameter function."""

    @property
    def stable(self) -> Array:
        """Stable orientations, ascending in [0, pi)."""

    @property
    def unstable(self) -> Array:
        """Unstable orientations, ascending in [0, pi), as many."""

    @property
    def neutral(self) -> bool:
        """Whether there are neither."""

    @property
    def symmetry_order(self) -> int:
        """Order of the part's rotational symmetry."""


def squeeze_function(turn: EquilibriaOfSqueeze) -> SqueezeFunction:
    """Return the squeeze function that belongs to a turn function.

    Parameters
    ----------
    turn : TurnFunction or DiameterFunction
        From `turn_function` or `diameter_function`; anything else is an InputError.

    Examples
    --------
    >>> from limitsurf.planning.turn_function import turn_function
    >>> from limitsurf.geometry.part import Part
    >>> squeeze_function(turn_function(Part([(0, 0), (2, 0), (2, 1), (0, 1)])))
    SqueezeFunction([90.00, 270.00) -> 180.00; period 180 deg)
    """
    if not hasattr(turn, "unstable"):
        raise InputError(
            "turn", "is no turn function", value=turn, remedy="give turn_function(part)"
        )
    if turn.neutral:
        return SqueezeFunction(np.empty(0), np.empty(0), np.empty(0), np.pi)
    before_first = turn.stable < turn.unstable[0]
    images = np.sort(np.where(before_first, turn.stable + np.pi, turn.stable))
    ends = np.append(turn.unstable[1:], turn.unstable[:1] + np.pi)
    steps = turn.unstable, ends, images
    period, rough = (smallest_period(*steps, np.pi, tolerance) for tolerance in (ANGLE, _TRIPLE))
    if rough < period:  # if the part is symmetric, the steps are, however well they are known
        order = turn.symmetry_order
        copies = math.gcd(round(np.pi / rough), order if order % 2 else order // 2)
        unsure = LEAST_DIFFERENCE * spread_of_copies(*steps, np.pi, copies)
        period = smallest_period(*steps, np.pi, max(ANGLE, unsure))
    return SqueezeFunction(*steps, period)


def smallest_period(
    breaks: Array, ends: Array, images: Array, modulus: float, tolerance: float = ANGLE
) -> float:
    """Return the smallest ``modulus / d`` under which the steps map onto one another.

    Each divisor d of their number costs one pass over the steps. Two steps whose places differ by
    at most `tolerance` are taken for images of one another.
    """
    k = len(breaks)
    for copies in range(k, 1, -1):
        if k % copies:
            continue
        if spread_of_copies(breaks, ends, images, modulus, copies) <= tolerance:
            return float(modulus / copies)
    return float(modulus)


def spread_of_copies(
    breaks: Array, ends: Array, images: Array, modulus: float, copies: int
) -> float:
    """Return how far the steps are from mapping onto one another under ``modulus / copies``.

    `copies` divides their number.
    """
    shift, turn = len(breaks) // copies, modulus / copies
    return max(
        float(np.max(np.abs(np.append(x[shift:], x[:shift] + modulus) - x - turn)))
        for x in (breaks, ends, images)
    )
