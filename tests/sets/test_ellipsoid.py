"""Ellipsoids: every rank and conditioning, against 50-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limitsurf.errors import InputError, SolveFailed
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.projection import Status


def exact_projection(center, turn, semi_axes, p):
    """Return the closest point of ``{c + Q diag(s) u}`` in 50 digits; Q made orthogonal in them."""
    with mp.workdps(50):
        Q = mp.qr(mp.matrix(turn.tolist()))[0]
        signs = [
            1 if mp.fsum(Q[i, j] * turn[i, j] for i in range(len(turn))) > 0 else -1
            for j in range(len(semi_axes))
        ]
        d = [mp.mpf(float(x)) - mp.mpf(float(c)) for x, c in zip(p, center, strict=True)]
        s = [mp.mpf(float(x)) for x in semi_axes]
        b = [signs[j] * mp.fsum(Q[i, j] * d[i] for i in range(len(d))) for j in range(len(s))]

        def norm2(t):
            return mp.fsum((s[j] * b[j] / (s[j] ** 2 + t)) ** 2 for j in range(len(s)))

        t = mp.mpf(0)
        if s and norm2(t) > 1:
            low, high = (
                mp.mpf(10) ** -60,
                mp.sqrt(mp.fsum((s[j] * b[j]) ** 2 for j in range(len(s)))),
            )
            for _ in range(400):
                middle = mp.sqrt(low * high)
                low, high = (middle, high) if norm2(middle) > 1 else (low, middle)
            t = high
        x = [mp.mpf(float(c)) for c in center]
        for j in range(len(s)):
            y = s[j] ** 2 * b[j] / (s[j] ** 2 + t)
            x = [x[i] + signs[j] * Q[i, j] * y for i in range(len(x))]
        return np.array([float(v) for v in x])


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
    for _ in range(8):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0][:, : len(s)]
        center = rng.normal(size=3)
        E = Ellipsoid(center, turn * s)
        u = rng.normal(size=len(s))
        u *= 1.0 / max(np.linalg.norm(u), 1e-300)
        p = {
            "outside": center + 2 * rng.normal(size=3),
            "inside": center + 0.6 * (turn * s) @ u,
            "boundary": center + (turn * s) @ u,
            "far": center + 1e6 * rng.normal(size=3),
        }[where]
        expected = exact_projection(center, turn, s, p)
        projection = E.project(p)
        size = max(np.abs(p).max(), np.abs(center).max(), s.max(initial=0.0))
        error = np.linalg.norm(projection.point - expected)
        assert error <= 1e-14 * size * (3 if where == "far" else 1)
        assert error <= projection.error_bound or error <= 2e-16 * size


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
