"""A square lattice of actuators: where they are, which run, which way they push."""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import Bools, Floats, compiled, inlined
from limitsurf.kernels.vectors import length

__all__ = [
    "Edge",
    "Lattice",
    "distance_to_edge",
    "first_site",
    "holds",
    "last_site",
    "reach_in_row",
]

#: ``x0, y0, x1, y1``
Edge = tuple[float, float, float, float]


class Lattice(NamedTuple):
    """Sites at ``origin + pitch (c, r)``, which run, their pushes, and the width b of a tip.

    Pushes are unit vectors but for spread. With b = 0 tips are points.
    """

    origin_x: float
    origin_y: float
    pitch: float
    active: Bools
    directions: Floats
    tip_width: float


@compiled
def first_site(position: float, origin: float, per_pitch: float) -> int:
    """Return the first row or column from a position on; `per_pitch` is one over the pitch."""
    return max(math.ceil((position - origin) * per_pitch), 0)


@compiled
def last_site(position: float, origin: float, per_pitch: float, n: int) -> int:
    """Return the last of n rows or columns up to a position."""
    return min(math.floor((position - origin) * per_pitch), n - 1)


@inlined
def holds(lattice: Lattice, edges: Floats) -> bool:
    """Return whether all vertices lie over the cells of the sites."""
    half = 0.5 * lattice.pitch
    rows, columns = lattice.active.shape
    left, bottom = lattice.origin_x - half, lattice.origin_y - half
    right, top = left + columns * lattice.pitch, bottom + rows * lattice.pitch
    for i in range(edges.shape[0]):
        if not (left <= edges[i, 0] <= right and bottom <= edges[i, 1] <= top):
            return False
    return True


@compiled
def distance_to_edge(px: float, py: float, edge: Edge) -> float:
    """Return the distance of a point to an edge."""
    dx, dy = edge[2] - edge[0], edge[3] - edge[1]
    length2 = dx * dx + dy * dy
    along = ((px - edge[0]) * dx + (py - edge[1]) * dy) / length2 if length2 > 0.0 else 0.0
    along = min(max(along, 0.0), 1.0)
    return length(px - edge[0] - along * dx, py - edge[1] - along * dy)


@compiled
def reach_in_row(edge: Edge, slope: float, y: float, half: float) -> tuple[float, float]:
    """Return an interval of x that holds all points of the row y within `half` of the edge.

    `slope` is its dx/dy; anything if it is level.
    """
    x0, y0, x1, y1 = edge
    if y0 == y1:
        return min(x0, x1) - half, max(x0, x1) + half
    low, high = min(y0, y1), max(y0, y1)
    a = x0 + slope * (min(max(y - half, low), high) - y0)
    b = x0 + slope * (min(max(y + half, low), high) - y0)
    return min(a, b) - half, max(a, b) + half
