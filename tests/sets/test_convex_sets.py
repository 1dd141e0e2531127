"""Every set, every query, against the conic twin and against the theory."""

import cvxpy as cp
import numpy as np
import pytest

from limitsurf.errors import InputError, LimitSurfError, SolveFailed
from limitsurf.sets.arguments import read_metric
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.linear_image import LinearImage
from limitsurf.sets.projection import Status
from tests.sets.specimens import SPECIMENS

NAMES = list(SPECIMENS)
#: Sums with a disk have no kernel: an interior-point method finds points to the root of its gap.
CONIC = ["bar", "collinear contacts", "disk and box", "moved bar"]


@pytest.fixture(params=NAMES)
def specimen(request):
    return SPECIMENS[request.param]


def is_exact(S):
    return not any(S is SPECIMENS[name] for name in CONIC)


def middle_and_size(S):
    """Return the centre of the bounding box and its half diagonal."""
    d = np.vstack([np.eye(S.dim), -np.eye(S.dim)])
    h = S.support(d)
    low, high = -h[S.dim :], h[: S.dim]
    return (low + high) / 2, max(np.linalg.norm(high - low) / 2, 1e-3)


def points_around(S, rng, k=12):
    middle, size = middle_and_size(S)
    spread = rng.choice([0.1, 0.5, 1.5, 4.0], size=(k, 1))
    return middle + size * spread * rng.normal(size=(k, S.dim))


def scale_of(S, p):
    return np.abs(p).max() + middle_and_size(S)[1] + np.abs(middle_and_size(S)[0]).max()


def test_support_is_the_conic_twins(specimen, rng):
    d = rng.normal(size=(4, specimen.dim))
    twin = np.einsum("ij,ij->i", d, ConvexSet._support_points(specimen, d))
    scale = scale_of(specimen, d)
    assert specimen.support(d) == pytest.approx(twin, abs=1e-6 * scale)
    x = specimen.support_point(d)
    assert np.einsum("ij,ij->i", d, x) == pytest.approx(specimen.support(d), abs=1e-9 * scale)


def test_projection_is_the_conic_twins(specimen, rng):
    p = points_around(specimen, rng, 6)
    metric = read_metric(None, specimen.dim)
    projection = specimen.project(p)
    twin = ConvexSet._distances(specimen, p, metric)
    scale = scale_of(specimen, p)
    assert projection.distance == pytest.approx(twin, abs=2e-6 * scale)
    slow = ConvexSet._project(specimen, p, metric)
    gap = np.linalg.norm(projection.point - slow.point, axis=1)
    assert np.all(gap <= projection.error_bound + slow.error_bound)
    assert np.all(slow.error_bound <= 1e-3 * scale)


def test_residual_lies_in_the_normal_cone(specimen, rng):
    p = points_around(specimen, rng)
    projection = specimen.project(p)
    e = p - projection.point
    excess = specimen.support(e) - np.einsum("ij,ij->i", e, projection.point)
    scale = scale_of(specimen, p)
    bound = np.maximum(projection.error_bound, 1e-15 * scale)
    assert np.all(excess <= 4 * scale * bound)
    assert np.all(excess >= -4 * scale * bound)


def test_error_bounds_are_small_and_never_negative(specimen, rng):
    p = points_around(specimen, rng)
    projection = specimen.project(p)
    assert np.all(projection.error_bound >= 0.0)
    limit = 1e-11 if is_exact(specimen) else 1e-3
    assert np.all(projection.error_bound <= limit * scale_of(specimen, p))
    assert not np.any(projection.status == Status.FAILED)


def test_projection_is_idempotent(specimen, rng):
    first = specimen.project(points_around(specimen, rng, 6))
    again = specimen.project(first.point)
    tolerance = first.error_bound + again.error_bound + 1e-15 * scale_of(specimen, first.point)
    assert np.all(np.linalg.norm(again.point - first.point, axis=1) <= tolerance)


def test_projection_is_non_expansive(specimen, rng):
    p = points_around(specimen, rng, 8)
    projection = specimen.project(p)
    x, slack = projection.point, projection.error_bound
    for i in range(4):
        apart = np.linalg.norm(x[i] - x[i + 4])
        allowed = np.linalg.norm(p[i] - p[i + 4]) + slack[i] + slack[i + 4]
        assert apart <= allowed * (1 + 1e-9) + 1e-12


def test_inside_points_stay(specimen, rng):
    d = rng.normal(size=(5, specimen.dim))
    weights = rng.dirichlet(np.ones(5))
    inner = weights @ specimen.support_point(d)
    scale = scale_of(specimen, inner)
    tol = (1e-13 if is_exact(specimen) else 1e-6) * scale
    assert specimen.contains(inner, tol=tol)
    projection = specimen.project(inner)
    assert projection.distance <= projection.error_bound + tol
    far = inner + 10 * scale * d[0] / np.linalg.norm(d[0])
    assert not specimen.contains(far)
    assert specimen.distance(far) > scale


def test_distance_and_projection_agree(specimen, rng):
    p = points_around(specimen, rng, 6)
    scale = scale_of(specimen, p)
    tol = (1e-15 if is_exact(specimen) else 2e-6) * scale
    assert specimen.distance(p) == pytest.approx(specimen.project(p).distance, rel=1e-15, abs=tol)


def test_metrics_are_changes_of_coordinates(specimen, rng):
    """Projecting in W is projecting C S in the Euclidean metric."""
    L = np.eye(specimen.dim) + 0.4 * rng.normal(size=(specimen.dim, specimen.dim))
    W = L.T @ L
    C = np.linalg.cholesky(W).T
    p = points_around(specimen, rng, 4)
    projection = specimen.project(p, metric=W)
    image = LinearImage(C, specimen).project(p @ C.T)
    scale = scale_of(specimen, p) * np.linalg.norm(C, 2)
    tol = (1e-13 if is_exact(specimen) else 1e-6) * scale
    assert projection.distance == pytest.approx(image.distance, abs=tol)
    gap = np.linalg.norm(projection.point @ C.T - image.point, axis=1)
    assert np.all(gap <= projection.error_bound + image.error_bound + 1e-15 * scale)
    e = p - projection.point
    expected = np.sqrt(np.einsum("ij,jk,ik->i", e, W, e))
    outside = ~projection.inside
    assert projection.distance[outside] == pytest.approx(expected[outside])
    diagonal = specimen.project(p, metric=np.arange(1.0, specimen.dim + 1))
    matrix = specimen.project(p, metric=np.diag(np.arange(1.0, specimen.dim + 1)))
    assert diagonal.point == pytest.approx(matrix.point, abs=1e-9 * scale)


def test_normals_are_unit_and_outer(specimen, rng):
    p = points_around(specimen, rng)
    projection = specimen.project(p, metric=np.arange(1.0, specimen.dim + 1))
    outside = ~projection.inside & (projection.distance > 1e-6)
    lengths = np.linalg.norm(projection.normal, axis=1)
    assert lengths[outside] == pytest.approx(np.ones(outside.sum()))
    assert np.all(lengths[projection.inside] == 0.0)


def test_face_holds_the_points_farthest_along_its_normal(specimen, rng):
    scale = scale_of(specimen, np.zeros(specimen.dim))
    for d in np.vstack([rng.normal(size=(2, specimen.dim)), np.eye(specimen.dim)]):
        face = specimen.face(d)
        assert face.dim == specimen.dim
        ends = face.support_point(rng.normal(size=(3, specimen.dim)))
        tol = (1e-9 if is_exact(specimen) else 1e-5) * scale * max(np.linalg.norm(d), 1.0)
        assert ends @ d == pytest.approx(np.full(3, specimen.support(d)), abs=tol)
    whole = specimen.face(np.zeros(specimen.dim))
    d = rng.normal(size=(3, specimen.dim))
    assert whole.support(d) == pytest.approx(specimen.support(d), abs=1e-6 * scale)


def test_cvxpy_constraints(specimen, rng):
    d = rng.normal(size=specimen.dim)
    F = cp.Variable(specimen.dim)
    problem = cp.Problem(cp.Maximize(d @ F), specimen.constraints(F))
    problem.solve(solver=cp.CLARABEL)
    scale = scale_of(specimen, d)
    assert problem.value == pytest.approx(float(specimen.support(d)), abs=1e-5 * scale)


def test_queries_broadcast(specimen, rng):
    p = rng.normal(size=(2, 3, specimen.dim))
    assert specimen.support(p).shape == (2, 3)
    assert specimen.support_point(p).shape == p.shape
    projection = specimen.project(p)
    assert projection.point.shape == projection.normal.shape == p.shape
    for field in (projection.distance, projection.error_bound, projection.status):
        assert field.shape == (2, 3)
    assert specimen.contains(p[0, 0]).shape == ()
    assert specimen.project(np.empty((0, specimen.dim))).point.shape == (0, specimen.dim)


def test_bad_arguments(specimen):
    n = specimen.dim
    good = np.zeros(n)
    bad = [
        lambda: specimen.project(np.zeros(n + 1)),
        lambda: specimen.project(np.full(n, np.nan)),
        lambda: specimen.support(np.full(n, np.inf)),
        lambda: specimen.support("north"),
        lambda: specimen.project(good, metric=np.eye(n + 1)),
        lambda: specimen.project(good, metric=-np.eye(n)),
        lambda: specimen.project(good, metric=np.full(n, np.nan)),
        lambda: specimen.contains(good, tol=-1.0),
        lambda: specimen.constraints(cp.Variable(n + 1)),
        lambda: specimen.face(np.zeros(n + 1)),
    ]
    if n > 1:
        bad.append(lambda: specimen.project(good, metric=np.triu(np.ones((n, n)))))
    for call in bad:
        with pytest.raises(InputError) as caught:
            call()
        assert isinstance(caught.value, LimitSurfError)
        assert isinstance(caught.value, ValueError)
        assert caught.value.argument


def test_repr_is_readable(specimen):
    assert type(specimen).__name__ in repr(specimen)
    assert "\n" not in repr(specimen)
    assert len(repr(specimen)) < 300


def test_a_solver_that_stops_early_raises_or_hands_over_its_best(monkeypatch):
    """Clarabel with one iteration: the error carries the points that throw=False returns."""
    import clarabel

    from limitsurf.conic import solve

    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_iter = False, 1
    monkeypatch.setattr(solve, "_settings", lambda: settings)
    total = SPECIMENS["disk and box"]
    p = np.array([[9.0, 8.0, 7.0], [5.0, 5.0, 5.0]])
    with pytest.raises(SolveFailed, match="2 of 2 points not solved") as caught:
        total.project(p)
    given = total.project(p, throw=False)
    assert np.array_equal(given.point, caught.value.best.point)
    assert np.all(given.status == Status.FAILED)
    assert given.point.shape == p.shape
