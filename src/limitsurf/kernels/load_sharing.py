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

_STEPS = 300
_RIDGE = 1e-14  # of each diagonal entry: contacts on a line or a point leave H singular
_DAMPING = 0.001  # relative to the imbalance: long steps help nobody while H is nearly singular
_OVERSHOT, _HALVINGS = 0.3, 60  # slopes decide where the objective no longer shows a difference


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
def _within(g: Vector, n: float, tol: Vector) -> bool:
    return abs(g[0]) <= tol[0] * n and abs(g[1]) <= tol[1] * n and abs(g[2]) <= tol[2] * n


@compiled
def share_minimum_norm(x: Floats, y: Floats, tol: Vector) -> tuple[Vector, int, bool]:
    """Return multipliers for the mean load 1, Newton steps, and whether the loads balance.

    Parameters
    ----------
    x, y : (n,) float
        Supports about the centre of mass; best along their principal axes, of size 1 on each. The
        loads do not depend on linear maps of the plane, their rounding does.
    tol : (3,) float
        Largest imbalance of force and moments, relative to n. Without loads in equilibrium the
        multipliers diverge. Steps go on until rounding stops them.
    """
    n = float(x.shape[0])
    b: Vector = (n, 0.0, 0.0)
    lam: Vector = (1.0, 0.0, 0.0)
    value, g, H = _pass(x, y, b, lam)
    best, left, steps = lam, g, 0
    while steps < _STEPS and _size(left) > 0.0:
        more = 1.0 + _RIDGE + _DAMPING * _size(g) / n
        damped = (more * H[0], H[1], more * H[2] + 1e-300, H[3], H[4], more * H[5] + 1e-300)
        ok, down = solved(damped, (-g[0], -g[1], -g[2]))
        slope = dot(g, down)
        if not ok or not slope < 0.0:
            break
        noise = 1e-15 * (abs(value) + abs(dot(b, lam)))
        share = 1.0
        for _ in range(_HALVINGS):
            new = along(lam, share, down)
            found, g, H = _pass(x, y, b, new)
            ahead = dot(g, down)
            if ahead <= -_OVERSHOT * slope and found <= value + noise:
                break
            part = slope / (slope - ahead) if ahead > 0.0 else 0.5
            share *= min(max(part, 0.1), 0.9)
        lam, value = new, found
        steps += 1
        if _size(g) < _size(left):
            best, left = lam, g
        elif _within(left, n, tol):
            break
    return best, steps, _within(left, n, tol)
