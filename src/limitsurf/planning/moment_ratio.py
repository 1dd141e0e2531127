r"""How strongly a squeeze field turns a part: the moment over the potential, and where it is sure.

Every error of an array adds to the moment U' of a squeeze field. Over the potential U it is an
angle-like number, the tangent of the error of direction that would do the same. With a direction
off by eps and a moment known to plus or minus w U, a part surely turns one way where
``|U'/U - tan eps| > w``; elsewhere it may rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.planning.turn_function import TurnFunction

__all__ = ["MomentRatio", "Zones"]

Array = NDArray[np.float64]

_GRID = 1440  # orientations, beside equilibria and breakpoints, between which levels are crossed
_NARROW = 1e-9  # half-width [1] that stands for an exactly known moment
_HALVINGS = 55


@dataclass(frozen=True, eq=False)
class Zones:
    """Cells of orientations ``[borders[j], borders[j + 1])`` with the sign of the sure turn.

    Attributes
    ----------
    borders : (c,) float
        Ascending, within half a turn [rad]; the last cell ends at ``borders[0] + pi``.
    signs : (c,) int
        1 where the part surely turns counter-clockwise, -1 clockwise, 0 where it may rest;
        neighbours differ.
    """

    borders: Array
    signs: NDArray[np.int64]

    def cell(self, j: int) -> tuple[float, float]:
        """Return a cell's ends; numbers beyond the last cell are half a turn further."""
        count = len(self.borders)
        ends = [self.borders[i % count] + np.pi * (i // count) for i in (j, j + 1)]
        return float(ends[0]), float(ends[1])

    def sign(self, j: int) -> int:
        """Return a cell's sign; numbers count on beyond the last cell."""
        return int(self.signs[j % len(self.signs)])

    def cell_of(self, phi: float) -> int:
        """Return the number of the cell that holds an orientation, reduced or not."""
        turns = int(np.floor((phi - self.borders[0]) / np.pi))
        inside = int(np.searchsorted(self.borders, phi - np.pi * turns, side="right")) - 1
        return inside + turns * len(self.borders)

    @cached_property
    def has_unstable(self) -> bool:
        """Whether parts surely turn away to both sides of some cell."""
        return any(self._is_unstable(j) for j in range(len(self.signs)))

    def source_of(self, phi: float) -> tuple[float, float]:
        """Return the unstable cell from which a part would come that is at an orientation now.

        That is where an unstable orientation went, if errors moved it. Cells where the part may
        rest but which it leaves as it came are passed; from a stable one go on to the right.
        """
        j = self.cell_of(phi)
        while not self._is_unstable(j):
            turn = self.sign(j) or self.sign(j + 1)
            j -= turn or 1
        return self.cell(j)

    def _is_unstable(self, j: int) -> bool:
        return self.sign(j) == 0 and self.sign(j - 1) < 0 < self.sign(j + 1)

    def rest_between(self, left: float, right: float) -> tuple[float, float] | None:
        """Return the hull of the cells between two orientations where the part may rest."""
        first, last = self.cell_of(left), self.cell_of(right)
        cells = [self.cell(j) for j in range(first, last + 1) if self.sign(j) == 0]
        inside = [c for c in cells if c[0] >= left and c[1] <= right]
        return (inside[0][0], inside[-1][1]) if inside else None


@dataclass(frozen=True, eq=False)
class MomentRatio:
    """``U'/U`` at orientations of a part; see the head of this file.

    Attributes
    ----------
    turn : TurnFunction
        The part's turn function; not neutral.
    """

    turn: TurnFunction

    def __call__(self, phi: ArrayLike) -> Array:
        """Return U'/U [1]; positive where the part turns counter-clockwise."""
        return np.asarray(self.turn.moment(phi) / self.turn.potential(phi))

    @cached_property
    def _samples(self) -> tuple[Array, Array]:
        turn = self.turn
        known = np.concatenate([turn.stable, turn.unstable, turn.breakpoints])
        phi = np.unique(np.concatenate([np.linspace(0.0, np.pi, _GRID), known]))
        return phi, self(phi)

    def zones(self, tangent: float, width: float) -> Zones:
        """Return where the part surely turns, with ``tan eps`` and half-width of the ratio [1]."""
        half = max(width, _NARROW)
        levels = tangent - half, tangent + half
        borders = np.sort(np.concatenate([self._crossings(level) for level in levels]))
        if len(borders) == 0:
            return Zones(np.zeros(1), self._signs(np.zeros(1), tangent, half))
        middles = borders + 0.5 * np.diff(borders, append=borders[0] + np.pi)
        signs = self._signs(middles, tangent, half)
        new = signs != np.roll(signs, 1)
        if not new.any():
            return Zones(borders[:1], signs[:1])
        return _separated(borders[new], signs[new])

    def _signs(self, phi: Array, tangent: float, half: float) -> NDArray[np.int64]:
        excess = self(phi) - tangent
        return np.where(np.abs(excess) <= half, 0, np.sign(excess)).astype(np.int64)

    def _crossings(self, level: float) -> Array:
        """Return where the ratio crosses a level, by bisection of all brackets at once."""
        phi, values = self._samples
        above = values > level
        at = np.flatnonzero(above[1:] != above[:-1])
        left, right, rises = phi[at], phi[at + 1], above[at + 1]
        for _ in range(_HALVINGS if len(at) else 0):
            middle = 0.5 * (left + right)
            beyond = (self(middle) > level) == rises
            left, right = np.where(beyond, left, middle), np.where(beyond, middle, right)
        return np.asarray(0.5 * (left + right))


def _separated(borders: Array, signs: NDArray[np.int64]) -> Zones:
    """Put an empty cell of sign 0 between opposite signs: one of no width that the grid missed."""
    at = np.flatnonzero(signs * np.roll(signs, 1) < 0)
    return Zones(np.insert(borders, at, borders[at]), np.insert(signs, at, 0))
