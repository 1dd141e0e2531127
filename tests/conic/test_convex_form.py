import cvxpy as cp
import numpy as np
import pytest
from naive_fits import convexity

from limitsurf.conic.convex_form import (
    form_exponents,
    hessian_squares,
    minimize_over_convex_forms,
)
from limitsurf.conic.form import unpacking
from limitsurf.conic.moments import convexity_margin


@pytest.mark.parametrize("degree", [2, 4])
def test_every_gram_matrix_gives_the_hessian_form(degree, rng):
    S, N = hessian_squares(3, degree)
    E = form_exponents(3, degree)
    c, u = rng.normal(size=len(E)), rng.normal(size=N.shape[1])
    order = 3 if degree == 2 else 9
    Q = (unpacking(order) @ (S @ c + N @ u)).reshape(order, order)
    for y, x in rng.normal(size=(5, 2, 3)):
        z = y if degree == 2 else np.outer(y, x).ravel()
        h = 1e-3
        values = [np.prod((x + t * h * y) ** E, axis=1) @ c for t in (-1, 0, 1)]
        second = (values[0] - 2 * values[1] + values[2]) / h**2  # the remainder is O(h^2)
        assert z @ Q @ z == pytest.approx(second, rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("degree", [2, 4])
@pytest.mark.parametrize("free", [0, 3])
def test_minimum_is_that_of_the_plain_statement(degree, free, rng):
    m = len(form_exponents(3, degree))
    J = rng.normal(size=(40, m + free))
    r = rng.normal(size=40)
    found = minimize_over_convex_forms(J.T @ J, J.T @ r, degree)
    x = cp.Variable(m + free)
    program = cp.Problem(cp.Minimize(0.5 * cp.sum_squares(J @ x + r)), convexity(x[:m], degree))
    program.solve(solver=cp.CLARABEL)
    value = 0.5 * np.sum((J @ found + r) ** 2)
    assert value == pytest.approx(program.value, rel=1e-7)
    np.testing.assert_allclose(found, x.value, atol=1e-4)


def test_the_answer_is_convex_where_the_best_form_is_not(rng):
    E = form_exponents(3, 4)
    target = np.where((E == 2).sum(axis=1) == 2, -1.0, 0.2)  # x^2 y^2 terms far below zero
    found = minimize_over_convex_forms(np.eye(15), -target, 4)
    assert convexity_margin(E, target) < -0.1
    assert np.abs(found - target).max() > 0.1
    assert convexity_margin(E, found) > 0.0


def test_a_convex_form_is_left_alone():
    target = np.array([1.0, 0.2, 0.0, 2.0, 0.1, 3.0])  # positive definite
    np.testing.assert_allclose(
        minimize_over_convex_forms(np.eye(6), -target, 2), target, atol=1e-12
    )
