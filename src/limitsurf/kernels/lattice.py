"""Which sites of a square lattice a polygon covers: row spans, not point-in-polygon tests.

A tip has a small width b. Its share of the load rises linearly from 0 to 1 while the outline
crosses it: ``share = clip(1/2 + d/b, 0, 1)`` with d the signed distance to the outline (positive
inside). This is the continuous form of "a contact under the outline carries any share between
none and its own", so forces stay continuous while the part moves.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Bools, Floats, Ints, compiled
from limitsurf.kernels.row_spans import row_crossings

__all__ = ["Cover", "Lattice", "covered_sites", "new_cover"]


class Lattice(NamedTuple):
    """Sites at ``origin + pitch (c, r)``, which of them are active, and the width b of a tip.

    With b = 0 tips are points.
    """

    origin_x: float
    origin_y: float
    pitch: float
    active: Bools
    tip_width: float


class Cover(NamedTuple):
    """Room for a list of sites with their shares; `slot` finds a site in it, -1 if it is not."""

    rows: Ints
    columns: Ints
    share: Floats
    slot: Ints


@compiled
def new_cover(active: Bools) -> Cover:
    """Return an empty list with room for all sites."""
    n = active.size
    slot = np.full(active.shape, -1, np.int32)
    return Cover(np.empty(n, np.int32), np.empty(n, np.int32), np.empty(n), slot)


@compiled
def _first(position: float, origin: float, pitch: float) -> int:
    return max(math.ceil((position - origin) / pitch), 0)


@compiled
def _last(position: float, origin: float, pitch: float, n: int) -> int:
    return min(math.floor((position - origin) / pitch), n - 1)


@compiled
def _distance_to_edge(px: float, py: float, edge: Floats) -> float:
    dx, dy = edge[2] - edge[0], edge[3] - edge[1]
    length2 = dx * dx + dy * dy
    along = ((px - edge[0]) * dx + (py - edge[1]) * dy) / length2 if length2 > 0.0 else 0.0
    along = min(max(along, 0.0), 1.0)
    return math.hypot(px - edge[0] - along * dx, py - edge[1] - along * dy)


@compiled
def covered_sites(edges: Floats, lattice: Lattice, cover: Cover) -> int:
    """List the active sites under the outline and their shares in `cover`; return their number.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges ``x0, y0, x1, y1`` in array coordinates.
    lattice : Lattice
        The sites.
    cover : Cover
        Receives the list in the first entries of `rows`, `columns`, `share`.
    """
    n_rows, n_columns = lattice.active.shape
    count = 0
    x0, y0, pitch = lattice.origin_x, lattice.origin_y, lattice.pitch
    crossings = row_crossings(edges, y0, pitch, n_rows)
    first_row, offsets, xs = crossings.first_row, crossings.offsets, crossings.x
    for row in range(offsets.shape[0] - 1):
        r = first_row + row
        for k in range(offsets[row], offsets[row + 1] - 1, 2):
            for c in range(_first(xs[k], x0, pitch), _last(xs[k + 1], x0, pitch, n_columns) + 1):
                if lattice.active[r, c]:
                    _append(cover, count, r, c, 1.0)
                    count += 1
    if lattice.tip_width > 0.0:
        for i in range(edges.shape[0]):
            count = _grade_edge(edges[i], lattice, cover, count)
    for k in range(count):
        cover.slot[cover.rows[k], cover.columns[k]] = -1
    return count


@compiled
def _append(cover: Cover, count: int, r: int, c: int, share: float) -> None:
    cover.rows[count], cover.columns[count], cover.share[count] = r, c, share
    cover.slot[r, c] = count


@compiled
def _grade_edge(edge: Floats, lattice: Lattice, cover: Cover, count: int) -> int:
    """Give the sites within b/2 of one edge their partial share; return the new count."""
    n_rows, n_columns = lattice.active.shape
    origin_x, origin_y, pitch = lattice.origin_x, lattice.origin_y, lattice.pitch
    half = 0.5 * lattice.tip_width
    low, high = min(edge[1], edge[3]), max(edge[1], edge[3])
    for r in range(
        _first(low - half, origin_y, pitch), _last(high + half, origin_y, pitch, n_rows) + 1
    ):
        y = origin_y + pitch * r
        left, right = _reach_in_row(edge, y, half)
        for c in range(_first(left, origin_x, pitch), _last(right, origin_x, pitch, n_columns) + 1):
            distance = _distance_to_edge(origin_x + pitch * c, y, edge)
            if not lattice.active[r, c] or distance >= half:
                continue
            k = cover.slot[r, c]
            if k < 0:
                _append(cover, count, r, c, 0.5 - distance / lattice.tip_width)
                count += 1
            elif cover.share[k] >= 0.5:  # inside
                cover.share[k] = min(cover.share[k], 0.5 + distance / lattice.tip_width)
            else:
                cover.share[k] = max(cover.share[k], 0.5 - distance / lattice.tip_width)
    return count


@compiled
def _reach_in_row(edge: Floats, y: float, half: float) -> tuple[float, float]:
    """Return an interval of x that holds all points of the row y within `half` of the edge."""
    x0, y0, x1, y1 = edge[0], edge[1], edge[2], edge[3]
    if y0 == y1:
        return min(x0, x1) - half, max(x0, x1) + half
    low, high = min(y0, y1), max(y0, y1)
    a = x0 + (x1 - x0) * (min(max(y - half, low), high) - y0) / (y1 - y0)
    b = x0 + (x1 - x0) * (min(max(y + half, low), high) - y0) / (y1 - y0)
    return min(a, b) - half, max(a, b) + half
