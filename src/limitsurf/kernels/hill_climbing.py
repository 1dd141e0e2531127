"""The vertex of a polytope farthest along a direction, by climbing along the edges.

The climb starts at a vertex stored for the cell of directions (a cube map) that the direction
falls into; it ends at the top, since a linear function on a convex polytope has no other local
maximum.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.compile import Bools, Floats, Ints, compiled
from limitsurf.kernels.vectors import Vector, along, dot, row

__all__ = [
    "Cells",
    "Graph",
    "Stretch",
    "climb",
    "direction_cells",
    "farthest_vertex",
    "highest_vertex",
    "start_vertex",
    "support_vertices",
    "vertex_graph",
]

Stretch = tuple[float, float, float, float, float, float]

_EPS = float(np.finfo(np.float64).eps)
_BRUTE = 40  # up to here looking at all vertices is faster than climbing


class Graph(NamedTuple):
    """Neighbours of vertex i: ``adj[ptr[i]:ptr[i + 1]]``; none at all if `adj` is empty."""

    ptr: Ints
    adj: Ints


class Cells(NamedTuple):
    """A point amid the vertices, a bound of their coordinates, and where to start climbing.

    `start` (6, n, n) is a cube map of the vertices farthest along the middles of its cells. It is
    entered with ``L^T d`` for the direction d, where ``L L^T`` is the covariance of the vertices
    (`stretch` holds L by rows): cells of about equal use for flat bodies too.
    """

    centre: Vector
    reach: float
    stretch: Stretch
    start: Ints


def vertex_graph(n: int, triangles: NDArray[np.integer]) -> Graph:
    """Return the edges of a hull of `n` vertices from its triangles (t, 3); t may be 0."""
    t = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    pairs = np.concatenate([t[:, [i, j]] for i in range(3) for j in range(3) if i != j])
    pairs = np.unique(pairs, axis=0)
    ptr = np.searchsorted(pairs[:, 0], np.arange(n + 1))
    return Graph(ptr.astype(np.int32), np.ascontiguousarray(pairs[:, 1], dtype=np.int32))


@compiled
def highest_vertex(V: Floats, d: Vector) -> int:
    """Look at all vertices."""
    top, best = -np.inf, 0
    for i in range(V.shape[0]):
        height = V[i, 0] * d[0] + V[i, 1] * d[1] + V[i, 2] * d[2]
        if height > top:
            top, best = height, i
    return best


@compiled
def climb(V: Floats, ptr: Ints, adj: Ints, start: int, d: Vector) -> int:
    """Go from neighbour to better neighbour until there is none."""
    top = dot(row(V, start), d)
    vertex, best = -1, start
    while best != vertex:
        vertex = best
        for e in range(ptr[vertex], ptr[vertex + 1]):
            height = dot(row(V, adj[e]), d)
            if height > top:
                top, best = height, adj[e]
    return best


@compiled
def _cell(n: int, d: Vector) -> tuple[int, int, int]:
    """Return face, row and column of the cell of a cube map that the direction d lies in."""
    a0, a1, a2 = abs(d[0]), abs(d[1]), abs(d[2])
    if a0 >= a1 and a0 >= a2:
        face, top, u, v = (0 if d[0] > 0.0 else 1), a0, d[1], d[2]
    elif a1 >= a2:
        face, top, u, v = (2 if d[1] > 0.0 else 3), a1, d[0], d[2]
    else:
        face, top, u, v = (4 if d[2] > 0.0 else 5), a2, d[0], d[1]
    if not top > 0.0:
        return 0, 0, 0
    half = 0.5 * n
    return face, min(int((u / top + 1.0) * half), n - 1), min(int((v / top + 1.0) * half), n - 1)


@compiled
def _direction_of_cell(n: int, face: int, i: int, j: int) -> Vector:
    u, v = (2 * i + 1.0) / n - 1.0, (2 * j + 1.0) / n - 1.0
    side = 1.0 - 2.0 * (face % 2)
    if face < 2:
        return side, u, v
    return (u, side, v) if face < 4 else (u, v, side)


@compiled
def _covariance_root(V: Floats, used: Bools, centre: Vector) -> Stretch:
    """Return the Cholesky factor of the scatter of the vertices, kept from being singular."""
    xx = xy = yy = xz = yz = zz = 0.0
    for i in range(V.shape[0]):
        if used[i]:
            x, y, z = along(row(V, i), -1.0, centre)
            xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
            xz, yz, zz = xz + x * z, yz + y * z, zz + z * z
    least = 1e-24 * (xx + yy + zz) + 1e-300
    l00 = math.sqrt(max(xx, least))
    l10, l20 = xy / l00, xz / l00
    l11 = math.sqrt(max(yy - l10 * l10, least))
    l21 = (yz - l20 * l10) / l11
    return l00, l10, l11, l20, l21, math.sqrt(max(zz - l20 * l20 - l21 * l21, least))


@compiled
def _stretched(L: Stretch, d: Vector) -> Vector:
    """Return ``L^T d``."""
    return L[0] * d[0] + L[1] * d[1] + L[3] * d[2], L[2] * d[1] + L[4] * d[2], L[5] * d[2]


@compiled
def _unstretched(L: Stretch, d: Vector) -> Vector:
    """Return ``L^-T d``."""
    z = d[2] / L[5]
    y = (d[1] - L[4] * z) / L[2]
    return (d[0] - L[1] * y - L[3] * z) / L[0], y, z


@compiled
def _middle(V: Floats, used: Bools) -> tuple[Vector, float, int]:
    """Return the mean of the vertices in use, a bound of their coordinates, and one of them."""
    total, reach, last = (0.0, 0.0, 0.0), 0.0, 0
    for i in range(V.shape[0]):
        if used[i]:
            v = row(V, i)
            total, last = along(total, 1.0, v), i
            reach = max(reach, abs(v[0]), abs(v[1]), abs(v[2]))
    n = used.sum()
    return (total[0] / n, total[1] / n, total[2] / n), reach, last


@compiled
def direction_cells(V: Floats, graph: Graph) -> Cells:
    """Return the cube map of farthest vertices, about one cell for each vertex."""
    ptr, adj = graph
    used = np.ones(V.shape[0], np.bool_)
    if adj.shape[0] > 0:
        used[:] = ptr[1:] > ptr[:-1]
    centre, reach, vertex = _middle(V, used)
    stretch = _covariance_root(V, used, centre)
    n = math.ceil(math.sqrt(used.sum() / 6.0)) if adj.shape[0] > 0 else 1
    start = np.empty((6, n, n), np.int32)
    for face in range(6):
        for i in range(n):
            for j in range(n):
                d = _unstretched(stretch, _direction_of_cell(n, face, i, j))
                vertex = climb(V, ptr, adj, vertex, d)
                start[face, i, j] = vertex
    return Cells(centre, reach, stretch, start)


@compiled
def start_vertex(start: Ints, L: Stretch, d: Vector) -> int:
    """Return the vertex stored for the cell of the direction d."""
    return int(start[_cell(start.shape[1], _stretched(L, d))])


@compiled
def farthest_vertex(V: Floats, ptr: Ints, adj: Ints, start: Ints, L: Stretch, d: Vector) -> int:
    """Return the vertex farthest along d."""
    if V.shape[0] <= _BRUTE or adj.shape[0] == 0:
        return highest_vertex(V, d)
    return climb(V, ptr, adj, start_vertex(start, L, d), d)


@compiled
def support_vertices(directions: Floats, V: Floats, graph: Graph, cells: Cells) -> Ints:
    """Return the vertex farthest along each of the directions (k, 3)."""
    ptr, adj = graph
    start = cells.start
    found = np.empty(directions.shape[0], np.int32)
    for i in range(directions.shape[0]):
        found[i] = farthest_vertex(V, ptr, adj, start, cells.stretch, row(directions, i))
    return found
