r"""Minimum-norm non-negative loads in equilibrium, by Newton's method on three unknowns.

.. math::
    \min \tfrac12 \sum N_i^2, \quad \sum N_i a_i = b, \quad N_i \ge 0, \qquad a_i = (1, x_i, y_i)

By duality ``N_i = max(0, a_i . lam)``, and lam minimises the convex, piecewise quadratic
``sum max(0, a_i . lam)^2 / 2 - b . lam``. A Newton step solves it for the contacts that are loaded
now (semismooth Newton; Qi and Sun, Math. Programming 58, 1993); once these are the right ones the
loads balance to rounding. Any lam meets all other conditions of optimality exactly, so the
imbalance is all there is to certify.
"""

from __future__ import annotations

import math

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.symmetric3 import Symmetric, solved
from limitsurf.kernels.vectors import Vector, along, dot

__all__ = ["share_minimum_norm"]

_STEPS = 100
_RIDGE = 1e-14  # relative to the diagonal: contacts on a line or a point leave H singular
_SUFFICIENT = 1e-4


@compiled
def _pass(x: Floats, y: Floats, b: Vector, lam: Vector) -> tuple[float, Vector, Symmetric]:
    """Return the dual objective, its gradient ``sum N a - b``, and its generalised Hessian."""
    square = g0 = g1 = g2 = 0.0
    h0 = h1 = h2 = h3 = h4 = h5 = 0.0
    for i in range(x.shape[0]):
        N = lam[0] + lam[1] * x[i] + lam[2] * y[i]
        on = 1.0 if N > 0.0 else 0.0
        N *= on
        square += N * N
        g0 += N
        g1 += N * x[i]
        g2 += N * y[i]
        ox, oy = on * x[i], on * y[i]
        h0 += on
        h1 += ox
        h2 += ox * x[i]
        h3 += oy
        h4 += ox * y[i]
        h5 += oy * y[i]
    gradient = g0 - b[0], g1 - b[1], g2 - b[2]
    return 0.5 * square - dot(b, lam), gradient, (h0, h1, h2, h3, h4, h5)


@compiled
def _size(v: Vector) -> float:
    return math.sqrt(dot(v, v))


@compiled
def share_minimum_norm(
    x: Floats, y: Floats, b: Vector, tol: float
) -> tuple[Vector, Vector, int, bool]:
    """Return multipliers, imbalance, Newton steps, and whether the imbalance meets `tol`.

    Parameters
    ----------
    x, y : (n,) float
        Supports about the centre of mass, of size 1.
    b : (3,) float
        Force and moments, of size n.
    tol : float
        Largest imbalance relative to |b|. Without loads in equilibrium the multipliers diverge.
    """
    lam: Vector = (b[0] / max(x.shape[0], 1), 0.0, 0.0)
    value, g, H = _pass(x, y, b, lam)
    best, left, steps = lam, g, 0
    while steps < _STEPS:
        if _size(g) < _size(left) or steps == 0:
            best, left = lam, g
        elif _size(left) <= tol * _size(b):
            break  # rounding is reached
        if _size(left) == 0.0:
            break
        ridge = _RIDGE * (H[0] + H[2] + H[5]) + 1e-300
        damped = (H[0] + ridge, H[1], H[2] + ridge, H[3], H[4], H[5] + ridge)
        ok, down = solved(damped, (-g[0], -g[1], -g[2]))
        slope = dot(g, down)
        if not ok or not slope < 0.0:
            break
        share = 1.0
        new = along(lam, share, down)
        found, g, H = _pass(x, y, b, new)
        noise = 1e-15 * (abs(value) + abs(dot(b, lam)))
        while found > value + _SUFFICIENT * share * slope + noise and share > 1e-12:
            share *= 0.5
            new = along(lam, share, down)
            found, g, H = _pass(x, y, b, new)
        lam, value = new, found
        steps += 1
    return best, left, steps, _size(left) <= tol * _size(b)
