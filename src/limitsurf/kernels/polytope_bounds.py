r"""Certified errors of closest points of polytopes.

By facets: with :math:`N x = b_N` on the active facets and :math:`p - x = N^T u`, u >= 0, the
point x is exact. A residual r of the first moves x by at most :math:`|r| / \sigma_{min}(N)`, one
of the second by its length. For k <= 3 unit rows :math:`\sigma_{min} \ge \sqrt{\det N N^T} / 3`.

Another facet violated beyond rounding makes the bound infinite.

By vertices: let t be the part of :math:`g = p - x` along the simplex that holds x, and g' = g - t.
The simplex lies in a plane with normal g', so that :math:`|x - x^*| \le |t| + \sqrt{2 \max_v
g'\cdot(v - v_0)}`, the maximum over the vertices, found by climbing from the simplex. It is zero if
the simplex spans a face, but for rounding of other vertices in its plane.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.facet_scan import most_violated
from limitsurf.kernels.hill_climbing import climb, highest_vertex
from limitsurf.kernels.vectors import Vector, along, cross, dot, row

__all__ = ["facet_bound", "vertex_bound"]

_ROUNDING = 8 * float(np.finfo(np.float64).eps)


@compiled
def _independence(A: Floats, active: Ints) -> float:
    """Return a lower bound of the smallest singular value of the active unit normals."""
    if active[1] < 0:
        return 1.0
    normal = cross(row(A, active[0]), row(A, active[1]))
    if active[2] < 0:
        return math.sqrt(dot(normal, normal)) / 3.0
    return abs(dot(normal, row(A, active[2]))) / 3.0


@compiled
def _size(a: Vector) -> float:
    return max(abs(a[0]), abs(a[1]), abs(a[2]))


@compiled
def facet_bound(
    p: Vector,
    x: Vector,
    A: Floats,
    columns: Floats,
    b: Floats,
    largest: float,
    active: Ints,
    multipliers: Floats,
) -> float:
    """Return a bound for the point x closest to p by facets; 0 for points inside.

    Parameters
    ----------
    p, x : vectors
        A point and its closest point.
    A, columns, b : (m, 3), (3, m), (m,) float
        Facets, rows of A of length 1; A once more by coordinates.
    largest : float
        The largest ``|b_i|``.
    active, multipliers : (3,) int, float
        As `closest_on_facets` returns them.
    """
    if active[0] < 0:
        return 0.0
    rest = along(p, -1.0, x)
    off = 0.0
    for j in range(3):
        if active[j] >= 0:
            normal = row(A, active[j])
            rest = along(rest, -max(multipliers[j], 0.0), normal)
            off += (b[active[j]] - dot(normal, x)) ** 2
    rounding = _ROUNDING * (_size(p) + largest)
    independence = max(_independence(A, active), _ROUNDING)
    if most_violated(columns, b, x, rounding / independence)[0] >= 0:
        return np.inf
    return math.sqrt(dot(rest, rest)) + (math.sqrt(off) + rounding) / independence


@compiled
def _across(V: Floats, simplex: Ints, k: int, g: Vector) -> Vector:
    """Return the part of g normal to a simplex of one, two or three vertices."""
    if k == 1:
        return g
    corner = row(V, simplex[0])
    first = along(row(V, simplex[1]), -1.0, corner)
    if k == 2:
        return along(g, -dot(g, first) / dot(first, first), first)
    normal = cross(first, along(row(V, simplex[2]), -1.0, corner))
    return along((0.0, 0.0, 0.0), dot(g, normal) / dot(normal, normal), normal)


@compiled
def _off_simplex(V: Floats, simplex: Ints, k: int, weights: Floats, x: Vector) -> float:
    """Return how far x is from the convex combination of its vertices with its weights."""
    rest = x
    wrong = -1.0
    for j in range(k):
        rest = along(rest, -weights[j], row(V, simplex[j]))
        wrong += weights[j]
        if weights[j] < 0.0:
            return np.inf
    return math.sqrt(dot(rest, rest)) + abs(wrong) * _size(x)


@compiled
def vertex_bound(
    p: Vector,
    x: Vector,
    V: Floats,
    ptr: Ints,
    adj: Ints,
    largest: float,
    simplex: Ints,
    k: int,
    weights: Floats,
) -> float:
    """Return a bound for the point x closest to p by vertices; 0 for points inside, k = 0.

    Parameters
    ----------
    p, x : vectors
        A point and its closest point.
    V, ptr, adj
        Vertices (n, 3), and their neighbours from `vertex_graph`.
    largest : float
        The largest coordinate of a vertex.
    simplex, weights : (4,) int, float
        The k vertices that span x, and their weights.
    """
    if k == 0:
        return 0.0
    start = simplex[0]
    g = along(p, -1.0, x)
    normal = _across(V, simplex, k, g)
    tangent = along(g, -1.0, normal)
    rounding = _ROUNDING * (_size(p) + largest)
    farthest = climb(V, ptr, adj, start, normal) if adj.size > 0 else highest_vertex(V, normal)
    gap = dot(normal, along(row(V, farthest), -1.0, row(V, start)))
    gap -= rounding * math.sqrt(dot(normal, normal))
    off = math.sqrt(max(2.0 * gap, 0.0)) + _off_simplex(V, simplex, k, weights, x)
    return math.sqrt(dot(tangent, tangent)) + off + rounding
