"""Which sites of a square lattice a polygon covers: row spans, not point-in-polygon tests.

A tip has a small width b. Its share of the load rises linearly from 0 to 1 while the outline
crosses it: ``share = clip(1/2 + d/b, 0, 1)`` with d the signed distance to the outline (positive
inside). This is the continuous form of "a contact under the outline carries any share between
none and its own", so forces stay continuous while the part moves.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Bools, Floats, Ints, compiled

__all__ = ["covered_sites"]


@compiled
def _row_spans(edges: Floats, y: float, xs: Floats) -> int:
    """Fill `xs` with the sorted abscissae where the outline crosses the height y; return count."""
    count = 0
    for i in range(edges.shape[0]):
        y0, y1 = edges[i, 1], edges[i, 3]
        if (y0 <= y) != (y1 <= y):
            crossing = edges[i, 0] + (edges[i, 2] - edges[i, 0]) * (y - y0) / (y1 - y0)
            j = count
            while j > 0 and xs[j - 1] > crossing:
                xs[j] = xs[j - 1]
                j -= 1
            xs[j] = crossing
            count += 1
    return count


@compiled
def _first(position: float, origin: float, pitch: float) -> int:
    return max(math.ceil((position - origin) / pitch), 0)


@compiled
def _last(position: float, origin: float, pitch: float, n: int) -> int:
    return min(math.floor((position - origin) / pitch), n - 1)


@compiled
def _distance_to_edge(px: float, py: float, x0: float, y0: float, x1: float, y1: float) -> float:
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    along = ((px - x0) * dx + (py - y0) * dy) / length2 if length2 > 0.0 else 0.0
    along = min(max(along, 0.0), 1.0)
    return math.hypot(px - x0 - along * dx, py - y0 - along * dy)


@compiled
def covered_sites(
    edges: Floats,
    origin_x: float,
    origin_y: float,
    pitch: float,
    active: Bools,
    width: float,
    slot: Ints,
    rows: Ints,
    cols: Ints,
    share: Floats,
) -> int:
    """Fill `rows`, `cols`, `share` with the active sites under the outline; return their number.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges ``x0, y0, x1, y1`` in array coordinates.
    origin_x, origin_y, pitch : float
        Site (r, c) lies at ``origin + pitch * (c, r)``.
    active : (R, C) bool
        Sites that run.
    width : float
        Tip width b [m]; 0 makes points of the tips.
    slot : (R, C) int32
        Scratch, -1 everywhere on entry and on return.
    rows, cols, share
        Output buffers of at least R*C entries.
    """
    n_rows, n_cols = active.shape
    xs = np.empty(edges.shape[0])
    bottom, top = np.inf, -np.inf
    for i in range(edges.shape[0]):
        bottom = min(bottom, edges[i, 1], edges[i, 3])
        top = max(top, edges[i, 1], edges[i, 3])
    count = 0
    for r in range(_first(bottom, origin_y, pitch), _last(top, origin_y, pitch, n_rows) + 1):
        crossings = _row_spans(edges, origin_y + pitch * r, xs)
        for k in range(0, crossings - 1, 2):
            for c in range(
                _first(xs[k], origin_x, pitch), _last(xs[k + 1], origin_x, pitch, n_cols) + 1
            ):
                if active[r, c]:
                    rows[count], cols[count], share[count] = r, c, 1.0
                    slot[r, c] = count
                    count += 1
    if width > 0.0:
        for i in range(edges.shape[0]):
            count = _grade_edge(
                edges[i], origin_x, origin_y, pitch, active, width, slot, rows, cols, share, count
            )
    for k in range(count):
        slot[rows[k], cols[k]] = -1
    return count


@compiled
def _grade_edge(
    edge: Floats,
    origin_x: float,
    origin_y: float,
    pitch: float,
    active: Bools,
    width: float,
    slot: Ints,
    rows: Ints,
    cols: Ints,
    share: Floats,
    count: int,
) -> int:
    """Give the sites within b/2 of one edge their partial share; return the new count."""
    n_rows, n_cols = active.shape
    half = 0.5 * width
    x0, y0, x1, y1 = edge[0], edge[1], edge[2], edge[3]
    low, high = min(y0, y1), max(y0, y1)
    for r in range(
        _first(low - half, origin_y, pitch), _last(high + half, origin_y, pitch, n_rows) + 1
    ):
        left, right = min(x0, x1), max(x0, x1)
        if high > low:  # the part of the edge within b/2 of this row
            y = origin_y + pitch * r
            a = (min(max(y - half, low), high) - y0) / (y1 - y0)
            b = (min(max(y + half, low), high) - y0) / (y1 - y0)
            left = min(x0 + a * (x1 - x0), x0 + b * (x1 - x0))
            right = max(x0 + a * (x1 - x0), x0 + b * (x1 - x0))
        for c in range(
            _first(left - half, origin_x, pitch), _last(right + half, origin_x, pitch, n_cols) + 1
        ):
            if not active[r, c]:
                continue
            distance = _distance_to_edge(origin_x + pitch * c, origin_y + pitch * r, x0, y0, x1, y1)
            if distance >= half:
                continue
            k = slot[r, c]
            if k < 0:
                rows[count], cols[count], share[count] = r, c, 0.5 - distance / width
                slot[r, c] = count
                count += 1
            elif share[k] >= 0.5:
                share[k] = min(share[k], 0.5 + distance / width)
            else:
                share[k] = max(share[k], 0.5 - distance / width)
    return count
