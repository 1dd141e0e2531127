"""Polytopes by vertices, by facets, by generators: conversions, degenerate ones, faces."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from limitsurf.errors import InputError
from limitsurf.sets.h_polytope import HPolytope
from limitsurf.sets.v_polytope import VPolytope
from limitsurf.sets.zonotope import Zonotope
from tests.sets.specimens import box, polygon_contact


def directions(rng, dim, k=200):
    return rng.normal(size=(k, dim))


def clouds(rng):
    yield rng.normal(size=(20, 3))
    yield rng.normal(size=(20, 3)) * [1, 1, 0]
    yield np.outer(rng.normal(size=5), [1.0, 2.0, 3.0])
    yield np.array([[1.0, 2.0, 3.0]])
    yield rng.normal(size=(12, 2))
    yield rng.normal(size=(12, 4))
    yield np.array([[1.0], [4.0], [2.0]])


def test_vertices_to_facets_and_back(rng):
    for cloud in clouds(rng):
        V = VPolytope(cloud)
        again = V.to_h().to_v()
        d = directions(rng, V.dim)
        assert again.support(d) == pytest.approx(V.support(d), abs=1e-8)
        assert V.support(d) == pytest.approx((d @ cloud.T).max(axis=1), abs=1e-12)


def test_facets_to_vertices_and_back(rng):
    for H in (box(1.0, 2.0, 0.5), box(1.0, 2.0, 0.0), box(1.0, 0.0, 0.0), box(0.0, 0.0, 0.0)):
        V = H.to_v()
        d = directions(rng, 3)
        assert V.to_h().to_v().support(d) == pytest.approx(V.support(d), abs=1e-9)
        assert np.all(V.vertices @ H.A.T <= H.b + 1e-9)
    assert len(box(1.0, 2.0, 0.5).to_v().vertices) == 8
    assert box(1.0, 2.0, 0.0).to_v().rank == 2


def test_the_two_representations_project_alike(rng):
    for cloud in clouds(rng):
        V = VPolytope(cloud)
        p = 3 * rng.normal(size=(20, V.dim))
        assert V.to_h().project(p).point == pytest.approx(V.project(p).point, abs=1e-7)


def test_zonotopes_are_polytopes(rng):
    Z = Zonotope(rng.normal(size=3), rng.normal(size=(5, 3)))
    signs = np.array(np.meshgrid(*[[-1, 1]] * 5)).reshape(5, -1).T
    V = VPolytope(Z.center + signs @ Z.generators)
    d = directions(rng, 3)
    assert Z.support(d) == pytest.approx(V.support(d))
    p = 4 * rng.normal(size=(10, 3))
    assert Z.project(p).distance == pytest.approx(V.project(p).distance, abs=1e-6)


def test_inner_points_are_dropped(rng):
    cube = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    V = VPolytope(np.vstack([cube, 0.9 * rng.uniform(-1, 1, size=(50, 3))]))
    assert len(V.vertices) == 8
    assert VPolytope([[0, 0], [1, 1], [0.5, 0.5]]).vertices.shape == (2, 2)


def test_faces_of_a_cube():
    cube = box(1.0, 1.0, 1.0)
    assert len(cube.face([1, 0, 0]).vertices) == 4
    assert len(cube.face([1, 1, 0]).vertices) == 2
    assert len(cube.face([1, 1, 1]).vertices) == 1
    contact = polygon_contact(1.0, 0.0)
    assert contact.face([0.0, -1.0, 1.0]).rank == 2


def test_faces_of_a_zonotope():
    Z = Zonotope([0, 0, 0], np.eye(3))
    assert len(Z.face([1, 0, 0]).generators) == 2
    assert Z.face([1, 0, 0]).center == pytest.approx([1, 0, 0])
    assert len(Z.face([1, 2, 3]).generators) == 0


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.integers(1, 3), st.integers(0, 2))
def test_random_hulls_satisfy_the_optimality_conditions(seed, k, n, flat):
    rng = np.random.default_rng(seed)
    cloud = rng.normal(size=(k, n))
    cloud[:, :flat] *= 10.0 ** -rng.integers(0, 7)
    V = VPolytope(cloud + 10 * rng.normal(size=n))
    p = 3 * rng.normal(size=(5, n)) + V.vertices.mean(axis=0)
    projection = V.project(p)
    e = p - projection.point
    gap = V.support(e) - np.einsum("ij,ij->i", e, projection.point)
    assert np.all(np.abs(gap) <= 1e-11 * (1 + np.linalg.norm(e, axis=1)) * 50)


def test_unbounded_polytopes_project_but_have_no_support():
    wedge = HPolytope([[-1, 0], [0, -1]], [0, 0])
    assert wedge.project([-3.0, 2.0]).point == pytest.approx([0.0, 2.0])
    assert not wedge.bounded
    for query in (wedge.to_v, lambda: wedge.support([1, 0]), lambda: wedge.face([1, 0])):
        with pytest.raises(InputError, match="unbounded"):
            query()


@pytest.mark.parametrize(
    ("build", "problem"),
    [
        (lambda: HPolytope([[1, 0], [-1, 0]], [0, -1]), "empty polytope"),
        (lambda: HPolytope([[1, 0]], [0, 1]), "b: has shape"),
        (lambda: HPolytope([[0, 0]], [1]), "zero row"),
        (lambda: HPolytope(np.empty((0, 2)), []), "no rows"),
        (lambda: HPolytope([[np.nan, 0]], [1]), "not finite"),
        (lambda: VPolytope(np.empty((0, 3))), "missing"),
        (lambda: VPolytope([1.0, 2.0]), "vertices: has shape"),
        (lambda: VPolytope([[1.0, np.inf]]), "not finite"),
        (lambda: Zonotope([0, 0], [[1, 0, 0]]), "generators: has shape"),
    ],
)
def test_bad_polytopes(build, problem):
    with pytest.raises(InputError, match=problem):
        build()


def test_meshes_are_closed_and_outward(rng):
    vertices, triangles = VPolytope(rng.normal(size=(40, 3))).to_mesh()
    edges = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert len(np.unique(np.sort(edges, axis=1), axis=0)) * 2 == len(edges)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume > 0
    flat, both_sides = polygon_contact(1.0, 0.0).to_mesh()
    assert len(both_sides) == 2 * (len(flat) - 2)
    with pytest.raises(InputError, match="meshes need 3"):
        VPolytope(rng.normal(size=(5, 2))).to_mesh()


def test_projections_report_the_exact_face(rng):
    """The vertices span a face with the closest point in it; the facets hold with equality."""
    cloud = rng.normal(size=(120, 3))
    V = VPolytope(cloud)
    for H in (V.to_h(), box(1.0, 2.0, 0.5), box(1.0, 2.0, 1e-6)):
        p = 4 * rng.normal(size=(40, 3))
        projection = H.project(p)
        assert np.array_equal(projection.active[:, 0] >= 0, ~projection.inside)
        for k in np.flatnonzero(~projection.inside):
            facets = projection.active[k][projection.active[k] >= 0]
            assert H.A[facets] @ projection.point[k] == pytest.approx(H.b[facets], abs=1e-9)
            # the residual is a non-negative combination of the facets' normals
            _, rest = nnls(H.A[facets].T, p[k] - projection.point[k])
            assert rest <= 1e-8
    projection = V.project(p)
    outside = ~projection.inside
    for x, vertices in zip(projection.point[outside], projection.active[outside], strict=True):
        vertices = V.vertices[vertices[vertices >= 0]]
        weights, *_ = np.linalg.lstsq(
            np.vstack([vertices.T, np.ones(len(vertices))]), np.append(x, 1.0), rcond=None
        )
        assert np.all(weights >= -1e-9)
        assert vertices.T @ weights == pytest.approx(x, abs=1e-10)
    inside = V.project(V.vertices.mean(axis=0))
    assert np.all(inside.active == -1)
    assert box(1, 1, 1).project([2.0, 2.0, 0.0]).active.tolist()[:2] != [-1, -1]
