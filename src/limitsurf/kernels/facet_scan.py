"""The facet that a point violates most, blocks of facets at a time."""

from __future__ import annotations

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.vectors import Vector

__all__ = ["most_violated"]

_BLOCK = 64


@compiled
def _scan(columns: Floats, b: Floats, x: Vector, best: float) -> tuple[int, float]:
    """Return the largest ``a_i x - b_i`` above `best` and its index, or -1."""
    a0, a1, a2 = columns[0], columns[1], columns[2]
    index = -1
    for i in range(b.shape[0]):
        violation = a0[i] * x[0] + a1[i] * x[1] + a2[i] * x[2] - b[i]
        if violation > best:
            best = violation
            index = i
    return index, best


@compiled
def _count_above(columns: Floats, b: Floats, x: Vector, best: float) -> int:
    a0, a1, a2 = columns[0], columns[1], columns[2]
    count = 0
    for i in range(b.shape[0]):
        count += a0[i] * x[0] + a1[i] * x[1] + a2[i] * x[2] - b[i] > best
    return count


@compiled
def most_violated(columns: Floats, b: Floats, x: Vector, best: float) -> tuple[int, float]:
    """Return ``(i, a_i x - b_i)`` of the largest violation above `best`; i = -1 if there is none.

    `columns` (3, m) holds the coordinates of the normals one after the other. Counting is
    vectorised, looking for the largest is not: only blocks that hold a larger one are looked
    through.
    """
    m = b.shape[0]
    if m <= 4 * _BLOCK:
        return _scan(columns, b, x, best)
    index = -1
    for start in range(0, m, _BLOCK):
        block, offsets = columns[:, start : start + _BLOCK], b[start : start + _BLOCK]
        if _count_above(block, offsets, x, best) > 0:
            i, best = _scan(block, offsets, x, best)
            index = start + i
    return index, best
