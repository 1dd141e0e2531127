r"""The contact sum with several kinks at once: contacts that stand still as constraints.

Contacts A that an iterate nearly stops are stopped, :math:`P_i^T v = 0`: v lies in the null space N
of their loads, and their forces are free. Newton's method on

.. math:: Q v + \sum_{i \notin A} m_i P_i \frac{u_i}{|u_i|} + \sum_{i \in A} P_i f_i = c,
          \qquad v \in N,

moves v within N, where the residual has nothing of the free forces, and balances the rest by the
least change of the forces. It is exact as soon as A is right, however many contacts share a kink.
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
    residual,
)
from limitsurf.kernels.symmetric3 import Symmetric, plus, plus_outer, times
from limitsurf.kernels.vectors import Vector, along, dot, length, scaled

__all__ = ["force_gap", "polish_kinks", "velocity_rounding"]

_STEPS = 6
_EPS = float(np.finfo(np.float64).eps)
_DEPENDENT = 1e-15  # an eigenvalue of sum P P' below this, relative to the largest, is zero
_NONE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_ZERO = (0.0, 0.0, 0.0)


@compiled
def _full(S: Symmetric) -> Floats:
    return np.array([[S[0], S[1], S[3]], [S[1], S[2], S[4]], [S[3], S[4], S[5]]])


@compiled
def _loads_of_still(contacts: Contacts, v: Vector, slow: float) -> Symmetric:
    """Return ``sum P P'`` of the contacts that move slower than `slow`."""
    total = _NONE
    for i in range(contacts.data.shape[1]):
        one, two = contact_columns(contacts, i)
        if length(dot(one, v), dot(two, v)) <= slow:
            total = plus_outer(plus_outer(total, 1.0, one), 1.0, two)
    return total


@compiled
def velocity_rounding(one: Vector, two: Vector, v: Vector) -> float:
    """Return what rounding makes of the velocity of a contact that stands still."""
    arms = 0.0
    for k in range(3):
        arms += (abs(one[k]) + abs(two[k])) * abs(v[k])
    return 4.0 * _EPS * arms


@compiled
def force_gap(m: float, fx: float, fy: float, ux: float, uy: float, size: float) -> float:
    """Return ``2 m (|u| - f.u)``, f in the unit disk, without cancellation."""
    if size == 0.0:
        return 0.0
    apart = (ux / size - fx) ** 2 + (uy / size - fy) ** 2
    return m * size * (apart + max(1.0 - fx * fx - fy * fy, 0.0))


@compiled
def _pass(
    contacts: Contacts, forces: Floats, still: Floats, v: Vector
) -> tuple[Vector, Symmetric, float]:
    """Return the load of all contacts, the Hessian of those that move, and the gap of the others.

    The forces of those that move are filled. The others may move too, as far as their loads are
    dependent only to rounding.
    """
    load, H, gap = _ZERO, _NONE, 0.0
    for i in range(contacts.data.shape[1]):
        one, two = contact_columns(contacts, i)
        m = contacts.data[2, i]
        ux, uy = dot(one, v), dot(two, v)
        size = length(ux, uy)
        if still[i] > 0.0 and m > 0.0 and size > velocity_rounding(one, two, v):
            gap += force_gap(m, forces[i, 0] / m, forces[i, 1] / m, ux, uy, size)
        elif still[i] == 0.0:
            ex, ey = (ux / size, uy / size) if size > 0.0 else (0.0, 0.0)
            forces[i, 0], forces[i, 1] = m * ex, m * ey
            if size > 0.0:
                H = plus_outer(H, m / size, along(scaled(-ey, one), ex, two))
        load = along(along(load, forces[i, 0], one), forces[i, 1], two)
    return load, H, gap


@compiled
def _change_forces(contacts: Contacts, forces: Floats, still: Floats, push: Vector) -> None:
    """Add ``P_i' push`` to the forces of the contacts that stand still, within their disks."""
    for i in range(contacts.data.shape[1]):
        if still[i] > 0.0:
            one, two = contact_columns(contacts, i)
            fx, fy = forces[i, 0] + dot(one, push), forces[i, 1] + dot(two, push)
            size = length(fx, fy)
            share = min(1.0, contacts.data[2, i] / size) if size > 0.0 else 1.0
            forces[i, 0], forces[i, 1] = share * fx, share * fy


@compiled
def _least_squares(S: Floats, b: Floats) -> Floats:
    """Return x with ``S x = b`` for a positive S, but for what rounding makes of zero."""
    values, axes = np.linalg.eigh(S)
    kept = values > _EPS * values[-1]
    x: Floats = axes @ (np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0) * (axes.T @ b))
    return x


@compiled
def polish_kinks(
    problem: Problem, best: Floats, v: Vector, slow: float, start: Floats, room: Floats
) -> bool:
    """Stop the contacts slower than `slow` and solve; return whether that certifies the answer.

    `start` (N, 2) holds forces to start from; `room` receives those of the answer unless (0, 2).
    """
    contacts, setting = problem.contacts, problem.setting
    values, axes = np.linalg.eigh(_full(_loads_of_still(contacts, v, slow)))
    zero = values <= _DEPENDENT * values[2]
    still = np.empty(contacts.data.shape[1])
    for i in range(still.shape[0]):
        one, two = contact_columns(contacts, i)
        moves = zero.any() and length(dot(one, v), dot(two, v)) > slow
        still[i] = 0.0 if moves else 1.0
    forces = start.copy()
    inverse = np.where(zero, 0.0, 1.0 / np.where(zero, 1.0, values))
    N = np.ascontiguousarray(axes[:, zero])
    at = N @ (N.T @ np.array(v))
    for _ in range(_STEPS):
        v = at[0], at[1], at[2]
        load, H, gap = _pass(contacts, forces, still, v)
        best[PASSES] += 1
        left = along(setting.c, -1.0, load)
        bound = math.sqrt(residual(setting, left, v) ** 2 + gap)
        if keep(best, bound, load, v, Witness(v, -1.0, -1, 0.0, 0.0)):
            for i in range(room.shape[0]):
                room[i] = forces[i]
        if best[BOUND] <= setting.target:
            return True
        B = plus(H, 1.0, setting.Q)
        rest = np.array(along(left, -1.0, times(setting.Q, v)))
        step = np.zeros(3)
        if N.shape[1] > 0:
            step = N @ _least_squares(N.T @ (_full(B) @ N), N.T @ rest)
        at = at + step
        rest = rest - _full(B) @ step
        push = axes @ (inverse * (axes.T @ rest))
        _change_forces(contacts, forces, still, (push[0], push[1], push[2]))
    return False
