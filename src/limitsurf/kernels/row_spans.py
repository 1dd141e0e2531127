"""Which sites of a square lattice a polygon covers, as intervals of columns, row by row.

Sites lie at ``origin + pitch (c, r)``. A row crosses an outline at abscissae; between the first
and the second, the third and the fourth, and so on, it is inside (even-odd rule: holes and pieces
need no care). Both ends of an edge and both ends of an interval are half-open, so that polygons
that share an edge share no site. An edge is visited once for every row that it crosses: the work
grows with rows and crossings, not with the number of sites.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = [
    "Crossings",
    "Spans",
    "first_at_least",
    "no_spans",
    "row_crossings",
    "row_spans",
    "span_changes",
    "span_sites",
]


class Crossings(NamedTuple):
    """Sorted abscissae ``x[offsets[k]:offsets[k+1]]`` at which row ``first_row + k`` is crossed."""

    first_row: int
    offsets: Ints
    x: Floats


class Spans(NamedTuple):
    """Row ``first_row + k`` holds the columns ``left[i] <= c < right[i]``.

    Its intervals are ``offsets[k] <= i < offsets[k+1]``: sorted, disjoint, and none is empty.
    """

    first_row: int
    offsets: Ints
    left: Ints
    right: Ints


@compiled
def first_at_least(position: float, origin: float, pitch: float, per_pitch: float) -> int:
    """Return the first number i with ``origin + pitch i >= position``.

    The product with ``per_pitch = 1 / pitch`` is rounded, and so it is corrected: equal to the last
    place, and no site between.
    """
    i = math.ceil((position - origin) * per_pitch)
    while origin + pitch * (i - 1) >= position:
        i -= 1
    while origin + pitch * i < position:
        i += 1
    return i


@compiled
def _clipped(number: int, size: int) -> int:
    """Return a number from 0 to `size`, or the number itself if the lattice has no end."""
    return number if size < 0 else min(max(number, 0), size)


@compiled
def row_crossings(edges: Floats, origin_y: float, pitch: float, rows: int) -> Crossings:
    """Return where the rows of a lattice cross an outline.

    Parameters
    ----------
    edges : (E, 4) float
        Closed rings, as edges ``x0, y0, x1, y1`` in any order.
    origin_y, pitch : float
        Row r lies at ``origin_y + pitch r``.
    rows : int
        Their number; negative if the lattice has no end.
    """
    n, per_pitch = edges.shape[0], 1.0 / pitch
    ends = np.empty((2, n), np.int32)
    begin, end = ends[0], ends[1]
    first, last = np.iinfo(np.int32).max, np.iinfo(np.int32).min
    for e in range(n):
        one = _clipped(first_at_least(edges[e, 1], origin_y, pitch, per_pitch), rows)
        other = _clipped(first_at_least(edges[e, 3], origin_y, pitch, per_pitch), rows)
        begin[e], end[e] = min(one, other), max(one, other)
        first, last = min(first, begin[e]), max(last, end[e])
    if last <= first:
        return Crossings(0, np.zeros(1, np.int32), np.empty(0))
    offsets = np.zeros(last - first + 1, np.int32)
    for e in range(n):
        for r in range(begin[e], end[e]):
            offsets[r - first + 1] += 1
    for k in range(last - first):
        offsets[k + 1] += offsets[k]
    x, filled = np.empty(offsets[-1]), offsets[:-1].copy()
    for e in range(n):
        x0, y0, x1, y1 = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
        slope = 1.0 / (y1 - y0) if y1 != y0 else 0.0
        for r in range(begin[e], end[e]):
            share = min(max((origin_y + pitch * r - y0) * slope, 0.0), 1.0)
            x[filled[r - first]] = x0 + (x1 - x0) * share
            filled[r - first] += 1
    for k in range(last - first):
        if offsets[k + 1] - offsets[k] > 32:
            x[offsets[k] : offsets[k + 1]].sort()
        else:
            _sort(x, offsets[k], offsets[k + 1])
    return Crossings(first, offsets, x)


@compiled
def _sort(x: Floats, begin: int, end: int) -> None:
    """Sort a few entries in place by insertion."""
    for i in range(begin + 1, end):
        value, j = x[i], i
        while j > begin and x[j - 1] > value:
            x[j] = x[j - 1]
            j -= 1
        x[j] = value


@compiled
def row_spans(
    edges: Floats, origin_x: float, origin_y: float, pitch: float, rows: int, columns: int
) -> Spans:
    """Return the intervals of sites that a polygon covers.

    Parameters
    ----------
    edges : (E, 4) float
        Closed rings, as edges ``x0, y0, x1, y1`` in any order.
    origin_x, origin_y, pitch : float
        Site (r, c) lies at ``(origin_x + pitch c, origin_y + pitch r)``.
    rows, columns : int
        Size of the lattice; negative if it has no end.
    """
    crossings = row_crossings(edges, origin_y, pitch, rows)
    n = crossings.offsets.shape[0] - 1
    most, per_pitch = crossings.x.shape[0] // 2, 1.0 / pitch
    offsets, left, right = (
        np.zeros(n + 1, np.int32),
        np.empty(most, np.int32),
        np.empty(most, np.int32),
    )
    count = 0
    for k in range(n):
        for i in range(crossings.offsets[k], crossings.offsets[k + 1] - 1, 2):
            first = _clipped(first_at_least(crossings.x[i], origin_x, pitch, per_pitch), columns)
            last = _clipped(first_at_least(crossings.x[i + 1], origin_x, pitch, per_pitch), columns)
            if first < last:
                left[count], right[count] = first, last
                count += 1
        offsets[k + 1] = count
    return Spans(crossings.first_row, offsets, left[:count], right[:count])


@compiled
def no_spans() -> Spans:
    """Return the spans of nothing."""
    return Spans(0, np.zeros(1, np.int32), np.empty(0, np.int32), np.empty(0, np.int32))


@compiled
def _minus(a: Spans, b: Spans, sites: Ints) -> int:
    """Write the sites of a that are not in b, unless `sites` has no room; return their number."""
    count, write = 0, sites.shape[0] > 0
    for k in range(a.offsets.shape[0] - 1):
        row = a.first_row + k
        j = stop = 0
        if 0 <= row - b.first_row < b.offsets.shape[0] - 1:
            j, stop = b.offsets[row - b.first_row], b.offsets[row - b.first_row + 1]
        for i in range(a.offsets[k], a.offsets[k + 1]):
            c, end = a.left[i], a.right[i]
            while c < end:
                while j < stop and b.right[j] <= c:
                    j += 1
                free = end if j == stop else min(max(b.left[j], c), end)
                if write:
                    for column in range(c, free):
                        sites[count + column - c, 0] = row
                        sites[count + column - c, 1] = column
                count += free - c
                c = end if j == stop else min(max(b.right[j], free), end)
    return count


@compiled
def span_changes(old: Spans, new: Spans) -> tuple[Ints, Ints]:
    """Return the sites (k, 2) ``row, column`` that are only in `new`, and those only in `old`.

    Time proportional to rows, intervals and changes.
    """
    nothing = np.empty((0, 2), np.int32)
    entered = np.empty((_minus(new, old, nothing), 2), np.int32)
    left = np.empty((_minus(old, new, nothing), 2), np.int32)
    _minus(new, old, entered)
    _minus(old, new, left)
    return entered, left


@compiled
def span_sites(spans: Spans) -> Ints:
    """Return all sites (k, 2) ``row, column``."""
    return span_changes(no_spans(), spans)[0]
