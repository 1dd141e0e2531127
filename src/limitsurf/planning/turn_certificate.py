"""Where U' changes sign, from cells of directions that bound it, and the proof that this is all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.turn_roots import CLEAR, MONOTONE, ROOT
from limitsurf.tolerances import ANGLE

__all__ = ["CellChanges", "TurnCertificate", "changes_in_cells"]

Array = NDArray[np.float64]

_Row = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class TurnCertificate:
    """Why the equilibria of a turn function are all there are.

    The directions are covered by cells. Bounds of U'' leave none or at most one sign change of U'
    to each cell, except where U' is rounding throughout.

    Attributes
    ----------
    equilibria : int
        Stable and unstable orientations of the turn function.
    bound : int
        Most sign changes that the cells leave room for, unresolved ones aside.
    unresolved : int
        Intervals wider than `tolerances.ANGLE` in which rounding decides: U' vanishes to higher
        order, as at a triple root.
    widest : float
        The widest of them [rad].
    residual : float
        Largest ``|U'|`` at an equilibrium, in units of ``area^1.5``.
    """

    equilibria: int
    bound: int
    unresolved: int
    widest: float
    residual: float

    @property
    def complete(self) -> bool:
        """True if no equilibrium is missing and rounding decides nowhere."""
        return self.equilibria == self.bound and self.unresolved == 0

    def __repr__(self) -> str:
        """Return the verdict first."""
        verdict = "complete" if self.complete else "not complete"
        rounding = f", {self.unresolved} unresolved, up to {self.widest:.2g} rad wide"
        return (
            f"TurnCertificate({verdict}: {self.equilibria} equilibria, at most {self.bound}"
            f"{rounding if self.unresolved else ''}; residual {self.residual:.2g})"
        )


@dataclass(frozen=True)
class CellChanges:
    """Directions in which U' rises and falls through zero, and how sure that is.

    The other numbers are those of `TurnCertificate`.
    """

    rising: Array
    falling: Array
    bound: int
    unresolved: int
    widest: float


def changes_in_cells(cells: Array) -> CellChanges:
    """Return the sign changes of U' from the rows of `limitsurf.kernels.turn_roots.slope_signs`.

    Neighbouring cells whose common border is rounding form a run. If U' rises in all of its cells,
    or falls in all, it changes sign once or never, as the signs on both sides of the run say.
    """
    sure = np.flatnonzero(cells[:, 2] <= ROOT)
    if len(sure) == 0:
        return CellChanges(np.empty(0), np.empty(0), 0, 1, np.pi)
    turn = np.array([np.pi, np.pi, 0.0, 0.0, np.pi, 0.0])
    around = np.concatenate([cells[sure[0] :], cells[: sure[0] + 1] + turn])
    roots: tuple[list[float], list[float]] = [], []
    bound, unresolved, widest = 0, 0, 0.0
    run: list[_Row] = []
    sign = 0.0  # before the first row: not known yet
    for row in map(tuple, around.tolist()):
        kind, after = row[2], row[3]
        if kind > ROOT:
            run.append(row)
            continue
        before = after if kind == CLEAR else -after
        changes = sign not in (0.0, before)
        if changes:
            roots[before < 0.0].append(_root_of(run) if run else row[0])
            bound += 1
        if run and run[-1][1] - run[0][0] > ANGLE and not _is_monotone(run):
            unresolved += 1
            widest = max(widest, run[-1][1] - run[0][0])
        run, sign = [], after
        if kind == ROOT and row[0] < around[0, 0] + np.pi - 1e-12:
            roots[after < 0.0].append(row[4])
            bound += 1
    return CellChanges(np.array(roots[0]), np.array(roots[1]), bound, unresolved, widest)


def _is_monotone(run: list[_Row]) -> bool:
    return all(row[2] == MONOTONE and row[3] == run[0][3] for row in run)


def _root_of(run: list[_Row]) -> float:
    """Return where U' is closest to zero in a run; the middle of what is rounding."""
    flat = [row for row in run if row[2] != MONOTONE]
    if flat:
        return 0.5 * (flat[0][0] + flat[-1][1])
    return min(run, key=lambda row: abs(row[5]))[4]
