"""Ellipsoids: every rank and conditioning, against 50-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limitsurf.errors import InputError, SolveFailed
from limitsurf.sets.ellipsoid import Ellipsoid, _decompose
from limitsurf.sets.projection import Status


def exact_projection(center, axes, p, weights):
    """Return the closest point in the norm ``sum weights e^2``, in 50 digits."""
    n, k = axes.shape
    w = [mp.sqrt(mp.mpf(float(v))) for v in weights]
    if not axes.any():
        return [mp.mpf(float(v)) for v in center], w
    square = mp.matrix(n, max(n, k))  # zero columns are no axes
    for i, j in np.ndindex(n, k):
        square[i, j] = w[i] * mp.mpf(float(axes[i, j]))
    U, s, _ = mp.svd_r(square, full_matrices=False)
    kept = [j for j in range(len(s)) if s[j] > s[0] * mp.mpf(10) ** -35]
    s = [s[j] for j in kept]
    d = [w[i] * (mp.mpf(float(p[i])) - mp.mpf(float(center[i]))) for i in range(n)]
    b = [mp.fsum(U[i, j] * d[i] for i in range(n)) for j in kept]
    t = secular_root(s, b)
    y = [s[j] ** 2 * b[j] / (s[j] ** 2 + t) for j in range(len(s))]
    return [
        mp.mpf(float(center[i])) + mp.fsum(U[i, j] * v for j, v in zip(kept, y, strict=True)) / w[i]
        for i in range(n)
    ], w


def secular_root(s, b):
    def norm2(t):
        return mp.fsum((s[j] * b[j] / (s[j] ** 2 + t)) ** 2 for j in range(len(s)))

    if norm2(mp.mpf(0)) <= 1:
        return mp.mpf(0)
    high = mp.sqrt(mp.fsum((s[j] * b[j]) ** 2 for j in range(len(s))))
    low = high * mp.mpf(10) ** -80
    for _ in range(240):
        middle = mp.sqrt(low * high)
        low, high = (middle, high) if norm2(middle) > 1 else (low, middle)
    return high


def exact_error(E, p, weights):
    """Return the error of a projection, its bound, and the size of the problem."""
    identity = np.array_equal(weights, np.ones(E.dim))
    projection = E.project(p, metric=None if identity else weights)
    with mp.workdps(50):
        x, w = exact_projection(E.center, E.axes, p, weights)
        e = [a * (mp.mpf(float(v)) - b) for a, v, b in zip(w, projection.point, x, strict=True)]
        error = float(mp.sqrt(mp.fsum(v * v for v in e)))
    root = np.sqrt(weights)
    lengths = [root * p, root * E.center, *(root[:, None] * E.axes).T]
    return error, float(projection.error_bound), max(np.abs(v).max() for v in lengths)


CASES = {
    "round": [1.0, 0.6, 0.3],
    "1e3": [1.0, 0.03, 1e-3],
    "1e6": [1.0, 1e-3, 1e-6],
    "1e12": [1.0, 1e-6, 1e-12],
    "rank 2": [1.0, 0.4],
    "rank 1": [1.0],
    "rank 0": [],
}


@pytest.mark.parametrize("where", ["outside", "inside", "boundary", "far"])
@pytest.mark.parametrize("name", CASES)
def test_against_50_digits(name, where, rng):
    """Errors relative to max(|p|, |c|, |A|) stay below 1e-14."""
    s = np.array(CASES[name])
    for _ in range(6):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0][:, : len(s)] * s
        E = Ellipsoid(rng.normal(size=3), axes)
        u = rng.normal(size=len(s))
        u *= 1.0 / max(np.linalg.norm(u), 1e-300)
        p = {
            "outside": E.center + 2 * rng.normal(size=3),
            "inside": E.center + 0.6 * axes @ u,
            "boundary": E.center + axes @ u,
            "far": E.center + 1e6 * rng.normal(size=3),
        }[where]
        error, bound, size = exact_error(E, p, np.ones(3))
        assert error <= 1e-15 * size
        assert error <= bound <= 1e-14 * size


@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([(3, 1), (3, 2), (3, 3), (3, 5), (2, 2), (2, 3), (5, 3)]),
    st.sampled_from(["columns", "rows", "condition", "rank 1", "round"]),
    st.sampled_from([1.0, 1e-140, 1e140]),
    st.booleans(),
)
def test_bounds_are_never_below_the_true_error(seed, shape, kind, scale, weighted):
    """Axes of any shape, rank and grading, points anywhere, scales far apart."""
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=shape)
    if kind == "columns":
        axes *= 10.0 ** rng.uniform(-12, 0, size=shape[1])
    elif kind == "rows":
        axes *= 10.0 ** rng.uniform(-12, 0, size=(shape[0], 1))
    elif kind == "condition":
        U, s, V = np.linalg.svd(axes, full_matrices=False)
        axes = (U * 10.0 ** rng.uniform(-12, 0, size=len(s))) @ V
    elif kind == "rank 1":
        axes = np.outer(axes[:, 0], axes[0])
    center = rng.normal(size=shape[0]) * rng.integers(0, 2)
    u = rng.normal(size=shape[1])
    tip = axes @ (u / np.linalg.norm(u))
    away = rng.normal(size=shape[0])
    p = center + [0.6 * tip, tip, 2 * away, 1e6 * away][rng.integers(4)]
    weights = 10.0 ** rng.uniform(-4, 4, size=shape[0]) if weighted else np.ones(shape[0])
    error, bound, size = exact_error(Ellipsoid(scale * center, scale * axes), scale * p, weights)
    assert error <= 1e-14 * size
    assert error <= bound


def test_small_semi_axes_are_known_to_full_relative_precision(rng):
    """Rows and columns of different sizes, as forces and moments in SI units are."""
    for _ in range(20):
        axes = rng.normal(size=(3, 3)) * 10.0 ** rng.uniform(-6, 0, size=(3, 1))
        axes *= 10.0 ** rng.uniform(-3, 0, size=3)
        with mp.workdps(50):
            exact = [float(v) for v in mp.svd_r(mp.matrix(axes.tolist()), compute_uv=False)]
        assert _decompose(axes)[1] == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("shape", [(3, 1), (3, 2), (3, 3), (3, 5), (1, 1), (1, 4), (5, 2)])
def test_semi_axes_of_any_shape(shape, rng):
    axes = rng.normal(size=shape)
    U, s = _decompose(axes)
    assert s == pytest.approx(np.linalg.svd(axes, compute_uv=False), rel=1e-13)
    products = U.T @ U
    assert products == pytest.approx(np.eye(len(s)), abs=4e-15)
    assert (U * s**2) @ U.T == pytest.approx(axes @ axes.T, abs=1e-13)


def test_the_inside_of_a_solid_is_inside():
    E = Ellipsoid([1.0, 0.0, 0.0], np.eye(3))
    projection = E.project([[1.2, 0.1, 0.0], [3.0, 0.0, 0.0]])
    assert list(projection.inside) == [True, False]
    assert np.array_equal(projection.point[0], [1.2, 0.1, 0.0])
    assert projection.distance == pytest.approx([0.0, 1.0])
    assert projection.normal[1] == pytest.approx([1.0, 0.0, 0.0])


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.integers(0, 6))
def test_random_ellipsoids_satisfy_the_optimality_conditions(seed, n, k):
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(n, k)) * 10.0 ** rng.uniform(-6, 2, size=k)
    E = Ellipsoid(rng.normal(size=n), axes)
    p = rng.normal(size=(5, n)) * 10.0 ** rng.uniform(-2, 3)
    projection = E.project(p)
    e = p - projection.point
    scale = np.abs(p).max() + np.abs(axes).max(initial=0.0) + np.abs(E.center).max()
    gap = E.support(e) - np.einsum("ij,ij->i", e, projection.point)
    assert np.all(np.abs(gap) <= 1e-12 * scale * (scale + np.linalg.norm(e, axis=1)))


def test_rank_and_repr():
    assert Ellipsoid([0, 0, 0], np.empty((3, 0))).rank == 0
    assert Ellipsoid([0, 0], [[1, 2], [2, 4]]).rank == 1
    assert Ellipsoid([0, 0, 0], np.zeros((3, 2))).rank == 0
    assert Ellipsoid([0, 0], [[1, 2, 3], [2, 4, 6]]).rank == 1
    assert Ellipsoid([0, 0], [[1e-150, 0], [0, 1e-140]]).rank == 2
    assert "semi-axes [2., 1.]" in repr(Ellipsoid([0, 0], [[1, 0], [0, 2]]))


def test_arrays_cannot_be_changed():
    E = Ellipsoid([0.0, 0.0], np.eye(2))
    with pytest.raises(ValueError, match="read-only"):
        E.axes[0, 0] = 5.0
    source = np.eye(2)
    E = Ellipsoid([0.0, 0.0], source)
    source[0, 0] = 7.0
    assert E.axes[0, 0] == 1.0


@pytest.mark.parametrize(
    ("center", "axes", "name"),
    [
        ([[0, 0]], np.eye(2), "center"),
        ([0, np.nan], np.eye(2), "center"),
        ([0, 0], np.eye(3), "axes"),
        ([0, 0], [[np.inf, 0], [0, 1]], "axes"),
        ([0, 0], "round", "axes"),
    ],
)
def test_bad_arguments(center, axes, name):
    with pytest.raises(InputError) as caught:
        Ellipsoid(center, axes)
    assert caught.value.argument == name


def test_failures_are_raised_or_returned(monkeypatch):
    """A kernel that does not converge must not pass for one that does."""

    def stop_early(points, center, U, s, closest, bound, count):
        closest[:], bound[:], count[:] = 0.0, 1.0, -1

    monkeypatch.setattr("limitsurf.sets.ellipsoid.closest_on_ellipsoid", stop_early)
    E = Ellipsoid([0.0, 0.0], np.eye(2))
    with pytest.raises(SolveFailed, match="2 of 2 points not solved") as caught:
        E.project([[3.0, 0.0], [0.0, 4.0]])
    assert caught.value.best.point.shape == (2, 2)
    with pytest.raises(SolveFailed, match="distance"):
        E.distance([3.0, 0.0])
    returned = E.project([3.0, 0.0], throw=False)
    assert returned.status == Status.FAILED
    assert "scale the set" in str(Status(int(returned.status)))


def test_singular_values_that_are_not_found_raise(monkeypatch):
    def stop_early(axes, **options):
        return np.ones(2), np.eye(2), np.eye(2), np.ones(7), np.ones(3), 1

    monkeypatch.setattr("limitsurf.sets.ellipsoid.dgejsv", stop_early)
    with pytest.raises(SolveFailed, match="singular values"):
        Ellipsoid([0.0, 0.0], np.eye(2)).project([3.0, 0.0])
