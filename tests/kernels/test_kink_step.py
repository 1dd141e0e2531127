"""Newton's step past a kink: its optimality conditions, in the worst of conditions."""

import numpy as np
import pytest

from limitsurf.kernels.contact_pass import Kink
from limitsurf.kernels.kink_step import (
    kink_columns,
    kink_force_in_plane,
    kink_step,
    snapped,
    step_of_solved,
)
from tests.kernels.test_symmetric3 import full, matrix, six, three

DISK = (1.0, 0.0, 1.0)
STRETCHES = {"disk": DISK, "ellipse": (0.7, 0.3, 0.4), "thin": (1.0, 1e-3, 2e-6)}


def pair(a):
    return float(a[0]), float(a[1])


def columns(kink):
    return np.array(kink_columns(kink)).T


def optimal(B, b, kink, u, step, f, still, tol):
    """Assert that 0 is in the subdifferential at the step; all relative."""
    P, d, f = columns(kink), np.array(step), np.array(f)
    left = B @ d + b + kink.mass * P @ f
    size = np.linalg.norm(B) * np.linalg.norm(d) + np.linalg.norm(b) + kink.mass
    assert np.linalg.norm(left) <= tol * size
    p = np.array(u) + P.T @ d
    reach = np.linalg.norm(u) + np.linalg.norm(P) * np.linalg.norm(d)
    if still:
        assert np.linalg.norm(p) <= 10 * tol * reach
        assert np.linalg.norm(f) <= 1 + 1e-14
    else:
        assert np.linalg.norm(f) == pytest.approx(1.0, abs=1e-14)
        assert np.linalg.norm(p - (f @ p) * f) <= 10 * tol * reach
        assert f @ p >= -10 * tol * reach


@pytest.mark.parametrize("stretch", STRETCHES)
@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0, 1e3])
def test_optimality(rng, stretch, size):
    seen = set()
    for _ in range(300):
        B = full(six(matrix(rng, 10.0 ** rng.uniform(0, 3))))
        kink = Kink(3, rng.uniform(0.1, 2.0), *rng.normal(size=2), STRETCHES[stretch])
        b, u = rng.normal(size=3), size * rng.normal(size=2)
        ok, step, f, still = kink_step(six(B), three(b), kink, pair(u))
        assert ok
        optimal(B, b, kink, u, step, f, still, 1e-11 if stretch == "thin" else 1e-12)
        seen.add(still)
    assert seen == {True, False} or size > 1 or stretch == "thin"


@pytest.mark.parametrize("power", [4, 8, 12])
def test_models_that_are_nearly_singular(rng, power):
    """Two contacts: all the curvature across the rotation is in one direction."""
    for _ in range(200):
        a = rng.normal(size=3)
        B = full(six(np.outer(a, a) + 10.0**-power * np.eye(3)))
        B += np.outer(*[rng.normal(size=3)] * 2)
        kink = Kink(0, 1.0, *rng.normal(size=2), DISK)
        x = rng.normal(size=3)
        b, u = B @ x, 10.0 ** rng.uniform(-6, 0) * rng.normal(size=2)
        ok, step, f, still = kink_step(six(B), three(b), kink, pair(u))
        assert ok
        optimal(B, b, kink, u, step, f, still, 1e-12)


def test_no_kink_is_newtons_step(rng):
    B, b = full(six(matrix(rng, 10.0))), rng.normal(size=3)
    none = Kink(-1, 0.0, 0.0, 0.0, DISK)
    ok, step, f, still = kink_step(six(B), three(b), none, (0.0, 0.0))
    assert ok
    assert not still
    assert f == (0.0, 0.0)
    assert step == pytest.approx(-np.linalg.solve(B, b))


@pytest.mark.parametrize("stretch", ["disk", "ellipse"])
def test_models_that_are_not_convex_are_refused(stretch):
    kink = Kink(0, 1.0, 0.3, 0.2, STRETCHES[stretch])
    for B in (np.diag([1.0, 1.0, -1.0]), np.diag([-1.0, 1.0, 1.0]), np.diag([1.0, -1.0, 1.0])):
        assert not kink_step(six(B), (1.0, 0.0, 0.0), kink, (0.1, 0.0))[0]


def test_one_kink_alone_by_two_ways(rng):
    """The way by B^-1 P is that of ellipses; a disk is one of them."""
    for _ in range(100):
        B, b, u = full(six(matrix(rng, 5.0))), rng.normal(size=3), 0.3 * rng.normal(size=2)
        kink = Kink(0, rng.uniform(0.1, 1.0), *rng.normal(size=2), DISK)
        K = np.linalg.solve(B, columns(kink)).T
        z = np.linalg.solve(B, b)
        step, f, still = step_of_solved(three(z), three(K[0]), three(K[1]), kink, pair(u))
        ok, direct, g, at_rest = kink_step(six(B), three(b), kink, pair(u))
        assert ok
        assert still == at_rest
        assert step == pytest.approx(direct, abs=1e-12)
        assert f == pytest.approx(g, abs=1e-12)


def test_forces_in_the_plane(rng):
    for _ in range(200):
        A = rng.normal(size=(2, 2)) * 10.0 ** rng.uniform(-4, 4)
        K, q = A @ A.T, rng.normal(size=2)
        f, still = kink_force_in_plane(K[0, 0], K[0, 1], K[1, 1], pair(q))
        inner = np.linalg.norm(np.linalg.solve(K, q))
        if abs(inner - 1) > 1e-9:
            assert still == (inner < 1)
        if still:
            assert np.linalg.norm(K @ f - q) <= 1e-9 * (np.linalg.norm(K) + 1)
        else:
            sigma = f @ (q - K @ f)
            assert sigma >= -1e-12 * np.linalg.norm(q)
            assert np.linalg.norm(sigma * np.array(f) + K @ f - q) <= 1e-9 * np.linalg.norm(q)
    assert kink_force_in_plane(1.0, 0.0, 1.0, (0.0, 0.0)) == ((0.0, 0.0), True)
    assert kink_force_in_plane(0.0, 0.0, 0.0, (0.0, 0.0)) == ((0.0, 0.0), True)


def test_a_contact_that_pushes_along_a_line(rng):
    for angle in rng.uniform(0.0, 6.0, 50):
        a = np.array([np.cos(angle), np.sin(angle)])
        K = 0.3 * np.outer(a, a)
        for size, rests in ((0.2, True), (-0.29, True), (0.31, False), (-4.0, False)):
            f, still = kink_force_in_plane(K[0, 0], K[0, 1], K[1, 1], pair(size * a), True)
            assert still == rests
            assert f @ a == pytest.approx(np.clip(size / 0.3, -1, 1), abs=1e-14)
            assert np.linalg.norm(f) <= 1 + 1e-15


def test_snapped_twists_turn_about_the_contact(rng):
    for _ in range(50):
        x, y = 10.0 ** rng.uniform(-6, 3) * rng.normal(size=2)
        v = rng.normal(size=3)
        s = np.array(snapped(Kink(0, 1.0, x, y, DISK), three(v)))
        assert np.array_equal([s[0] - s[2] * y, s[1] + s[2] * x], [0.0, 0.0])
        n = np.array([y, -x, 1.0])
        assert s == pytest.approx(n * (n @ v) / (n @ n), rel=1e-12)
