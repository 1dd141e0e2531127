"""Intervals of orientations on their way through a plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from limitsurf.planning.step_bounds import StepBounds, exact_bounds

if TYPE_CHECKING:
    from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["Propagation", "propagate"]

Array = NDArray[np.float64]

_ALIGNED = 1e-6  # spread that counts as aligned where nothing is off [rad]
_TURN = float(np.radians(1.0))
_HALVINGS = 30


@dataclass(frozen=True, eq=False)
class Propagation:
    """Where parts may be after each line.

    Attributes
    ----------
    sets : tuple of (n, 2) float
        Disjoint intervals of orientations in the array's frame after each line [rad].
    held : (k,) bool
        Whether the rest of the plan, without errors, aligns what the line leaves.
    margins : (k,) float
        Turn of the line by which it still does; infinite for the first [rad].
    lost : (k,) int
        Stable orientations that the line has lost.
    at_risk : float
        Share of uniform starts that the first line may leave between two stable orientations and
        that the plan may then not align.
    final_width : float
        Width of the final orientations, modulo the plan's period [rad].
    """

    sets: tuple[Array, ...]
    held: NDArray[np.bool_]
    margins: Array
    lost: NDArray[np.int64]
    at_risk: float
    final_width: float


def propagate(plan: AlignmentPlan, bounds: Sequence[StepBounds]) -> Propagation:
    """Return where parts may be that start anywhere but in the bands of the first line."""
    first = plan.lines[0]
    kept = ~bounds[0].lost if not bounds[0].lost.all() else bounds[0].lost
    sets = [joined(bounds[0].rests[kept] + first, plan.squeeze.modulus)]
    risky = _risky(plan, bounds)
    merged = _holds_lost(plan, bounds[0])
    held, margins = [aligns(plan, 0, sets[0]) and not (risky & merged).any()], [np.inf]
    for k in range(1, len(plan.lines)):
        sets.append(joined(_step(sets[-1], plan.lines[k], bounds[k]), plan.squeeze.modulus))
        held.append(aligns(plan, k, sets[k]))
        margins.append(_margin(plan, k, sets[k - 1], bounds[k]) if held[k] else 0.0)
    return Propagation(
        tuple(sets),
        np.array(held),
        np.array(margins),
        np.array([bound.lost.sum() for bound in bounds], dtype=np.int64),
        _share(bounds[0], risky),
        _width(sets[-1], plan.period),
    )


def aligns(plan: AlignmentPlan, k: int, intervals: Array) -> bool:
    """Return whether the plan from line k on, without errors, aligns intervals (n, 2)."""
    exact = exact_bounds(plan.squeeze)
    for line in plan.lines[k:]:
        intervals = _step(intervals, line, exact)
    off = intervals - plan.final
    turns = plan.period * np.round(off.mean(axis=1, keepdims=True) / plan.period)
    return bool(np.abs(off - turns).max() <= _ALIGNED)


def _step(intervals: Array, line: float, bounds: StepBounds) -> Array:
    return bounds.reach(intervals - line) + line


def _margin(plan: AlignmentPlan, k: int, before: Array, bounds: StepBounds) -> float:
    """Return by how much line k may be turned, relative to what comes, at least.

    Turns are tried a degree apart until one fails, and bisected from there.
    """

    def works(turn: float) -> bool:
        return all(
            aligns(plan, k, _step(before + turned, plan.lines[k], bounds))
            for turned in (-turn, turn)
        )

    low, high = 0.0, _TURN
    while high < plan.squeeze.modulus and works(high):
        low, high = high, high + _TURN
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if works(middle) else (low, middle)
    return low


def _risky(plan: AlignmentPlan, bounds: Sequence[StepBounds]) -> NDArray[np.bool_]:
    """Return which bands (k,) of the first line hold starts that the plan may not align."""
    rests = bounds[0].rests
    below = np.append(rests[-1:, 0] - plan.squeeze.modulus, rests[:-1, 0])
    hulls = np.column_stack([below, rests[:, 1]]) + plan.lines[0]
    risky = []
    for hull in hulls:
        stuck = hull[None]
        for k in range(1, len(plan.lines)):
            stuck = _step(stuck, plan.lines[k], bounds[k])
        risky.append(not aligns(plan, len(plan.lines) - 1, stuck))
    return np.array(risky)


def _holds_lost(plan: AlignmentPlan, bounds: StepBounds) -> NDArray[np.bool_]:
    """Return which bands (k,) hold the stable orientation of a lost step: half a basin, or more."""
    images = plan.squeeze.images[bounds.lost]
    turns = plan.squeeze.modulus * np.arange(-1, 2)[:, None]
    lifted = (images + turns).ravel()
    left, right = bounds.bands.T
    return np.asarray(((lifted >= left[:, None]) & (lifted <= right[:, None])).any(axis=1))


def _share(bounds: StepBounds, risky: NDArray[np.bool_]) -> float:
    """Return the share of uniform starts that lie in risky bands."""
    if bounds.lost.all():
        return 1.0
    bands = bounds.bands[risky]
    if len(bands) == 0:
        return 0.0
    apart = joined(bands, bounds.modulus)
    return float(min((apart[:, 1] - apart[:, 0]).sum() / bounds.modulus, 1.0))


def joined(intervals: Array, modulus: float) -> Array:
    """Return disjoint intervals that cover the same orientations, the lower ends reduced."""
    low = np.mod(intervals[:, 0], modulus)
    order = np.argsort(low)
    low, high = low[order], (low + intervals[:, 1] - intervals[:, 0])[order]
    found = [[low[0], high[0]]]
    for a, b in zip(low[1:], high[1:], strict=True):
        if a <= found[-1][1]:
            found[-1][1] = max(found[-1][1], b)
        else:
            found.append([a, b])
    while len(found) > 1 and found[0][0] + modulus <= found[-1][1]:  # around the end
        found[-1][1] = max(found[-1][1], found[0][1] + modulus)
        found.pop(0)
    found[-1][1] = min(found[-1][1], found[-1][0] + modulus)
    return np.array(found)


def _width(intervals: Array, period: float) -> float:
    """Return the width of the shortest arc that holds the intervals modulo the period."""
    folded = joined(intervals, period)
    gaps = np.append(folded[1:, 0], folded[0, 0] + period) - folded[:, 1]
    return float(period - max(gaps.max(), 0.0))
