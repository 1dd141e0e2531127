r"""Values of even convex quartics q, and the closest points of :math:`\{x : q(x) \le 1\}`.

In the metric :math:`W = C^T C` the closest point x of p satisfies

.. math:: W (p - x) = \lambda \nabla q(x), \qquad \lambda > 0, \quad q(x) = 1 .

Newton's method on these conditions (sequential quadratic programming; Nocedal and Wright,
*Numerical Optimization*, chapter 18) moves x along the tangent plane and then back to the boundary
along its ray, which is a quadratic equation. As :math:`W + \lambda \nabla^2 q` is positive
definite, every step leads downhill; steps that overshoot are halved.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["closest_on_polynomial", "evaluate", "newton_step", "polynomial_values", "to_boundary"]

_EPS = float(np.finfo(np.float64).eps)


@compiled
def evaluate(exponents: Ints, c: Floats, x: Floats, grad: Floats, hess: Floats) -> float:
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
def to_boundary(exponents: Ints, c: Floats, x: Floats) -> float:
    """Scale x != 0 so that q(x) = 1: q(s x) = a s^2 + b s^4, even quartics only.

    Returns ``sum |c_k x^e_k|``, the factor by which rounding of q exceeds that of its value.
    """
    x /= np.abs(x).max()  # fourth powers of far points overflow
    sums = np.zeros((2, 2))
    for k in range(c.shape[0]):
        term = c[k] * _term(exponents[k], x, -1, -1)
        degree = exponents[k].sum() // 2 - 1
        sums[degree, 0] += term
        sums[degree, 1] += abs(term)
    a, b = sums[0, 0], sums[1, 0]
    # s^2 = (-a + sqrt(a^2 + 4 b)) / (2 b), without cancellation
    square = 2.0 / (a + math.sqrt(a * a + 4.0 * b))
    x *= math.sqrt(square)
    return float(square * (sums[0, 1] + square * sums[1, 1]))


@compiled
def closest_on_polynomial(
    points: Floats,
    polynomial: tuple[Ints, Floats],
    metric: tuple[Floats, Floats],
    closest: Floats,
    bound: Floats,
    count: Ints,
) -> None:
    """Fill the closest points, error bounds and iterations (0 inside, -1 not converged).

    Parameters
    ----------
    points : (k, n) float
        Points p.
    polynomial : (m, n) int and (m,) float
        Exponents and coefficients of an even, convex q of degrees two and four.
    metric : (n, n) and (n, n) float
        W = C'C, and the transposed inverse of C.
    closest, bound, count
        Receive the result; the bound is in the norm of W. See `_certificate`.
    """
    exponents, c = polynomial
    n = points.shape[1]
    grad, hess = np.empty(n), np.empty((n, n))
    for k in range(points.shape[0]):
        p = points[k]
        x = p.copy()
        count[k] = 0
        bound[k] = 0.0
        value = evaluate(exponents, c, p, grad, hess)
        noise = 4 * (n + c.shape[0]) * _EPS * evaluate(exponents, np.abs(c), np.abs(p), grad, hess)
        if value > 1.0:
            to_boundary(exponents, c, x)
            count[k] = _newton(polynomial, metric[0], p, x, grad, hess)
            residual, rounding = _certificate(polynomial, metric, p, x)
            bound[k] = residual + rounding
            if not residual <= 1e-9 * (_norm(metric[0], p) + _norm(metric[0], x)) + rounding:
                count[k] = -1
        elif value > 1.0 - noise:  # p lies on the boundary, as far as rounding tells
            bound[k] = noise * _norm(metric[0], p)
        closest[k] = x


@compiled
def _norm(W: Floats, e: Floats) -> float:
    return math.sqrt(max(np.sum(e * _times(W, e)), 0.0))


@compiled
def _times(matrix: Floats, x: Floats) -> Floats:
    """Return ``matrix x`` (`@` on small arrays calls BLAS)."""
    result = np.zeros(matrix.shape[0])
    for i in range(matrix.shape[0]):
        for j in range(x.shape[0]):
            result[i] += matrix[i, j] * x[j]
    return result


@compiled
def _certificate(
    polynomial: tuple[Ints, Floats], metric: tuple[Floats, Floats], p: Floats, x: Floats
) -> tuple[float, float]:
    """Return two parts of a bound, in the norm of W, on the distance of x from the closest point.

    A point x on the boundary is the closest point of ``x + t W^-1 grad q(x)``, t >= 0, and closest
    points are no farther apart than points: so the error is at most ``|C^-T (W e - t grad q)|``,
    ``e = p - x``. The second part is rounding of the two terms, and of q: it puts x off the
    boundary by at most half its relative error, as ``x.grad q >= 2 q``, where the gradient differs.
    """
    (exponents, c), (W, root) = polynomial, metric
    n = x.shape[0]
    grad, rough, hess = np.empty(n), np.empty(n), np.empty((n, n))
    evaluate(exponents, c, x, grad, hess)
    turn = np.abs(_times(hess, x))
    eps = 2 * (n + c.shape[0]) * _EPS
    off = eps * evaluate(exponents, np.abs(c), np.abs(x), rough, hess)
    e = p - x
    normal = _times(root, grad)
    t = max(np.sum(e * grad) / np.sum(normal * normal), 0.0)
    rest = _times(root, _times(W, e) - t * grad)
    noise = eps * _times(np.abs(W), np.abs(e)) + t * (eps * rough + off * turn)
    noise = _times(np.abs(root), noise)
    rounding = math.sqrt(np.sum(noise * noise)) + 2 * off * _norm(W, x)
    return math.sqrt(np.sum(rest * rest)), rounding


@compiled
def _newton(
    polynomial: tuple[Ints, Floats], W: Floats, p: Floats, x: Floats, grad: Floats, hess: Floats
) -> int:
    """Move x along the boundary to the point closest to p; return the iterations."""
    exponents, c = polynomial
    last, moved = math.inf, math.inf
    for iteration in range(1, 100):
        evaluate(exponents, c, x, grad, hess)
        pull = _times(W, p - x)
        shift = max(np.sum(pull * grad) / np.sum(grad * grad), 0.0)
        rest = pull - shift * grad
        off = math.sqrt(np.sum(rest * rest))
        if off > 0.5 * last and moved <= 1e-8 * np.abs(x).max():  # rounding is all that is left
            return iteration
        last = off
        step = newton_step(W + shift * hess, grad, rest)
        noise = 16 * _EPS * _norm(W, x) * _norm(W, p - x)
        length = 1.0
        trial = x.copy()
        while length > 1e-8:
            trial = x + length * step
            rough = to_boundary(exponents, c, trial)
            # half the fall of the squared distance; the difference of the two would cancel
            if np.sum((trial - x) * _times(W, p - 0.5 * (x + trial))) >= -rough * noise:
                break
            length *= 0.5
        if length <= 1e-8:
            return iteration
        moved = np.abs(trial - x).max()
        x[:] = trial
        if moved <= 2 * _EPS * np.abs(x).max():
            return iteration
    return 100


@compiled
def newton_step(hess: Floats, grad: Floats, rest: Floats) -> Floats:
    """Return s, square to the gradient, with ``hess s + mu grad = rest`` for some mu.

    A trace of the identity keeps a Hessian that is singular to rounding from being so exactly.
    """
    n = grad.shape[0]
    matrix, right = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    size = np.abs(hess).max()
    matrix[:n, :n] = hess / size + 2 * _EPS * np.eye(n)
    unit = grad / np.abs(grad).max()
    matrix[:n, n] = unit
    matrix[n, :n] = unit
    right[:n] = rest / size
    return np.linalg.solve(matrix, right)[:n]
