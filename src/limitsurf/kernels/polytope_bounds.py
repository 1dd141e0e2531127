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
from limitsurf.kernels.dual_active_set import most_violated
from limitsurf.kernels.hill_climbing import Graph, climb, highest_vertex
from limitsurf.kernels.vectors import Vector, along, cross, dot, row, transposed

__all__ = ["common_facets", "facet_bounds", "vertex_bounds"]

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
def facet_bounds(
    points: Floats, closest: Floats, A: Floats, b: Floats, active: Ints, multipliers: Floats
) -> Floats:
    """Return bounds (k,) for closest points by facets; 0 for points inside.

    Parameters
    ----------
    points, closest : (k, 3) float
        Points and their closest points.
    A, b : (m, 3), (m,) float
        Facets, rows of A of length 1.
    active, multipliers : (k, 3) int, float
        From `closest_on_facets`.
    """
    bounds = np.zeros(points.shape[0])
    columns = transposed(A)
    largest = np.abs(b).max()
    for k in range(points.shape[0]):
        if active[k, 0] < 0:
            continue
        p, x = row(points, k), row(closest, k)
        rest = along(p, -1.0, x)
        off = 0.0
        for j in range(3):
            if active[k, j] >= 0:
                normal = row(A, active[k, j])
                rest = along(rest, -max(multipliers[k, j], 0.0), normal)
                off += (b[active[k, j]] - dot(normal, x)) ** 2
        rounding = _ROUNDING * (_size(p) + largest)
        independence = max(_independence(A, active[k]), _ROUNDING)
        bounds[k] = math.sqrt(dot(rest, rest)) + (math.sqrt(off) + rounding) / independence
        if most_violated(columns, b, x, rounding / independence)[0] >= 0:
            bounds[k] = np.inf
    return bounds


@compiled
def _across(V: Floats, simplex: Ints, g: Vector) -> Vector:
    """Return the part of g normal to a simplex of one, two or three vertices."""
    if simplex[1] < 0:
        return g
    corner = row(V, simplex[0])
    first = along(row(V, simplex[1]), -1.0, corner)
    if simplex[2] < 0:
        return along(g, -dot(g, first) / dot(first, first), first)
    normal = cross(first, along(row(V, simplex[2]), -1.0, corner))
    return along((0.0, 0.0, 0.0), dot(g, normal) / dot(normal, normal), normal)


@compiled
def _off_simplex(V: Floats, simplex: Ints, weights: Floats, x: Vector) -> float:
    """Return how far x is from the convex combination of its vertices with its weights."""
    rest = x
    wrong = -1.0
    for j in range(4):
        if simplex[j] >= 0:
            rest = along(rest, -weights[j], row(V, simplex[j]))
            wrong += weights[j]
            if weights[j] < 0.0:
                return np.inf
    return math.sqrt(dot(rest, rest)) + abs(wrong) * _size(x)


@compiled
def vertex_bounds(
    points: Floats, closest: Floats, V: Floats, graph: Graph, simplex: Ints, weights: Floats
) -> Floats:
    """Return bounds (k,) for closest points by vertices; 0 for points inside.

    Parameters
    ----------
    points, closest : (k, 3) float
        Points and their closest points.
    V, graph
        Vertices (n, 3), and their neighbours from `vertex_graph`.
    simplex, weights : (k, 4) int, float
        From `closest_on_vertices`.
    """
    bounds = np.zeros(points.shape[0])
    largest = np.abs(V).max()
    ptr, adj = graph
    for k in range(points.shape[0]):
        start = simplex[k, 0]
        if start < 0:
            continue
        p, x = row(points, k), row(closest, k)
        g = along(p, -1.0, x)
        normal = _across(V, simplex[k], g)
        tangent = along(g, -1.0, normal)
        rounding = _ROUNDING * (_size(p) + largest)
        farthest = climb(V, ptr, adj, start, normal) if adj.size > 0 else highest_vertex(V, normal)
        gap = dot(normal, along(row(V, farthest), -1.0, row(V, start)))
        gap -= rounding * math.sqrt(dot(normal, normal))
        bounds[k] = math.sqrt(dot(tangent, tangent)) + math.sqrt(max(2.0 * gap, 0.0)) + rounding
        bounds[k] += _off_simplex(V, simplex[k], weights[k], x)
    return bounds


@compiled
def common_facets(simplex: Ints, ptr: Ints, facets: Ints) -> Ints:
    """Return up to three facets through all vertices of each simplex (k, 4), then -1.

    The facets through vertex i are ``facets[ptr[i]:ptr[i + 1]]``, ascending.
    """
    found = np.full((simplex.shape[0], 3), -1, np.int32)
    for k in range(simplex.shape[0]):
        if simplex[k, 0] < 0:
            continue
        count = 0
        for e in range(ptr[simplex[k, 0]], ptr[simplex[k, 0] + 1]):
            shared = True
            for j in range(1, 4):
                i = simplex[k, j]
                shared = shared and (i < 0 or _holds(facets, ptr[i], ptr[i + 1], facets[e]))
            if shared and count < 3:
                found[k, count] = facets[e]
                count += 1
    return found


@compiled
def _holds(values: Ints, start: int, end: int, value: int) -> bool:
    for e in range(start, end):  # noqa: SIM110 - compiled
        if values[e] == value:
            return True
    return False
