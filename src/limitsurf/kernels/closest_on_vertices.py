"""Closest points of the convex hull of points in space, with certificates.

A walk over the surface finds most of them (``surface_walk``); where it gives up, or its certificate
is worse than rounding, the method of Gilbert, Johnson and Keerthi does (``gjk``).
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.dual_active_set import SOLVED
from limitsurf.kernels.gjk import closest_by_gjk
from limitsurf.kernels.hill_climbing import Cells, Graph, start_vertex
from limitsurf.kernels.polytope_bounds import vertex_bound
from limitsurf.kernels.simplex import polish
from limitsurf.kernels.surface_walk import Surface, walk_to_closest
from limitsurf.kernels.vectors import along, row

__all__ = ["closest_on_vertices"]

_GOOD = 32 * float(np.finfo(np.float64).eps)


@compiled
def closest_on_vertices(
    points: Floats, V: Floats, graph: Graph, cells: Cells, surface: Surface
) -> tuple[Floats, Ints, Floats, Ints, Ints, Floats]:
    """Return ``(closest, simplex, weights, iterations, status, bound)`` for each of the points.

    Parameters
    ----------
    points : (k, 3) float
        Points to project.
    V : (n, 3) float
        Vertices, n >= 1; points inside their hull do no harm.
    graph : Graph
        Edges of the hull from `vertex_graph`.
    cells : Cells
        Start vertices from `direction_cells`.
    surface : Surface
        From `triangle_surface`; without triangles (flat hulls) all points take the method of `gjk`.

    Returns
    -------
    closest : (k, 3) float
        Closest points; a point of the hull is returned as it is.
    simplex : (k, 4) int32
        Vertices that span the face with the closest point, then -1; all -1 in the hull.
    weights : (k, 4) float
        Their weights >= 0, with sum 1: ``closest = sum_j weights_j V[simplex_j]``.
    iterations : (k,) int32
        Vertices or triangles tried.
    status : (k,) int32
        `SOLVED` or `NOT_CONVERGED`.
    bound : (k,) float
        Certified errors of the closest points, see `vertex_bound`.
    """
    n = points.shape[0]
    closest = np.empty((n, 3))
    simplex = np.full((n, 4), -1, np.int32)
    weights = np.zeros((n, 4))
    iterations = np.empty(n, np.int32)
    status = np.empty(n, np.int32)
    bound = np.empty(n)
    ptr, adj = graph
    start = cells.start
    s, w = np.empty(4, np.int32), np.empty(4)
    for i in range(n):
        p = row(points, i)
        good = _GOOD * max(cells.reach, abs(p[0]), abs(p[1]), abs(p[2]))
        bound[i], k, x = np.inf, 0, p
        if surface.triangles.shape[0] > 0:
            corner = start_vertex(start, cells.stretch, along(p, -1.0, cells.centre))
            k, iterations[i] = walk_to_closest(p, V, ptr, adj, surface, corner, s, w)
        if k > 0:
            x, status[i] = polish(V, s, w, k, p), SOLVED
            bound[i] = vertex_bound(p, x, V, ptr, adj, cells.reach, s, k, w)
        if not bound[i] <= good:
            x, k, iterations[i], status[i] = closest_by_gjk(
                p, V, ptr, adj, start, cells.stretch, cells.centre, cells.reach, s, w
            )
            bound[i] = vertex_bound(p, x, V, ptr, adj, cells.reach, s, k, w)
        closest[i, 0], closest[i, 1], closest[i, 2] = x
        for j in range(k):
            simplex[i, j], weights[i, j] = s[j], w[j]
    return closest, simplex, weights, iterations, status, bound
