"""Symmetric matrices of three as six numbers."""

import numpy as np
import pytest

from limitsurf.kernels.symmetric3 import (
    factored,
    form,
    plus,
    plus_outer,
    solve,
    solved,
    times,
)


def six(M):
    return tuple(float(M[i, j]) for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)))


def full(S):
    return np.array([[S[0], S[1], S[3]], [S[1], S[2], S[4]], [S[3], S[4], S[5]]])


def three(a):
    return tuple(float(x) for x in a)


def matrix(rng, condition=1.0):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return turn * np.array([1.0, condition**-0.5, 1.0 / condition]) @ turn.T


def test_products_are_those_of_matrices(rng):
    for _ in range(50):
        M, R = matrix(rng, 10.0), matrix(rng, 3.0)
        v, a, t = rng.normal(size=3), rng.normal(size=3), rng.normal()
        assert times(six(M), three(v)) == pytest.approx(M @ v)
        assert form(six(M), three(v)) == pytest.approx(v @ M @ v)
        assert full(plus(six(M), t, six(R))) == pytest.approx(M + t * R)
        assert full(plus_outer(six(M), t, three(a))) == pytest.approx(M + t * np.outer(a, a))


@pytest.mark.parametrize("condition", [1.0, 1e3, 1e8, 1e13])
def test_solutions_leave_no_residual(rng, condition):
    for _ in range(50):
        M = full(six(matrix(rng, condition)))
        b = rng.normal(size=3)
        ok, x = solved(six(M), three(b))
        assert ok
        left = np.linalg.norm(M @ x - b)
        assert left <= 1e-15 * (np.linalg.norm(M) * np.linalg.norm(x) + np.linalg.norm(b))
        ok, L = factored(six(M))
        assert solve(six(M), L, three(b)) == pytest.approx(x, rel=1e-12 * condition)


def test_scales_far_apart(rng):
    scale = np.array([1e-9, 1.0, 1e9])
    for _ in range(20):
        M = full(six(matrix(rng, 10.0))) * np.outer(scale, scale)
        x = rng.normal(size=3) / scale
        ok, found = solved(six(M), three(M @ x))
        assert ok
        assert np.array(found) * scale == pytest.approx(x * scale, abs=1e-13)


@pytest.mark.parametrize(
    "M",
    [
        np.zeros((3, 3)),
        np.diag([1.0, 1.0, 0.0]),
        np.diag([1.0, -1.0, 1.0]),
        np.diag([-1.0, 1.0, 1.0]),
        np.ones((3, 3)),
        np.diag([1.0, np.nan, 1.0]),
        [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.9], [0.0, 1.0, 0.9], [0.9, 0.9, 1.0]],
    ],
)
def test_what_is_not_positive_definite_is_said_so(M):
    S = six(np.array(M))
    assert not factored(S)[0]
    ok, x = solved(S, (1.0, 2.0, 3.0))
    assert not ok
    assert x == (1.0, 2.0, 3.0)
