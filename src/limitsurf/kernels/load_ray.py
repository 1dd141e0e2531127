r"""The motion under a load whose size is free: where its ray leaves a sum of disks.

A load along F moves the part once it reaches the boundary of :math:`B = \{\sum G_i f_i : |f_i| \le
m_i\}`, at :math:`s F` with :math:`s = \min \{h(v) : F \cdot v = 1\}`,
:math:`h(v) = \sum m_i |G_i^T v|`, and moves it along the minimiser v, an outer normal there (the
dual of the gauge of B; Rockafellar, Convex Analysis, section 15). In the plane :math:`v = F + P z`
this is a convex problem in two unknowns. It is solved by Newton's method, h smoothed to
:math:`\sum m_i \sqrt{|u_i|^2 + \epsilon^2}` and epsilon falling: kinks, where a contact is the
centre of rotation, are then approached from their inside.

Forces :math:`f_i = m_i u_i / \sqrt{|u_i|^2 + \epsilon^2}` lie in their disks, so their load lies in
B: its part along F against h(v), and its part across, prove how good the answer is.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.symmetric3 import Symmetric, form, times
from limitsurf.kernels.vectors import Vector, along, dot

__all__ = ["motions_on_rays"]

_STEPS, _HALVINGS, _POLISH = 30, 30, 5


@compiled
def _sums(contacts: Floats, v: Vector, eps: float) -> tuple[float, Vector, Symmetric, float]:
    """Return the smoothed h, its gradient and Hessian, and h itself."""
    h = plain = g0 = g1 = g2 = xx = xy = yy = xw = yw = ww = 0.0
    for i in range(contacts.shape[1]):
        x, y, m = contacts[0, i], contacts[1, i], contacts[2, i]
        ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
        speed2 = ux * ux + uy * uy
        s = math.sqrt(speed2 + eps * eps)
        q = m / s
        ex, ey = ux / s, uy / s
        h += m * s
        plain += m * math.sqrt(speed2)
        g0 += m * ex
        g1 += m * ey
        g2 += m * (x * ey - y * ex)
        a, b, d = q * (1.0 - ex * ex), -q * ex * ey, q * (1.0 - ey * ey)
        tx, ty = x * b - y * a, x * d - y * b
        xx += a
        xy += b
        yy += d
        xw += tx
        yw += ty
        ww += x * ty - y * tx
    return h, (g0, g1, g2), (xx, xy, yy, xw, yw, ww), plain


@compiled
def _across(F: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors normal to the unit vector F and to each other."""
    if abs(F[0]) < 0.6:
        n = math.sqrt(F[1] * F[1] + F[2] * F[2])
        p = (0.0, F[2] / n, -F[1] / n)
    else:
        n = math.sqrt(F[0] * F[0] + F[1] * F[1])
        p = (F[1] / n, -F[0] / n, 0.0)
    q = (F[1] * p[2] - F[2] * p[1], F[2] * p[0] - F[0] * p[2], F[0] * p[1] - F[1] * p[0])
    return p, q


@compiled
def _newton_step(g: Vector, H: Symmetric, p: Vector, q: Vector) -> tuple[Vector, float]:
    """Return Newton's step in the plane of p and q, and the slope along it."""
    gp, gq = dot(g, p), dot(g, q)
    hp = times(H, p)
    a, b, d = dot(hp, p), dot(hp, q), form(H, q)
    lift = 1e-12 * (a + d) + 1e-300  # a flat direction: friction without any spread
    a, d = a + lift, d + lift
    det = a * d - b * b
    if det <= 0.0:
        a, d, b = a + d, a + d, 0.0
        det = a * d
    zp, zq = (b * gq - d * gp) / det, (b * gp - a * gq) / det
    step = along((zp * p[0], zp * p[1], zp * p[2]), zq, q)
    return step, gp * zp + gq * zq


@compiled
def _settle(contacts: Floats, v: Vector, p: Vector, q: Vector, eps: float) -> Vector:
    """Minimise the smoothed h over the plane through v, from v."""
    for _ in range(_STEPS):
        h, g, H, _ = _sums(contacts, v, eps)
        step, slope = _newton_step(g, H, p, q)
        if not slope < -1e-15 * h:
            break
        share = 1.0
        for _ in range(_HALVINGS):
            if _sums(contacts, along(v, share, step), eps)[0] <= h + 1e-4 * share * slope:
                break
            share *= 0.5
        else:
            break
        v = along(v, share, step)
    return v


@compiled
def _polish(contacts: Floats, v: Vector, p: Vector, q: Vector, eps: float) -> Vector:
    """Take Newton's steps that balance the load better, where h no longer tells: near kinks."""
    _, g, H, _ = _sums(contacts, v, eps)
    off = math.hypot(dot(g, p), dot(g, q))
    for _ in range(_POLISH):
        step, _ = _newton_step(g, H, p, q)
        trial = along(v, 1.0, step)
        _, g, H, _ = _sums(contacts, trial, eps)
        left = math.hypot(dot(g, p), dot(g, q))
        if not left < 0.5 * off:
            break
        v, off = trial, left
    return v


@compiled
def motions_on_rays(
    loads: Floats, contacts: Floats, width: float, motion: Floats, error: Floats
) -> None:
    r"""Fill motions v with F.v = 1, F of unit length, and the errors of their certificates.

    Parameters
    ----------
    loads : (n, 3) float
        Loads F of unit length.
    contacts : (3, N) float
        Rows x, y, m; lengths of order 1.
    width : float
        Last width epsilon of the smoothing, a speed.
    motion : (n, 3) float
        Gets v.
    error : (n, 2) float
        Gets ``1 - (f.F)/h(v)`` and ``|f - (f.F) F| / h(v)`` of the forces' load f.
    """
    for k in range(loads.shape[0]):
        F = (loads[k, 0], loads[k, 1], loads[k, 2])
        p, q = _across(F)
        v, eps = F, 1.0
        while True:
            v = _settle(contacts, v, p, q, max(eps, width))
            if eps <= width:
                break
            eps *= 0.2
        v = _polish(contacts, v, p, q, width)
        _, f, _, h = _sums(contacts, v, width)
        motion[k, 0], motion[k, 1], motion[k, 2] = v
        s = dot(f, F)
        rest = along(f, -s, F)
        scale = max(h, np.finfo(np.float64).tiny)
        error[k, 0], error[k, 1] = 1.0 - s / scale, math.sqrt(dot(rest, rest)) / scale
