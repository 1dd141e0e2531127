r"""Closest point of the convex hull of points in space, from its vertices.

The method of Gilbert, Johnson and Keerthi (1988) with the sub-problem of Wolfe (1976). It keeps a
simplex of at most four vertices :math:`v_i` and the point :math:`x = \sum_i w_i v_i`, w > 0, of it
that is closest to p. The vertex s farthest along :math:`p - x` joins the simplex; unless

.. math:: (x - p)\cdot(x - s) \le 0,

it brings x closer. The new x lies between the old one and the point t of the simplex' affine hull
closest to p: where the way to t leaves the simplex, a vertex is dropped and t is looked for again.
All decisions are signs of terms linear in p, never comparisons of distances: a difference of
distances resolves x only to the square root of the rounding.

The farthest vertex is found by climbing along the edges of the hull, from a vertex stored for the
cell of directions (a cube map) that the direction falls into.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.dual_active_set import NOT_CONVERGED, SOLVED
from limitsurf.kernels.hill_climbing import Stretch, farthest_vertex
from limitsurf.kernels.simplex import (
    closest_of_simplex,
    polish,
    shortest_way,
    simplex_point,
    simplex_residual,
)
from limitsurf.kernels.vectors import Vector, along, dot, row

__all__ = ["closest_by_gjk"]

_EPS = float(np.finfo(np.float64).eps)
_MAX_ITERATIONS = 200


@compiled
def closest_by_gjk(
    p: Vector,
    V: Floats,
    ptr: Ints,
    adj: Ints,
    start: Ints,
    L: Stretch,
    centre: Vector,
    reach: float,
    s: Ints,
    w: Floats,
) -> tuple[Vector, int, int, int]:
    """Return x, the number of vertices of the simplex (0 inside), iterations and status.

    `reach` bounds the coordinates of the vertices; s and w receive the simplex and its weights.
    """
    scale = max(reach, abs(p[0]), abs(p[1]), abs(p[2]))
    newest = farthest_vertex(V, ptr, adj, start, L, along(p, -1.0, centre))
    s[0], w[0], k = newest, 1.0, 1
    x = row(V, newest)
    for iteration in range(_MAX_ITERATIONS):
        y = simplex_residual(V, s, k, x, p)
        if dot(y, y) <= (4.0 * _EPS * scale) ** 2:
            return p, 0, iteration, SOLVED
        newest = farthest_vertex(V, ptr, adj, start, L, (-y[0], -y[1], -y[2]))
        way = shortest_way(V, s, k, row(V, newest))
        if not dot(y, way) > 4.0 * _EPS * math.sqrt(dot(y, y) * dot(way, way)):
            return polish(V, s, w, k, p), k, iteration, SOLVED
        s[k], w[k] = newest, 0.0
        k = closest_of_simplex(V, s, w, k + 1, p)
        if k == 4:
            return p, 0, iteration + 1, SOLVED
        x_old = x
        x = simplex_point(V, s, w, k)
        step = along(x_old, -1.0, x)
        if not dot(step, along(along(x_old, -2.0, p), 1.0, x)) > 0.0:  # no closer than before
            return polish(V, s, w, k, p), k, iteration + 1, SOLVED
    return x, k, _MAX_ITERATIONS, NOT_CONVERGED
