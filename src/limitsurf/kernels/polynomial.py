r"""Closest point of a convex polynomial sublevel set :math:`\{x : q(x) \le 1\}`.

For a multiplier :math:`\lambda > 0` let :math:`x(\lambda)` minimise
:math:`\tfrac12 |x - p|^2 + \lambda q(x)`, strongly convex; :math:`q(x(\lambda))` falls with
:math:`\lambda`. Newton's method finds :math:`(x, \lambda)` with :math:`q(x) = 1`; inner Newton
steps are damped, and :math:`\lambda` is kept inside a bracket.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["closest_on_polynomial", "polynomial_values"]

_EPS = float(np.finfo(np.float64).eps)


@compiled
def _evaluate(exponents: Ints, c: Floats, x: Floats, grad: Floats, hess: Floats) -> float:
    """Return q(x); fill gradient and Hessian."""
    n = x.shape[0]
    grad[:] = 0.0
    hess[:] = 0.0
    total = 0.0
    for k in range(c.shape[0]):
        total += c[k] * _term(exponents[k], x, -1, -1)
        for i in range(n):
            grad[i] += c[k] * _term(exponents[k], x, i, -1)
            for j in range(n):
                hess[i, j] += c[k] * _term(exponents[k], x, i, j)
    return total


@compiled
def _term(e: Ints, x: Floats, i: int, j: int) -> float:
    """Return a monomial, differentiated by x_i and x_j (-1: not)."""
    value = 1.0
    for k in range(x.shape[0]):
        power = e[k]
        for derivative in (i, j):
            if derivative == k:
                value *= power
                power -= 1
        if value == 0.0:
            return 0.0
        value *= x[k] ** power
    return value


@compiled
def polynomial_values(exponents: Ints, c: Floats, points: Floats) -> Floats:
    """Return q at points (k, n)."""
    values = np.zeros(points.shape[0])
    for k in range(points.shape[0]):
        for m in range(c.shape[0]):
            values[k] += c[m] * _term(exponents[m], points[k], -1, -1)
    return values


@compiled
def _to_boundary(exponents: Ints, c: Floats, x: Floats) -> None:
    """Scale x != 0 so that q(x) = 1: q(s x) = a s^2 + b s^4, even quartics only."""
    a = 0.0
    b = 0.0
    for k in range(c.shape[0]):
        term = c[k] * _term(exponents[k], x, -1, -1)
        if exponents[k].sum() == 2:
            a += term
        else:
            b += term
    # s^2 = (-a + sqrt(a^2 + 4 b)) / (2 b), without cancellation
    x *= math.sqrt(2.0 / (a + math.sqrt(a * a + 4.0 * b)))


@compiled
def closest_on_polynomial(
    points: Floats, exponents: Ints, c: Floats, closest: Floats, bound: Floats, count: Ints
) -> None:
    """Fill the closest points, error bounds and iterations (0 inside, -1 not converged).

    Parameters
    ----------
    points : (k, n) float
        Points p.
    exponents, c : (m, n) int, (m,) float
        An even, convex q of degrees two and four.
    closest, bound, count
        Receive the result. The last step puts x on the boundary exactly, where the gradient is an
        outer normal; so the distance of ``p - x`` from the ray of the gradient bounds the error.
    """
    n = points.shape[1]
    grad, hess = np.empty(n), np.empty((n, n))
    for k in range(points.shape[0]):
        p = points[k]
        x = p.copy()
        count[k] = 0
        bound[k] = 0.0
        if _evaluate(exponents, c, p, grad, hess) > 1.0:
            _to_boundary(exponents, c, x)
            count[k] = _newton(exponents, c, p, x, grad, hess)
            _to_boundary(exponents, c, x)
            _evaluate(exponents, c, x, grad, hess)
            e = p - x
            shift = max(np.sum(e * grad) / np.sum(grad * grad), 0.0)
            size = np.abs(p).max() + np.abs(x).max()
            bound[k] = math.sqrt(np.sum((e - shift * grad) ** 2)) + 8 * _EPS * size
            if bound[k] > 1e-9 * size:
                count[k] = -1
        closest[k] = x


@compiled
def _newton(exponents: Ints, c: Floats, p: Floats, x: Floats, grad: Floats, hess: Floats) -> int:
    """Newton's method on ``x - p + lambda grad q = 0, q = 1``, x kept on the boundary.

    Each step solves the linearised conditions, takes the new multiplier, and pulls x back to the
    boundary along its ray; steps are halved until the distance falls.
    """
    n = p.shape[0]
    matrix = np.empty((n + 1, n + 1))
    right = np.empty(n + 1)
    _evaluate(exponents, c, x, grad, hess)
    shift = max(np.sum((p - x) * grad) / np.sum(grad * grad), 0.0)
    distance = np.sum((p - x) ** 2)
    for iteration in range(1, 60):
        matrix[:n, :n] = np.eye(n) + shift * hess
        matrix[:n, n] = grad
        matrix[n, :n] = grad
        matrix[n, n] = 0.0
        right[:n] = p - x - shift * grad
        right[n] = 0.0
        step = np.linalg.solve(matrix, right)
        length = 1.0
        trial = x.copy()
        while length > 1e-8:
            trial = x + length * step[:n]
            _to_boundary(exponents, c, trial)
            if np.sum((p - trial) ** 2) <= distance * (1.0 + 8 * _EPS):
                break
            length *= 0.5
        moved = math.sqrt(np.sum((trial - x) ** 2))
        if length <= 1e-8:
            return iteration
        x[:] = trial
        distance = np.sum((p - x) ** 2)
        _evaluate(exponents, c, x, grad, hess)
        shift = max(np.sum((p - x) * grad) / np.sum(grad * grad), 0.0)
        if moved <= 4 * _EPS * math.sqrt(np.sum(x * x)):
            return iteration
    return 60
