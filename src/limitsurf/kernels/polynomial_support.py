r"""Support points of :math:`\{x : q(x) \le 1\}` for even convex quartics q.

The point farthest along d satisfies :math:`d = \lambda \nabla q(x)`, :math:`q(x) = 1`. Newton's
method moves x along the tangent plane and back to the boundary along its ray, as in `polynomial`.
Where the boundary is flat to third order, like that of :math:`x^4 + y^4` at (1, 0), the Hessian is
singular: a multiple of the identity that falls with the residual is added (Levenberg-Marquardt).
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.polynomial import evaluate, newton_step, to_boundary

__all__ = ["support_on_polynomial"]

_EPS = float(np.finfo(np.float64).eps)


@compiled
def support_on_polynomial(
    directions: Floats, exponents: Ints, c: Floats, farthest: Floats, residual: Floats
) -> None:
    r"""Fill the points farthest along the directions, and the residuals.

    Parameters
    ----------
    directions : (k, n) float
        Directions d; d = 0 gets the origin.
    exponents, c : (m, n) int, (m,) float
        An even, convex q of degrees two and four.
    farthest : (k, n) float
        Receives the points.
    residual : (k,) float
        Receives ``|d - t grad q(x)| / |d|`` for the best t >= 0: the sine of the angle between d
        and the normal at x. As x is the support point of its own normal, the support function is
        ``d.x`` up to ``2 |d| residual R``, with R the largest \|x\|.
    """
    n = directions.shape[1]
    grad = np.empty(n)
    for k in range(directions.shape[0]):
        d = directions[k]
        size = np.abs(d).max()
        farthest[k] = d
        residual[k] = 0.0
        if size > 0.0:
            d = d / size
            x = d.copy()
            to_boundary(exponents, c, x)
            _ascend(exponents, c, d, x, grad)
            shift = max(np.sum(d * grad) / np.sum(grad * grad), 0.0)
            farthest[k] = x
            residual[k] = math.sqrt(np.sum((d - shift * grad) ** 2) / np.sum(d * d))


@compiled
def _ascend(exponents: Ints, c: Floats, d: Floats, x: Floats, grad: Floats) -> None:
    """Move x along the boundary to the point farthest along d; leave the gradient there."""
    hess = np.empty((d.shape[0], d.shape[0]))
    evaluate(exponents, c, x, grad, hess)
    last, moved = math.inf, math.inf
    for _ in range(100):
        shift = max(np.sum(d * grad) / np.sum(grad * grad), 0.0)
        rest = d - shift * grad
        off, size = math.sqrt(np.sum(rest * rest)), math.sqrt(np.sum(x * x))
        if off > 0.5 * last and moved <= 1e-8 * size:  # rounding is all that is left
            return
        last = off
        step = newton_step(shift * hess + off / size * np.eye(d.shape[0]), grad, rest)
        length = 1.0
        trial = x.copy()
        while length > 1e-8:
            trial = x + length * step
            rough = to_boundary(exponents, c, trial)
            if np.sum(d * (trial - x)) >= -16 * _EPS * rough * size:
                break
            length *= 0.5
        if length <= 1e-8:
            return
        moved = np.abs(trial - x).max()
        x[:] = trial
        evaluate(exponents, c, x, grad, hess)
        if moved <= 2 * _EPS * size:
            return
