"""Closest points from facets: against all faces, edges and vertices, and by the KKT conditions."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from limitsurf.kernels.dual_active_set import (
    INFEASIBLE,
    SOLVED,
    closest_on_facets,
    most_violated,
)
from limitsurf.kernels.vectors import transposed

TOL = 1e-13


def closest_on_edges(p, a, b):
    """Return the points of the segments ab (t, 3) closest to p."""
    edge = b - a
    length2 = np.maximum((edge * edge).sum(axis=1), np.finfo(float).tiny)
    along = ((p - a) * edge).sum(axis=1) / length2
    return a + np.clip(along, 0, 1)[:, None] * edge


def closest_in_planes(p, a, b, c):
    """Return the projections of p into the planes abc; p itself where they miss the triangle."""
    normal = np.cross(b - a, c - a)
    length2 = np.maximum((normal * normal).sum(axis=1), np.finfo(float).tiny)
    x = p - (((p - a) * normal).sum(axis=1) / length2)[:, None] * normal
    inside = np.ones(len(a), dtype=bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(v - u, x - u) * normal).sum(axis=1) >= 0
    return np.where((inside & (length2 > 1e-300))[:, None], x, np.inf)


def closest_by_force(points, triangles):
    """Return the points of the triangles (t, 3, 3) closest to each point, in long doubles."""
    a, b, c = np.moveaxis(triangles.astype(np.longdouble), 1, 0)
    found = []
    for p in points.astype(np.longdouble):
        x = np.concatenate(
            [
                closest_on_edges(p, a, b),
                closest_on_edges(p, b, c),
                closest_on_edges(p, c, a),
                closest_in_planes(p, a, b, c),
            ]
        )
        found.append(x[((x - p) ** 2).sum(axis=1).argmin()])
    return np.array(found, dtype=float)


def random_hull(rng, facets, shape=(1.0, 0.7, 0.4), centre=0.0):
    """Return vertices on an ellipsoid, triangles, and facets ``A x <= b``."""
    V = rng.normal(size=(facets // 2 + 2, 3))
    V = V / np.linalg.norm(V, axis=1)[:, None] * shape + centre
    hull = ConvexHull(V)
    assert len(hull.simplices) == facets
    A = np.ascontiguousarray(hull.equations[:, :3])
    b = np.max(V @ A.T, axis=0)
    return V, hull.simplices, A, b


def points_outside(rng, V, n, reach=3.0):
    """Return points from just outside the hull to several sizes away."""
    centre = V.mean(axis=0)
    triangles = V[rng.integers(len(V), size=(n, 3))]
    d = triangles.mean(axis=1) - centre + 0.1 * rng.normal(size=(n, 3))
    factor = np.max(d @ (V - centre).T, axis=1) / (d * d).sum(axis=1)
    return centre + d * (factor * np.exp(rng.uniform(1e-3, np.log(reach), n)))[:, None]


def relative_error(x, y, points, V):
    scale = np.maximum(np.linalg.norm(points, axis=1), np.linalg.norm(V, axis=1).max())
    return (np.linalg.norm(x - y, axis=1) / scale).max()


def assert_optimal(points, A, b, result, tol=TOL):
    """Check feasibility, and that the residual lies in the cone of facets that hold x."""
    x, active, u, _, status, _ = result
    scale = np.maximum(np.linalg.norm(points, axis=1), np.abs(b).max())
    assert np.all(status == SOLVED)
    assert np.all(u >= 0)
    assert np.all((x @ A.T - b).max(axis=1) <= tol * scale)
    for i, p in enumerate(points):
        chosen = active[i][active[i] >= 0]
        k = len(chosen)
        assert np.all(active[i][k:] == -1)
        assert len(set(chosen)) == k
        rounding = tol * scale[i] + 1e-15 * u[i].sum()  # opposite normals: large multipliers
        assert p - x[i] == pytest.approx(A[chosen].T @ u[i, :k], abs=rounding)
        assert A[chosen] @ x[i] == pytest.approx(b[chosen], abs=tol * scale[i])


@pytest.mark.parametrize("facets", [20, 200, 2000])
def test_matches_all_faces_edges_and_vertices(rng, facets):
    V, triangles, A, b = random_hull(rng, facets)
    points = points_outside(rng, V, 100)
    result = closest_on_facets(points, A, b)
    assert_optimal(points, A, b, result)
    assert relative_error(result[0], closest_by_force(points, V[triangles]), points, V) <= TOL


@pytest.mark.parametrize("flatness", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("facets", [20, 200, 2000])
def test_flat_bodies(rng, facets, flatness):
    """The facets of a flat body know its outline only to the rounding divided by the flatness."""
    V, triangles, A, b = random_hull(rng, facets, (1.0, 0.7, 0.4 * flatness))
    points = rng.normal(size=(100, 3)) * (2.0, 2.0, 1.0)
    result = closest_on_facets(points, A, b)
    assert_optimal(points, A, b, result)
    error = relative_error(result[0], closest_by_force(points, V[triangles]), points, V)
    assert error <= 1e-15 / flatness


def test_points_inside_stay_where_they_are(rng):
    V, _, A, b = random_hull(rng, 200)
    points = 0.9 * V
    x, active, u, iterations, status, _ = closest_on_facets(points, A, b)
    assert np.array_equal(x, points)
    assert np.all(active == -1)
    assert not u.any()
    assert not iterations.any()
    assert np.all(status == SOLVED)


def test_points_on_the_boundary_hardly_move(rng):
    V, triangles, A, b = random_hull(rng, 200)
    corners = V[triangles]
    for points in (corners[:, 0], corners[:, :2].mean(axis=1), corners.mean(axis=1)):
        result = closest_on_facets(points, A, b)
        assert_optimal(points, A, b, result)
        assert np.abs(result[0] - points).max() <= 2e-15


@pytest.mark.parametrize("distance", [1e3, 1e6])
def test_far_points(rng, distance):
    V, triangles, A, b = random_hull(rng, 200)
    points = distance * rng.normal(size=(100, 3))
    result = closest_on_facets(points, A, b)
    assert_optimal(points, A, b, result)
    assert relative_error(result[0], closest_by_force(points, V[triangles]), points, V) <= TOL
    assert np.max(result[0] @ A.T - b) <= 1e-14  # however far the point, x is on the body


def test_a_body_far_from_the_origin(rng):
    V, triangles, A, b = random_hull(rng, 200, centre=np.array([1e3, -1e3, 5e2]))
    points = points_outside(rng, V, 100)
    result = closest_on_facets(points, A, b)
    assert_optimal(points, A, b, result)
    assert relative_error(result[0], closest_by_force(points, V[triangles]), points, V) <= TOL


@pytest.mark.parametrize("angle", [1e-3, 1e-6, 1e-9])
def test_nearly_parallel_facets_meet_in_their_edge(angle):
    """Rounding of ``a.x - b`` leaves the place of the edge open by itself over the angle."""
    A = np.array([[0.0, 0.0, 1.0], [np.sin(angle), 0.0, np.cos(angle)]])
    points = np.array([[0.5 * np.sin(angle), 2.0, 1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]])
    result = closest_on_facets(points, A, np.zeros(2))
    assert_optimal(points, A, np.zeros(2), result)
    slope = points[1] - (A[1] @ points[1]) * A[1]
    closest = np.array([[0, 2, 0], slope, [-1, 0, 0]])
    assert result[0] == pytest.approx(closest, abs=max(TOL, 1e-15 / angle))


@pytest.mark.parametrize("thickness", [1.0, 1e-9, 0.0])
def test_slabs(thickness):
    A = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    x = closest_on_facets(np.array([[1.0, 2, 3], [1, 2, -3]]), A, np.array([thickness, 0.0]))[0]
    assert np.array_equal(x, [[1, 2, thickness], [1, 2, 0]])


def test_repeated_and_idle_facets_change_nothing(rng):
    V, _, A, b = random_hull(rng, 20)
    points = points_outside(rng, V, 100)
    more_A, more_b = np.concatenate([A, A, A]), np.concatenate([b, b, b + 1e-3])
    result = closest_on_facets(points, more_A, more_b)
    assert_optimal(points, more_A, more_b, result)
    assert result[0] == pytest.approx(closest_on_facets(points, A, b)[0], abs=TOL)


def test_few_facets():
    p = np.array([[1.0, 2.0, 3.0]])
    assert np.array_equal(closest_on_facets(p, np.empty((0, 3)), np.empty(0))[0], p)
    corner = closest_on_facets(p, np.eye(3), np.zeros(3))
    assert np.array_equal(corner[0], np.zeros((1, 3)))
    assert sorted(zip(corner[1][0], corner[2][0], strict=True)) == [(0, 1), (1, 2), (2, 3)]


def empty_polytopes(rng):
    corner = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)
    angles = np.array([0.0, 2.0, 4.0])
    prism = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    V, _, A, b = random_hull(rng, 200)
    yield np.array([[1.0, 0, 0], [-1, 0, 0]]), np.array([-1.0, 0.5])
    yield prism, np.full(3, -0.1)
    yield corner, np.full(4, -0.1)
    yield A, b - 2 * np.max(V @ A.T)
    yield np.concatenate([A, -A[:1]]), np.append(b, -b[0] - 1e-6)


def test_empty_polytopes_are_seen(rng):
    for A, b in empty_polytopes(rng):
        status = closest_on_facets(rng.normal(size=(50, 3)), A, b)[4]
        assert np.all(status == INFEASIBLE)


def test_a_point_that_is_no_number_does_not_hang(rng):
    _, _, A, b = random_hull(rng, 200)
    assert np.isnan(closest_on_facets(np.full((1, 3), np.nan), A, b)[0]).all()


@pytest.mark.parametrize("m", [0, 1, 63, 64, 256, 257, 1000])
def test_most_violated_by_blocks(rng, m):
    A, b = rng.normal(size=(m, 3)), rng.normal(size=m)
    for x in rng.normal(size=(20, 3)):
        violation = A @ x - b
        index, largest = most_violated(transposed(A), b, tuple(x), 0.0)
        if m == 0 or violation.max() <= 0:
            assert index == -1
        else:
            assert index == violation.argmax()
            assert largest == pytest.approx(violation.max(), rel=1e-14)
