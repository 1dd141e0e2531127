r"""The contact sum where kinks crowd: Newton's method on twist and forces together.

The smoothed dual, :math:`s_i = \sqrt{|u_i|^2 + \epsilon^2}`, has

.. math:: Q v + \sum_i P_i f_i = c, \qquad s_i f_i = m_i u_i, \quad |f_i| \le m_i .

Linearised in v and f together, instead of f put into the first equation, Newton's method converges
fast from afar even where many contacts are nearly at rest (Chan, Golub and Mulet, SIAM J. Sci.
Comput. 20, 1999; Andersen, Christiansen, Conn and Overton, SIAM J. Sci. Comput. 22, 2000). With
:math:`f_i` eliminated three unknowns are left:

.. math:: \Big( Q + \sum_i P_i \big( \tfrac{m_i}{s_i} I - \tfrac{f_i u_i^T + u_i f_i^T}{2 s_i^2}
          \big) P_i^T \Big)\, \delta v = c - Q v - \sum_i P_i \tfrac{m_i u_i}{s_i} .
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Contacts, contact_columns
from limitsurf.kernels.contact_problem import (
    BOUND,
    PASSES,
    Problem,
    Witness,
    keep,
    norm,
    residual,
    speed,
)
from limitsurf.kernels.kink_polish import force_gap, polish_kinks, velocity_rounding
from limitsurf.kernels.symmetric3 import Symmetric, form, plus, plus_outer, solved, times
from limitsurf.kernels.vectors import Vector, along, dot, length

__all__ = ["primal_dual"]

_EPS = float(np.finfo(np.float64).eps)
_ZERO = (0.0, 0.0, 0.0)
_FAST = 1e4  # contacts that much faster than eps take the force of their velocity
_PASSES = 150
_CLOSE = 1e-4  # eps, relative to the speed, from which kinks are tried as they are
_STILL = 30.0  # contacts slower than that many eps are taken to stand still


@compiled
def _update_forces(contacts: Contacts, forces: Floats, v: Vector, step: Vector, eps: float) -> None:
    """Move the forces along with a step of the twist, and back into their disks."""
    for i in range(contacts.data.shape[1]):
        one, two = contact_columns(contacts, i)
        m, fx, fy = contacts.data[2, i], forces[i, 0], forces[i, 1]
        ux, uy = dot(one, v), dot(two, v)
        dx, dy = dot(one, step), dot(two, step)
        s2 = ux * ux + uy * uy + eps * eps
        s, turn = math.sqrt(s2), (ux * dx + uy * dy) / s2
        fx, fy = m * (ux + dx) / s - fx * turn, m * (uy + dy) / s - fy * turn
        size = length(fx, fy)
        if size > m:
            fx, fy = m * fx / size, m * fy / size
        forces[i, 0], forces[i, 1] = fx, fy


@compiled
def _pass(
    contacts: Contacts, forces: Floats, v: Vector, eps: float
) -> tuple[float, Vector, Symmetric, Vector, Vector, float]:
    """Return ``h_eps``, its gradient, the matrix, and for the certificates two loads and a gap.

    The first load is of the forces, but of the velocity's force for contacts that are fast, with
    its gap; the second of the forces alone.
    """
    h, gap = 0.0, 0.0
    g, moving, resting = _ZERO, _ZERO, _ZERO
    A = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(contacts.data.shape[1]):
        m = contacts.data[2, i]
        if not m > 0.0:
            continue
        one, two = contact_columns(contacts, i)
        fx, fy = forces[i, 0], forces[i, 1]
        ux, uy = dot(one, v), dot(two, v)
        square = ux * ux + uy * uy
        s2 = square + eps * eps
        s, size = math.sqrt(s2), math.sqrt(square)
        h += m * s
        g = along(along(g, m * ux / s, one), m * uy / s, two)
        A = plus_outer(plus_outer(A, m / s - fx * ux / s2, one), m / s - fy * uy / s2, two)
        cross = -0.5 * (fx * uy + fy * ux) / s2
        both = along(one, 1.0, two)
        A = plus_outer(plus_outer(plus_outer(A, cross, both), -cross, one), -cross, two)
        resting = along(along(resting, fx, one), fy, two)
        if size > _FAST * eps:
            moving = along(along(moving, m * ux / size, one), m * uy / size, two)
        else:
            moving = along(along(moving, fx, one), fy, two)
            if size > velocity_rounding(one, two, v):
                gap += force_gap(m, fx / m, fy / m, ux, uy, size)
    return h, g, A, moving, resting, gap


@compiled
def _write_forces(
    contacts: Contacts, forces: Floats, v: Vector, eps: float, moving: bool, room: Floats
) -> None:
    """Fill `room` with the forces that one of the two loads of `_pass` is made of."""
    for i in range(room.shape[0]):
        room[i] = forces[i]
        one, two = contact_columns(contacts, i)
        ux, uy = dot(one, v), dot(two, v)
        size = length(ux, uy)
        if moving and size > _FAST * eps:
            room[i, 0], room[i, 1] = (
                contacts.data[2, i] * ux / size,
                contacts.data[2, i] * uy / size,
            )


@compiled
def _first_forces(contacts: Contacts, v: Vector, eps: float) -> Floats:
    forces = np.empty((contacts.data.shape[1], 2))
    for i in range(forces.shape[0]):
        one, two = contact_columns(contacts, i)
        ux, uy = dot(one, v), dot(two, v)
        k = contacts.data[2, i] / math.sqrt(ux * ux + uy * uy + eps * eps)
        forces[i, 0], forces[i, 1] = k * ux, k * uy
    return forces


@compiled
def primal_dual(problem: Problem, best: Floats, v: Vector, eps: float, room: Floats) -> None:
    """Improve the best answer until it is certified or rounding stops it.

    `room` (N, 2) receives the forces of the best answer found here; (0, 2) if none are wanted.
    """
    contacts, setting = problem.contacts, problem.setting
    Q, c = setting.Q, setting.c
    forces = _first_forces(contacts, v, eps)
    least, value_old, slope, share = 1e-16 * eps, np.inf, 0.0, 1.0
    step, idle = _ZERO, 0
    for _ in range(_PASSES):
        trial = along(v, share, step)
        h, g, A, moving, resting, gap = _pass(contacts, forces, trial, eps)
        best[PASSES] += 1
        old = best[BOUND]
        bound = math.sqrt(residual(setting, along(c, -1.0, moving), trial) ** 2 + gap)
        witness = Witness(trial, -1.0, -1, 0.0, 0.0)
        if keep(best, bound, moving, trial, witness):
            _write_forces(contacts, forces, trial, eps, True, room)
        if keep(best, norm(setting, along(c, -1.0, resting)), resting, _ZERO, witness):
            _write_forces(contacts, forces, trial, eps, False, room)
        if best[BOUND] <= setting.target:
            return
        value = h - dot(c, trial) + 0.5 * form(Q, trial)
        noise = 8.0 * _EPS * (abs(h) + abs(value))
        if value > value_old + 1e-4 * share * slope + noise and share > 1e-3:
            share *= 0.4
            continue
        v, value_old, share = trial, value, 1.0
        rest = along(along(c, -1.0, g), -1.0, times(Q, v))
        ok, step = solved(plus(A, 1.0, Q), rest)
        if not ok:
            return
        slope = -dot(rest, step)
        _update_forces(contacts, forces, v, step, eps)
        if speed(setting, step) <= max(eps, 1e-14 * speed(setting, v)):
            if eps <= least:
                idle += 1
                if idle > 4 and best[BOUND] > 0.5 * old:
                    return
            slow = _STILL * eps
            if eps < _CLOSE * speed(setting, v) and polish_kinks(
                problem, best, v, slow, forces, room
            ):
                return
            eps = max(0.1 * eps, least)
            value_old = np.inf
