"""Closest points from vertices: against all faces, edges and vertices, and against the facets."""

import itertools

import numpy as np
import pytest

from limitsurf.kernels.closest_on_vertices import closest_on_vertices
from limitsurf.kernels.dual_active_set import SOLVED, closest_on_facets
from limitsurf.kernels.hill_climbing import direction_cells, support_vertices, vertex_graph
from limitsurf.kernels.surface_walk import triangle_surface
from tests.kernels.test_dual_active_set import (
    closest_by_force,
    points_outside,
    random_hull,
    relative_error,
)

TOL = 1e-15
NO_TRIANGLES = np.empty((0, 3), dtype=int)


NO_SURFACE = triangle_surface(NO_TRIANGLES, vertex_graph(0, NO_TRIANGLES))


def closest(points, V, triangles=NO_TRIANGLES):
    """Return what GJK finds; without a surface there is no walk."""
    graph = vertex_graph(len(V), triangles)
    return closest_on_vertices(points, V, graph, direction_cells(V, graph), NO_SURFACE)


def all_triangles(V):
    """Return the triangles of all vertex triples: they cover every flat set."""
    return V[list(itertools.combinations_with_replacement(range(len(V)), 3))]


def assert_optimal(points, V, result, tol=TOL):
    """Check that the weights give x, and that no vertex lies beyond x as seen from the point."""
    x, simplex, w, _, status, _ = result
    size = np.maximum(np.linalg.norm(points, axis=1), np.linalg.norm(V, axis=1).max())
    assert np.all(status == SOLVED)
    assert np.all(w >= 0)
    for i, p in enumerate(points):
        chosen = simplex[i][simplex[i] >= 0]
        k = len(chosen)
        assert np.all(simplex[i][k:] == -1)
        assert len(set(chosen)) == k
        if k == 0:
            assert np.array_equal(x[i], p)
            continue
        assert w[i, :k].sum() == pytest.approx(1.0, abs=1e-15)
        assert w[i, :k] @ V[chosen] == pytest.approx(x[i], abs=tol * size[i])
        y = x[i] - p
        assert np.max((x[i] - V) @ y) <= 4 * tol * size[i] * np.linalg.norm(V, axis=1).max()


def assert_matches(points, V, triangles, result, tol=TOL):
    assert_optimal(points, V, result, tol)
    assert relative_error(result[0], closest_by_force(points, triangles), points, V) <= tol


@pytest.mark.parametrize("facets", [20, 60, 200, 2000])
def test_matches_all_faces_edges_and_vertices(rng, facets):
    V, triangles, A, b = random_hull(rng, facets)
    points = points_outside(rng, V, 100)
    result = closest(points, V, triangles)
    assert_matches(points, V, V[triangles], result)
    assert result[0] == pytest.approx(closest_on_facets(points, A, b)[0], abs=1e-13)
    assert closest(points, V)[0] == pytest.approx(result[0], abs=5 * TOL)


@pytest.mark.parametrize("flatness", [1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("facets", [20, 200, 2000])
def test_flat_bodies(rng, facets, flatness):
    V, triangles, A, b = random_hull(rng, facets, (1.0, 0.7, 0.4 * flatness))
    around = rng.normal(size=(60, 3)) * (2.0, 2.0, 1.0)
    close = rng.normal(size=(60, 3)) * (0.5, 0.3, 1e-5)
    points = np.concatenate([points_outside(rng, V, 60), around, close])
    points = points[np.max(points @ A.T - b, axis=1) > 1e-15]
    assert_matches(points, V, V[triangles], closest(points, V, triangles))


@pytest.mark.parametrize("facets", [20, 200])
def test_points_inside_stay_where_they_are(rng, facets):
    V, triangles, _, _ = random_hull(rng, facets)
    points = rng.dirichlet(np.ones(len(V)), 200) @ V
    for result in (closest(points, V, triangles), closest(points, V)):
        assert np.array_equal(result[0], points)
        assert np.all(result[1] == -1)
        assert not result[2].any()
        assert np.all(result[4] == SOLVED)


def test_points_on_the_boundary_hardly_move(rng):
    V, triangles, _, _ = random_hull(rng, 200)
    corners = V[triangles]
    for points in (corners[:, 0], corners[:, :2].mean(axis=1), corners.mean(axis=1)):
        result = closest(points, V, triangles)
        assert np.all(result[4] == SOLVED)
        assert np.abs(result[0] - points).max() <= TOL


@pytest.mark.parametrize("height", [1e-4, 1e-8, 1e-12])
def test_points_close_to_faces(rng, height):
    V, triangles, A, _ = random_hull(rng, 200)
    feet = V[triangles].mean(axis=1)
    points = feet + height * A
    result = closest(points, V, triangles)
    assert_optimal(points, V, result)
    assert np.abs(result[0] - feet).max() <= 2 * TOL


@pytest.mark.parametrize("distance", [1e3, 1e6])
def test_far_points(rng, distance):
    V, triangles, _, _ = random_hull(rng, 200)
    points = distance * rng.normal(size=(100, 3))
    assert_matches(points, V, V[triangles], closest(points, V, triangles))


def test_a_body_far_from_the_origin(rng):
    V, triangles, _, _ = random_hull(rng, 200, centre=np.array([1e3, -1e3, 5e2]))
    points = points_outside(rng, V, 100)
    assert_matches(points, V, V[triangles], closest(points, V, triangles))


def degenerate_sets(rng):
    a, b, c = rng.normal(size=(3, 3))
    square = a + np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) @ np.array([b, c])
    line = a + np.linspace(0, 1, 7)[:, None] * b
    yield "point", np.array([a])
    yield "repeated point", np.array([a, a, a])
    yield "segment", np.array([a, b])
    yield "points on a line", line
    yield "triangle", np.array([a, b, c])
    yield "repeated corners", np.array([a, b, c, a, b, c])
    yield "parallelogram", square
    yield "parallelogram with points on its sides", np.concatenate([square, line[1:-1]])
    yield "tetrahedron", np.concatenate([[a, b, c], rng.normal(size=(1, 3))])


def test_degenerate_sets(rng):
    for name, V in degenerate_sets(rng):
        inside = rng.dirichlet(np.ones(len(V)), 20) @ V
        points = np.concatenate([rng.normal(size=(50, 3)), 5 * rng.normal(size=(50, 3))])
        if name == "tetrahedron":
            points *= 4
        result = closest(points, V)
        assert_matches(points, V, all_triangles(V), result)
        on_the_set = closest(inside, V)
        assert np.abs(on_the_set[0] - inside).max() <= 2 * TOL, name
        assert np.all(on_the_set[4] == SOLVED), name


@pytest.mark.parametrize(("width", "tol"), [(1e-3, TOL), (1e-6, 1e-13), (1e-9, 2e-9)])
def test_needles(rng, width, tol):
    """Triangles with one short side, seen from everywhere.

    Heights tell vertices apart only if they differ by more than rounding; the width bounds the
    error.
    """
    for _ in range(20):
        a, d = rng.normal(size=(2, 3))
        V = np.array([a, a + width * rng.normal(size=3), a + d])
        around = rng.normal(size=(40, 3))
        normal = np.cross(V[1] - V[0], d) / np.linalg.norm(np.cross(V[1] - V[0], d))
        above = rng.dirichlet(np.ones(3), 20) @ V + rng.normal(size=(20, 1)) * normal
        points = np.concatenate([around, above])
        assert_matches(points, V, V[None], closest(points, V), tol)


def test_prisms_have_thin_sides(rng):
    """A thin plate with a rim of needles and coplanar faces."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, 30))
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    for thickness in (1.0, 1e-3, 1e-6):
        V = np.concatenate([np.column_stack([ring, np.full(30, z)]) for z in (0.0, thickness)])
        i = np.arange(30)
        j = (i + 1) % 30
        rim = np.concatenate(
            [np.column_stack([i, j, i + 30]), np.column_stack([j, j + 30, i + 30])]
        )
        fan = np.column_stack([np.zeros(28, dtype=int), i[1:-1], i[2:]])
        triangles = np.concatenate([rim, fan, fan + 30])
        points = rng.normal(size=(200, 3)) * (1.5, 1.5, 1.0)
        in_plate = (points[:, 2] >= 0) & (points[:, 2] <= thickness)
        points = points[~in_plate | (np.hypot(*points[:, :2].T) > 1)]
        assert_matches(points, V, V[triangles], closest(points, V, triangles))


@pytest.mark.parametrize("facets", [20, 200, 2000])
def test_support_vertices(rng, facets):
    V, triangles, _, _ = random_hull(rng, facets, centre=0.3)
    directions = rng.normal(size=(500, 3)) * np.exp(rng.normal(size=(500, 1)))
    graph = vertex_graph(len(V), triangles)
    found = support_vertices(directions, V, graph, direction_cells(V, graph))
    assert np.array_equal(found, (directions @ V.T).argmax(axis=1))


def test_points_within_the_hull_do_no_harm(rng):
    V, triangles, _, _ = random_hull(rng, 200)
    padded = np.concatenate([0.5 * V, V])
    points = points_outside(rng, V, 50)
    shifted = triangles + len(V)
    assert closest(points, padded, shifted)[0] == pytest.approx(
        closest(points, V, triangles)[0], abs=TOL
    )


def test_vertex_graph_of_a_tetrahedron_and_of_nothing():
    faces = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
    graph = vertex_graph(5, faces)
    assert np.array_equal(graph.ptr, [0, 3, 6, 9, 12, 12])
    assert np.array_equal(graph.adj, [1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2])
    empty = vertex_graph(3, NO_TRIANGLES)
    assert np.array_equal(empty.ptr, np.zeros(4))
    assert empty.adj.size == 0


def test_a_point_that_is_no_number_does_not_hang(rng):
    V, triangles, _, _ = random_hull(rng, 200)
    points = np.full((1, 3), np.nan)
    assert np.all(closest(points, V, triangles)[3] <= 1)
