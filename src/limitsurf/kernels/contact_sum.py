r"""Closest point of a sum of Coulomb disks, through its dual in three unknowns.

Contacts at :math:`r_i` with friction disks of radius :math:`m_i`; coordinates scaled so that the
metric is the identity. For a load c,

.. math:: v^* = \arg\min_v\; \tfrac12 |v|^2 - c\cdot v + \sum_i m_i |u_i|, \qquad u_i = G_i^T v,

is the (scaled) twist and :math:`c - v^*` the point of the sum closest to c. The kinks are
smoothed, :math:`|u| \to \sqrt{|u|^2+\epsilon^2}`, and Newton's method follows the minimiser while
:math:`\epsilon` falls. The forces :math:`f_i = -m_i u_i/\sqrt{|u_i|^2+\epsilon^2}` are admissible,
so that for every v, with :math:`F = \sum_i G_i f_i`,

.. math:: |F - F^*|^2 \le |v - c - F|^2 + 2 \sum_i (m_i |u_i| + f_i \cdot u_i)

is a certificate; v = 0 gives :math:`|c + F|`, the certificate of rest. (Strong convexity of the
primal; ``docs/contact_sum.md``.)
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["solve_contact_sum"]

_EPS = float(np.finfo(np.float64).eps)


@compiled
def _smoothed(
    x: Floats, y: Floats, m: Floats, v: Floats, eps: float, grad: Floats, hess: Floats
) -> tuple[float, float]:
    """Return ``sum m_i s_i`` (s_i the smoothed speed) and the gap; fill gradient and Hessian.

    The gap ``2 sum m_i (|u| - |u|^2/s)`` is written as ``2 m |u| eps^2 / (s (s + |u|))``: no
    difference of nearly equal numbers.
    """
    value = 0.0
    gap = 0.0
    g0 = g1 = g2 = 0.0
    hxx = hxy = hyy = hxw = hyw = hww = 0.0
    eps2 = eps * eps
    for i in range(x.shape[0]):
        ux = v[0] - v[2] * y[i]
        uy = v[1] + v[2] * x[i]
        speed2 = ux * ux + uy * uy
        s = math.sqrt(speed2 + eps2)
        speed = math.sqrt(speed2)
        k = m[i] / s
        ex = ux / s
        ey = uy / s
        value += m[i] * s
        gap += k * speed * eps2 / (s + speed)
        g0 += m[i] * ex
        g1 += m[i] * ey
        g2 += m[i] * (x[i] * ey - y[i] * ex)
        cxx = k * (1.0 - ex * ex)
        cxy = -k * ex * ey
        cyy = k * (1.0 - ey * ey)
        wx = x[i] * cxy - y[i] * cxx
        wy = x[i] * cyy - y[i] * cxy
        hxx += cxx
        hxy += cxy
        hyy += cyy
        hxw += wx
        hyw += wy
        hww += x[i] * wy - y[i] * wx
    grad[0], grad[1], grad[2] = g0, g1, g2
    hess[0], hess[1], hess[2], hess[3], hess[4], hess[5] = hxx, hxy, hyy, hxw, hyw, hww
    return value, 2.0 * gap


@compiled
def _newton_step(hess: Floats, shift: float, residual: Floats, step: Floats) -> None:
    """Solve ``(shift I + H) step = residual`` by Cholesky; H is positive semidefinite."""
    l00 = math.sqrt(shift + hess[0])
    l10 = hess[1] / l00
    l20 = hess[3] / l00
    l11 = math.sqrt(max(shift + hess[2] - l10 * l10, 0.5 * shift))
    l21 = (hess[4] - l20 * l10) / l11
    l22 = math.sqrt(max(shift + hess[5] - l20 * l20 - l21 * l21, 0.5 * shift))
    z0 = residual[0] / l00
    z1 = (residual[1] - l10 * z0) / l11
    z2 = (residual[2] - l20 * z0 - l21 * z1) / l22
    step[2] = z2 / l22
    step[1] = (z1 - l21 * step[2]) / l11
    step[0] = (z0 - l10 * step[1] - l20 * step[2]) / l00


@compiled
def _norm(a: Floats) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@compiled
def _minimise(
    x: Floats,
    y: Floats,
    m: Floats,
    c: Floats,
    eps: float,
    inertia: float,
    target: float,
    max_passes: int,
    v: Floats,
    friction: Floats,
    best: Floats,
) -> int:
    """Newton with backtracking at one eps; returns passes used.

    `inertia` is 1 for the dual itself; 0 leaves out its quadratic term, and then a minimiser
    exists just where the load lies inside the sum: the forces found there balance it.

    `v` is moved to the minimiser. `best` holds ``(bound, sticks)`` of the best certificate seen
    and `friction` its F; the loop ends as soon as that bound reaches `target`.
    """
    grad = np.empty(3)
    hess = np.empty(6)
    step = np.zeros(3)
    trial = v.copy()
    value_old = np.inf
    slope = 0.0
    length = 1.0
    passes = 0
    while passes < max_passes:
        smooth, gap = _smoothed(x, y, m, trial, eps, grad, hess)
        passes += 1
        value = smooth - _dot(c, trial) + 0.5 * inertia * _dot(trial, trial)
        if value > value_old + 1e-4 * length * slope + 4 * _EPS * abs(smooth) and length > 1e-6:
            length *= 0.4
            trial[:] = v + length * step
            continue
        v[:] = trial
        value_old = value
        _keep_best(c, grad, v, gap, friction, best)
        residual = c - grad - inertia * v
        if best[0] <= target or _norm(residual) <= 0.1 * min(target, eps):
            break
        _newton_step(hess, inertia + 1e-14 * (hess[0] + hess[2] + hess[5]), residual, step)
        slope = -_dot(residual, step)
        length = 1.0
        trial[:] = v + step
    return passes


@compiled
def _dot(a: Floats, b: Floats) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@compiled
def _keep_best(
    c: Floats, grad: Floats, v: Floats, gap: float, friction: Floats, best: Floats
) -> None:
    """Keep F = -grad if the certificate for the twist v, or for rest, is better than the best."""
    residual = c - grad - v
    moving = math.sqrt(_dot(residual, residual) + gap)
    resting = _norm(c - grad)
    bound = min(moving, resting)
    if bound < best[0]:
        best[0] = bound
        best[1] = 1.0 if resting <= moving else 0.0
        friction[:] = -grad


@compiled
def solve_contact_sum(
    x: Floats, y: Floats, m: Floats, c: Floats, start: Floats, tol: float
) -> tuple[Floats, Floats, float, bool, int]:
    """Return ``(v, F, bound, sticks, passes)`` for the load `c`.

    Parameters
    ----------
    x, y, m : (N,) float
        Scaled contact positions and disk radii >= 0; N = 0 is free motion.
    c, start : (3,) float
        Scaled load, and a guess of the twist (zeros if none is known).
    tol : float
        Certificate asked for, relative to ``sum m + |c|``.

    Returns
    -------
    v : (3,) float
        Twist ``c + F``; exactly zero where rest is certified.
    F : (3,) float
        Frictional load, minus the closest point.
    bound : float
        Certified ``|F - F*|``, with a term for the rounding of the sums.
    sticks : bool
        Whether rest is certified: ``|c + F|`` within the tolerance.
    passes : int
        Passes over the contacts.
    """
    reach = 0.0
    total = 0.0
    for i in range(x.shape[0]):
        reach = max(reach, x[i] * x[i] + y[i] * y[i])
        total += m[i]
    rounding = x.shape[0] * _EPS * total * math.sqrt(1.0 + reach)
    friction = np.zeros(3)
    if total == 0.0:
        return c.copy(), friction, 0.0, _norm(c) == 0.0, 0
    scale = total + _norm(c)
    target = max(tol * scale - rounding, 0.5 * tol * scale)
    best = np.array([np.inf, 0.0])
    v = start.copy()
    passes = _minimise(x, y, m, c, 1e-13 * scale, 1.0, target, 12, v, friction, best)
    eps = scale
    v[:] = c / (1.0 + total / eps)
    speed = np.inf
    while best[0] > target and eps > 1e-16 * scale:
        passes += _minimise(x, y, m, c, eps, 1.0, target, 12, v, friction, best)
        if best[0] > target and _norm(v) < 0.3 * speed:  # the twist falls with eps: at rest
            rest = v.copy()
            passes += _minimise(x, y, m, c, eps, 0.0, target, 12, rest, friction, best)
            v *= 0.1
        speed = _norm(v)
        eps *= 0.1
    sticks = best[1] == 1.0 and best[0] <= target
    twist = np.zeros(3) if sticks else c + friction
    return twist, friction, best[0] + rounding, sticks, passes
