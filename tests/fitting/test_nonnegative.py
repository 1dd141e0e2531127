"""Non-negative weights: against cvxpy, scipy's full program, and the conditions of optimality."""

import cvxpy as cp
import numpy as np
import pytest
from bench_contact_fit import stated_in_cvxpy
from scipy.optimize import nnls

from limitsurf.errors import SolveFailed
from limitsurf.fitting import nonnegative
from limitsurf.fitting.nonnegative import Penalty, Residuals, least_squares, nonnegative_weights


def problem(n, N, delta, seed=0, ridge=0.05):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, 3, N))
    m = np.maximum(rng.normal(size=N), 0.0)
    y = X @ m + 0.1 * rng.normal(size=(n, 3)) * rng.standard_t(2, size=(n, 1))
    penalty = Penalty(np.full(N, ridge), np.empty((0, N)))
    return Residuals(X, y, rng.uniform(0.5, 2.0, n) / n, delta), penalty


@pytest.mark.parametrize("shape", [(5, 40), (30, 40), (100, 10)])
@pytest.mark.parametrize("delta", [0.05, 0.3, np.inf])
def test_weights_are_those_of_the_program_in_cvxpy(shape, delta):
    residuals, penalty = problem(*shape, delta)
    ours = nonnegative_weights(residuals, penalty)
    large = Residuals(residuals.X, residuals.y, residuals.weight, min(delta, 1e3))
    theirs, value = stated_in_cvxpy(large, penalty)
    assert residuals.loss(ours) + penalty.loss(ours) == pytest.approx(value, rel=1e-6)
    assert ours == pytest.approx(theirs, abs=2e-3)


def test_rows_that_should_vanish_do():
    residuals, penalty = problem(30, 20, 0.3)
    C = 1e3 * np.random.default_rng(1).normal(size=(2, 20))
    m = nonnegative_weights(residuals, Penalty(penalty.s, C))
    free = cp.Variable(20, nonneg=True)
    terms = [
        cp.huber(cp.norm(X @ free - y), 0.3) for X, y in zip(residuals.X, residuals.y, strict=True)
    ]
    loss = residuals.weight @ cp.hstack(terms) + cp.sum_squares(cp.multiply(penalty.s, free))
    value = cp.Problem(cp.Minimize(loss), [C @ free == 0]).solve("CLARABEL")
    assert np.abs(C @ m).max() < 1e-2
    assert residuals.loss(m) + float(np.sum((penalty.s * m) ** 2)) == pytest.approx(value, rel=1e-4)


@pytest.mark.parametrize("d", [30, 500])
def test_columns_tried_in_turn_end_where_all_at_once_do(d):
    rng = np.random.default_rng(d)
    X, y = rng.normal(size=(d, 200)), rng.normal(size=d)
    ridge = rng.uniform(0.01, 0.1, 200)
    m = least_squares(X, y, ridge, np.zeros(200))
    full, _ = nnls(np.vstack([X, np.diag(ridge)]), np.concatenate([y, np.zeros(200)]))
    assert m == pytest.approx(full, abs=1e-9)
    slope = X.T @ (X @ m - y) + ridge**2 * m
    assert slope.min() > -1e-8
    assert np.abs(slope[m > 0.0]).max() < 1e-8


def test_equal_columns_are_no_trouble():
    rng = np.random.default_rng(0)
    column, y = rng.uniform(1.0, 2.0, (50, 1)), rng.uniform(1.0, 2.0, 50)
    X = np.hstack([column, column, -column])
    m = least_squares(X, y, np.zeros(3), np.ones(3))
    assert m[0] + m[1] - m[2] == pytest.approx(float(column[:, 0] @ y / (column**2).sum()))


def test_a_program_that_does_not_settle_says_so(monkeypatch):
    monkeypatch.setattr(nonnegative, "_ENTRIES", 1)
    X, y = np.eye(40), np.ones(40)
    with pytest.raises(SolveFailed, match="did not settle"):
        least_squares(X, y, np.zeros(40), np.zeros(40))
