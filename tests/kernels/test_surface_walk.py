"""The walk over the surface: against GJK, which knows no triangles; when it gives up, and why."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limitsurf.kernels.closest_on_vertices import closest_on_vertices
from limitsurf.kernels.dual_active_set import SOLVED
from limitsurf.kernels.hill_climbing import direction_cells, start_vertex, vertex_graph
from limitsurf.kernels.surface_walk import triangle_surface, walk_to_closest
from limitsurf.sets.hulls import convex_hull
from tests.kernels.test_gjk import assert_optimal, closest


def body(rng, n, flatness=1.0, center=0.0):
    cloud = rng.normal(size=(n, 3)) * (1.0, 1.0, flatness) + center
    vertices = np.ascontiguousarray(cloud[convex_hull(cloud).vertices])
    graph = vertex_graph(len(vertices), convex_hull(vertices).triangles)
    surface = triangle_surface(convex_hull(vertices).triangles, graph)
    return vertices, graph, direction_cells(vertices, graph), surface


def walk(p, vertices, graph, cells, surface, start=None):
    s, w = np.empty(4, np.int32), np.empty(4)
    if start is None:
        start = start_vertex(cells.start, cells.stretch, tuple(p - np.array(cells.centre)))
    k, count = walk_to_closest(tuple(p), vertices, *graph, surface, start, s, w)
    return s[:k], w[:k], count


def test_the_surface_names_its_neighbours(rng):
    vertices, graph, _, surface = body(rng, 60)
    for t, corners in enumerate(surface.triangles):
        for k in range(3):
            a, b = corners[k], corners[(k + 1) % 3]
            other = surface.triangles[surface.across[t, k]]
            assert {a, b} <= set(other)
            assert surface.across[t, k] != t
            e = graph.ptr[a] + np.searchsorted(graph.adj[graph.ptr[a] : graph.ptr[a + 1]], b)
            assert surface.of_edge[e] == t
    a, b, c = (vertices[surface.triangles[:, k]] for k in range(3))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - vertices.mean(axis=0))
    assert np.all(outward > 0)


@pytest.mark.parametrize("flatness", [1.0, 1e-3, 1e-6])
@pytest.mark.parametrize("n", [4, 20, 300])
def test_agrees_with_gjk(rng, n, flatness):
    vertices, graph, cells, surface = body(rng, n, flatness)
    points = rng.normal(size=(300, 3)) * rng.choice([0.1, 1.0, 5.0], size=(300, 1))
    result = closest_on_vertices(points, vertices, graph, cells, surface)
    slow = closest(points, vertices, convex_hull(vertices).triangles)
    assert result[0] == pytest.approx(slow[0], abs=1e-14 * max(1.0, np.abs(points).max()))
    assert np.array_equal(result[1][:, 0] < 0, slow[1][:, 0] < 0)
    assert_optimal(points, vertices, result)


def test_walks_end_from_every_vertex(rng):
    """The start only decides how long the walk is, not where it ends."""
    vertices, graph, cells, surface = body(rng, 80)
    for p in 4 * rng.normal(size=(5, 3)):
        ends = [walk(p, vertices, graph, cells, surface, v) for v in range(len(vertices))]
        found = np.array([w @ vertices[s] for s, w, _ in ends if len(s)])
        assert len(found) == len(vertices)
        assert found == pytest.approx(np.tile(found[0], (len(found), 1)), abs=1e-13)


def test_few_triangles_do(rng):
    vertices, graph, cells, surface = body(rng, 3000)
    points = 3 * rng.normal(size=(200, 3))
    points = points[np.linalg.norm(points, axis=1) > 5]
    counts = [walk(p, vertices, graph, cells, surface)[2] for p in points]
    assert np.mean(counts) < 5


def test_gives_up_inside_and_gjk_decides(rng):
    vertices, graph, cells, surface = body(rng, 50)
    inner = rng.dirichlet(np.ones(len(vertices)), size=20) @ vertices
    assert all(len(walk(p, vertices, graph, cells, surface)[0]) == 0 for p in inner)
    x, simplex, _, _, status, bound = closest_on_vertices(inner, vertices, graph, cells, surface)
    assert np.array_equal(x, inner)
    assert np.all(simplex == -1)
    assert np.all(status == SOLVED)
    assert np.all(bound == 0.0)


@settings(max_examples=150, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(4, 40),
    st.integers(0, 8),
    st.sampled_from([0.0, 1e3, 1e6]),
)
def test_bounds_hold_on_random_bodies(seed, n, thin, far):
    """Thin bodies and bodies far off: the answer is GJK's within the bounds of both."""
    rng = np.random.default_rng(seed)
    vertices, graph, cells, surface = body(rng, n, 10.0**-thin, far)
    points = vertices.mean(axis=0) + rng.normal(size=(20, 3)) * 10.0 ** rng.uniform(-3, 1)
    result = closest_on_vertices(points, vertices, graph, cells, surface)
    slow = closest(points, vertices, convex_hull(vertices).triangles)
    apart = np.linalg.norm(result[0] - slow[0], axis=1)
    rounding = 1e-15 * np.abs(points).max(axis=1)
    assert np.all(apart <= result[5] + slow[5] + rounding)
    assert np.all(result[5] <= 1e-12 * np.abs(points).max(axis=1) + 1e-12)
