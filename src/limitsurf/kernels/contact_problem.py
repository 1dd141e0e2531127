r"""What the stages of the contact sum share: the problem, its sizes, and the best answer so far.

For a load c, a metric W and :math:`Q = W^{-1}`, the point of the sum closest to c is
:math:`F = \sum P_i f_i`, the forces :math:`|f_i| \le m_i` of the twist

.. math:: v = \arg\min_v\; \tfrac12 v^T Q v - c^T v + \sum_i m_i |P_i^T v|, \qquad Q v = c - F .

For every v and all admissible forces, with :math:`r = c - F - Q v`,

.. math:: |F - F^*|_W^2 \le |r|_W^2 + 2 \sum_i (m_i |u_i| - f_i \cdot u_i)

is a certificate (both terms >= 0; the primal is 1-strongly convex in the norm of W). With v = 0 it
reads :math:`|c - F|_W`: the load lies in the sum, up to that distance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Contacts, stretch_of
from limitsurf.kernels.contact_totals import sum_error
from limitsurf.kernels.symmetric3 import Symmetric, form, plus_outer
from limitsurf.kernels.vectors import Vector, along, cross, dot

__all__ = [
    "BOUND",
    "CERTIFIED",
    "EPS",
    "GAVE_UP",
    "HOLD",
    "KINK",
    "KINK_FORCE",
    "LOAD",
    "PASSES",
    "SLIDE",
    "SMOOTH",
    "TWIST",
    "WITNESS",
    "Problem",
    "Rows",
    "Setting",
    "Witness",
    "keep",
    "new_best",
    "new_setting",
    "norm",
    "residual",
    "second_moments",
    "speed",
    "times_metric",
    "times_rows",
]

_EPS = float(np.finfo(np.float64).eps)

Rows = tuple[Vector, Vector, Vector]

SMOOTH, SLIDE, HOLD, CERTIFIED, GAVE_UP = 0, 1, 2, 3, 4

# numbers of the best answer: F, the twist that certifies it (zero at rest), and its witness
BOUND, LOAD, TWIST, WITNESS, EPS, KINK, KINK_FORCE, PASSES, _BEST = 0, 1, 4, 7, 10, 11, 12, 14, 15


class Setting(NamedTuple):
    r"""A load, a metric, and the sizes of a contact sum.

    `moments` is :math:`M = \sum m P P^T`; `reach` is sum m and `unit` the norm of a unit force, so
    that their product is the size of the sum, and with the load `scale`; `spacing` is the distance
    of neighbours if the contacts were spread evenly; `target` is the certificate asked for, and
    `rounding` what rounding adds to it.
    """

    moments: Symmetric
    Q: Symmetric
    C: Rows
    D: Rows
    c: Vector
    reach: float
    unit: float
    spacing: float
    scale: float
    target: float
    rounding: float


class Problem(NamedTuple):
    """Contacts, room for the sums of their blocks, and the setting."""

    contacts: Contacts
    table: Floats
    setting: Setting


class Witness(NamedTuple):
    """Twist, smoothing, and the force of one contact, from which all forces follow."""

    v: Vector
    eps: float
    kink: int
    fx: float
    fy: float


@compiled
def new_best() -> Floats:
    """Return room for an answer, the numbers of which are named above."""
    best = np.zeros(_BEST)
    best[BOUND], best[KINK], best[EPS] = np.inf, -1.0, -1.0
    return best


@compiled
def times_rows(C: Rows, v: Vector) -> Vector:
    """Return ``C v``."""
    return dot(C[0], v), dot(C[1], v), dot(C[2], v)


@compiled
def gram(C: Rows) -> Symmetric:
    """Return ``C' C``."""
    zero = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return plus_outer(plus_outer(plus_outer(zero, 1.0, C[0]), 1.0, C[1]), 1.0, C[2])


@compiled
def inverse_rows(C: Rows) -> Rows:
    """Return the transposed inverse of C, by cofactors."""
    a, b, c = cross(C[1], C[2]), cross(C[2], C[0]), cross(C[0], C[1])
    d = dot(C[0], a)
    return (
        (a[0] / d, a[1] / d, a[2] / d),
        (b[0] / d, b[1] / d, b[2] / d),
        (c[0] / d, c[1] / d, c[2] / d),
    )


@compiled
def second_moments(contacts: Contacts) -> Symmetric:
    """Return ``M = sum m P P'``, in blocks as in `contact_pass`."""
    xx = xy = yy = xw = yw = ww = 0.0
    x, y, m = contacts.data[0], contacts.data[1], contacts.data[2]
    for start in range(0, x.shape[0], 1024):
        s0 = s1 = s2 = s3 = s4 = s5 = 0.0
        for i in range(start, min(start + 1024, x.shape[0])):
            a, b, d = m[i], 0.0, m[i]
            if contacts.data.shape[0] > 3:
                p, q, r = stretch_of(contacts, i)
                a, b, d = m[i] * (p * p + q * q), m[i] * q * (p + r), m[i] * (q * q + r * r)
            tx, ty = x[i] * b - y[i] * a, x[i] * d - y[i] * b
            s0 += a
            s1 += b
            s2 += d
            s3 += tx
            s4 += ty
            s5 += x[i] * ty - y[i] * tx
        xx, xy, yy, xw, yw, ww = xx + s0, xy + s1, yy + s2, xw + s3, yw + s4, ww + s5
    return xx, xy, yy, xw, yw, ww


@compiled
def _rounding(n: int, moments: Symmetric, C: Rows, c: Vector) -> float:
    """Return what rounding can change in the norm of ``c - F - Q v``."""
    square, contacts2 = 0.0, 0.0
    for row in C:
        square += (abs(row[0] * c[0]) + abs(row[1] * c[1]) + abs(row[2] * c[2])) ** 2
        contacts2 += max(form(moments, row), 0.0)
    reach = 0.5 * (moments[0] + moments[2])
    return 16.0 * _EPS * math.sqrt(square) + sum_error(n) * math.sqrt(reach * contacts2)


@compiled
def new_setting(n: int, moments: Symmetric, C: Rows, c: Vector, unit: float, tol: float) -> Setting:
    """Return the setting of n contacts; `tol` is relative to ``unit * sum m + |c|``."""
    reach = 0.5 * (moments[0] + moments[2])
    arm2 = max(moments[5] - (moments[3] ** 2 + moments[4] ** 2) / max(reach, 1e-300), 0.0)
    spacing = 2.5 * math.sqrt(arm2 / (max(reach, 1e-300) * max(n, 1)))
    z = times_rows(C, c)
    scale = unit * reach + math.sqrt(dot(z, z))
    rounding = _rounding(n, moments, C, c)
    target = max(tol * scale - rounding, rounding)
    D = inverse_rows(C)
    return Setting(moments, gram(D), C, D, c, reach, unit, spacing, scale, target, rounding)


@compiled
def norm(setting: Setting, load: Vector) -> float:
    """Return the length of a load in the metric."""
    z = times_rows(setting.C, load)
    return math.sqrt(dot(z, z))


@compiled
def residual(setting: Setting, left: Vector, v: Vector) -> float:
    """Return the norm of ``left - Q v``, by factors: Q itself is rounded more."""
    z = along(times_rows(setting.C, left), -1.0, times_rows(setting.D, v))
    return math.sqrt(dot(z, z))


@compiled
def times_metric(setting: Setting, load: Vector) -> Vector:
    """Return ``W F``, the twist of a load."""
    C, z = setting.C, times_rows(setting.C, load)
    zero = (0.0, 0.0, 0.0)
    return along(along(along(zero, z[0], C[0]), z[1], C[1]), z[2], C[2])


@compiled
def speed(setting: Setting, v: Vector) -> float:
    """Return the root mean square of the contacts' velocities, weighted by their friction."""
    return math.sqrt(max(form(setting.moments, v), 0.0) / setting.reach)


@compiled
def keep(best: Floats, bound: float, load: Vector, twist: Vector, witness: Witness) -> bool:
    """Keep an answer if its bound is less than the least so far; return whether."""
    if not bound < best[BOUND]:
        return False
    best[BOUND] = bound
    for k in range(3):
        best[LOAD + k], best[TWIST + k], best[WITNESS + k] = load[k], twist[k], witness.v[k]
    best[EPS], best[KINK] = witness.eps, witness.kink
    best[KINK_FORCE], best[KINK_FORCE + 1] = witness.fx, witness.fy
    return True
