r"""Closest point of a convex polytope by walking over its surface, from triangle to triangle.

The closest point of one triangle lies within it, on an edge or at a corner. Within it, with p
above its plane, it is the closest point of the polytope: the distance to a convex set has no other
local minimum. From an edge the walk goes on in the triangle across, and ends if that one names the
same edge; from a corner it goes along the edge that leads most towards p, and ends if none does
(Lin and Canny, 1991; Mirtich, V-Clip, 1998). The first corner is the one stored for the direction
of p (``hill_climbing``), so that two or three triangles do.

Where p lies below a triangle the walk crosses to the other side, once; the second time p may lie
inside. Then, and where rounding makes the walk go round in circles, the method of `gjk` takes over.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.hill_climbing import Graph, climb
from limitsurf.kernels.vectors import Vector, along, cross, dot, row

__all__ = ["Surface", "triangle_surface", "walk_to_closest"]

_MAX_TRIANGLES = 30
_GAVE_UP = 0


class Surface(NamedTuple):
    """Triangles (t, 3), outwards, those across their edges, and those left of directed edges.

    Edge k of a triangle runs from its corner k to the next; `of_edge` follows `Graph.adj`.
    """

    triangles: Ints
    across: Ints
    of_edge: Ints


def triangle_surface(triangles: NDArray[np.integer], graph: Graph) -> Surface:
    """Return the surface of a hull from its triangles (t, 3) and `vertex_graph`."""
    t = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    n = len(graph.ptr)  # more than the number of vertices
    here, there = t.ravel(), np.roll(t, -1, axis=1).ravel()
    origin = np.repeat(np.arange(n - 1), np.diff(graph.ptr))
    places = np.searchsorted(origin * n + graph.adj, np.stack([here * n + there, there * n + here]))
    of_edge = np.empty(len(graph.adj), np.int32)
    of_edge[places[0]] = np.arange(len(here)) // 3
    return Surface(t.astype(np.int32), of_edge[places[1]].reshape(-1, 3), of_edge)


@compiled
def _on_triangle(p: Vector, a: Vector, b: Vector, c: Vector) -> tuple[int, Vector]:
    """Return where the closest point of a triangle lies, and its weights.

    0 is within; 1, 2, 3 the edges ab, bc, ca; 4, 5, 6 the corners (Ericson, Real-Time Collision
    Detection, 2005, section 5.1.5).
    """
    ab, ac = along(b, -1.0, a), along(c, -1.0, a)
    ap = along(p, -1.0, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return 4, (1.0, 0.0, 0.0)
    bp = along(p, -1.0, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return 5, (0.0, 1.0, 0.0)
    third = d1 * d4 - d3 * d2
    if third <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        t = d1 / (d1 - d3)
        return 1, (1.0 - t, t, 0.0)
    cp = along(p, -1.0, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return 6, (0.0, 0.0, 1.0)
    second = d5 * d2 - d1 * d6
    if second <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        t = d2 / (d2 - d6)
        return 3, (1.0 - t, 0.0, t)
    first = d3 * d6 - d5 * d4
    if first <= 0.0 and d4 >= d3 and d5 >= d6:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 2, (0.0, 1.0 - t, t)
    scale = 1.0 / (first + second + third)
    return 0, (first * scale, second * scale, third * scale)


@compiled
def _edge_towards(V: Floats, ptr: Ints, adj: Ints, v: int, p: Vector) -> int:
    """Return the edge of vertex v that leads most towards p; -1 if none leads closer."""
    here = row(V, v)
    g = along(p, -1.0, here)
    best, found = 0.0, -1
    for e in range(ptr[v], ptr[v + 1]):
        way = along(row(V, adj[e]), -1.0, here)
        rise = dot(g, way)
        if rise > 0.0 and rise * rise > best * dot(way, way):
            best, found = rise * rise / dot(way, way), e
    return found


@compiled
def walk_to_closest(
    p: Vector, V: Floats, ptr: Ints, adj: Ints, surface: Surface, start: int, s: Ints, w: Floats
) -> tuple[int, int]:
    """Return the number of vertices that span the closest point, 0 if given up, and triangles.

    Parameters
    ----------
    p : vector
        The point, outside.
    V, ptr, adj, surface
        Vertices (n, 3), `vertex_graph` and `triangle_surface`.
    start : int
        Vertex to start at.
    s, w : (4,) int, (4,) float
        Receive the vertices and their weights.
    """
    triangles, across, of_edge = surface
    s[0], w[0] = start, 1.0
    e = _edge_towards(V, ptr, adj, start, p)
    if e < 0:
        return 1, 0
    t, last, crossed = of_edge[e], -1, False
    for count in range(1, _MAX_TRIANGLES):
        i, j, k = triangles[t]
        a, b, c = row(V, i), row(V, j), row(V, k)
        place, weights = _on_triangle(p, a, b, c)
        if place == 0:
            normal = cross(along(b, -1.0, a), along(c, -1.0, a))
            if dot(normal, along(p, -1.0, a)) > 0.0:
                s[0], s[1], s[2] = i, j, k
                w[0], w[1], w[2] = weights
                return 3, count
            if crossed:
                return _GAVE_UP, count
            crossed = True
            s[0] = climb(V, ptr, adj, i, (-normal[0], -normal[1], -normal[2]))
        elif place <= 3:
            one, two = place - 1, place % 3
            if across[t, one] == last:
                s[0], s[1] = triangles[t, one], triangles[t, two]
                w[0], w[1] = weights[one], weights[two]
                return 2, count
            last, t = t, across[t, one]
            continue
        else:
            s[0], w[0] = triangles[t, place - 4], 1.0
        e = _edge_towards(V, ptr, adj, s[0], p)
        if e < 0:
            return 1, count
        last, t = -1, of_edge[e]
    return _GAVE_UP, _MAX_TRIANGLES
