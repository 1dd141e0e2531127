"""Certificates must hold for wrong answers too: they are computed, never assumed."""

import numpy as np
import pytest

from limitsurf.kernels.closest_on_vertices import closest_on_vertices
from limitsurf.kernels.dual_active_set import closest_on_facets
from limitsurf.kernels.hill_climbing import direction_cells, vertex_graph
from limitsurf.kernels.polytope_bounds import facet_bound, vertex_bound
from limitsurf.kernels.surface_walk import triangle_surface
from limitsurf.sets.hulls import convex_hull


def body(rng):
    cloud = rng.normal(size=(40, 3))
    vertices = cloud[convex_hull(cloud).vertices]
    hull = convex_hull(vertices)
    assert np.array_equal(hull.vertices, np.arange(len(vertices)))
    points = 4 * rng.normal(size=(60, 3))
    points = points[(points @ hull.normals.T > hull.offsets).any(axis=1)]
    return vertices, hull, np.ascontiguousarray(points)


def by_vertices(vertices, hull, points):
    graph = vertex_graph(len(vertices), hull.triangles)
    cells = direction_cells(vertices, graph)
    surface = triangle_surface(hull.triangles, graph)
    return graph, closest_on_vertices(points, vertices, graph, cells, surface)


def vertex_bounds(points, x, V, graph, simplex, weights):
    largest = np.abs(V).max()
    rows = zip(points, x, simplex, weights, strict=True)
    return np.array(
        [
            vertex_bound(tuple(p), tuple(q), V, *graph, largest, s, int((s >= 0).sum()), w)
            for p, q, s, w in rows
        ]
    )


def facet_bounds(points, x, A, b, active, multipliers):
    columns, largest = np.ascontiguousarray(A.T), np.abs(b).max()
    rows = zip(points, x, active, multipliers, strict=True)
    return np.array(
        [facet_bound(tuple(p), tuple(q), A, columns, b, largest, a, u) for p, q, a, u in rows]
    )


def test_right_answers_get_bounds_of_rounding_size(rng):
    vertices, hull, points = body(rng)
    graph, (x, simplex, weights, _, _, found) = by_vertices(vertices, hull, points)
    assert found.max() < 1e-12
    assert vertex_bounds(points, x, vertices, graph, simplex, weights) == pytest.approx(found)
    y, active, multipliers, _, _, found = closest_on_facets(points, hull.normals, hull.offsets)
    assert x == pytest.approx(y, abs=1e-12)
    bounds = facet_bounds(points, y, hull.normals, hull.offsets, active, multipliers)
    assert bounds == pytest.approx(found)
    assert found.max() < 1e-11


@pytest.mark.parametrize("shift", [1e-9, 1e-6, 1e-3, 0.3])
def test_points_moved_off_keep_honest_bounds(rng, shift):
    vertices, hull, points = body(rng)
    graph, (x, simplex, weights, *_) = by_vertices(vertices, hull, points)
    moved = x + shift * rng.normal(size=x.shape)
    error = np.linalg.norm(moved - x, axis=1)
    assert np.all(vertex_bounds(points, moved, vertices, graph, simplex, weights) >= error)
    _, active, multipliers, *_ = closest_on_facets(points, hull.normals, hull.offsets)
    bounds = facet_bounds(points, moved, hull.normals, hull.offsets, active, multipliers)
    assert np.all(bounds >= error)


def test_the_wrong_place_on_the_right_face(rng):
    vertices, hull, points = body(rng)
    graph, (x, simplex, *_) = by_vertices(vertices, hull, points)
    weights = np.where(simplex >= 0, rng.uniform(0.1, 1.0, size=simplex.shape), 0.0)
    weights /= weights.sum(axis=1, keepdims=True)
    wrong = np.einsum("kj,kji->ki", weights, vertices[simplex])
    bounds = vertex_bounds(points, wrong, vertices, graph, simplex, weights)
    assert np.all(bounds >= np.linalg.norm(wrong - x, axis=1))


def test_the_wrong_vertex(rng):
    vertices, hull, points = body(rng)
    graph, (x, *_) = by_vertices(vertices, hull, points)
    chosen = rng.integers(len(vertices), size=len(points))
    simplex = np.full((len(points), 4), -1, np.int32)
    simplex[:, 0] = chosen
    weights = np.where(simplex >= 0, 1.0, 0.0)
    wrong = vertices[chosen]
    bounds = vertex_bounds(points, wrong, vertices, graph, simplex, weights)
    assert np.all(bounds >= np.linalg.norm(wrong - x, axis=1))


def test_a_facet_left_out_has_no_bound():
    A, b = np.vstack([np.eye(3), -np.eye(3)]), np.ones(6)
    p, wrong = np.array([[2.0, 2.0, 0.0]]), np.array([[1.0, 2.0, 0.0]])
    active, multipliers = np.array([[0, -1, -1]], np.int32), np.array([[1.0, 0.0, 0.0]])
    assert np.isinf(facet_bounds(p, wrong, A, b, active, multipliers)[0])
