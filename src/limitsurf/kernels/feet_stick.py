r"""Contacts that stop, and contacts that are let go.

A contact at r that has stopped sticks if the force that keeps it there lies within its friction.
The part then turns about it with :math:`\dot v = p \dot\omega`; the force is what the motion of the
centre of mass asks for, and :math:`Q` does not give,

.. math:: f = m (\dot a - \omega b, \dot b + \omega a) - (Q_x, Q_y), \qquad |S^{-1} f| \le m_i .

Contacts at the same place share it.
"""

from __future__ import annotations

import math

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.contact_pass import Contacts, stretch_of
from limitsurf.kernels.feet_rates import FREE, Feet, Freedom, Rate, rate, total_load
from limitsurf.kernels.feet_run import (
    PIVOT,
    PIVOT_X,
    PIVOT_Y,
    TURN,
    Run,
    T,
    X,
    Y,
    set_twist,
)
from limitsurf.kernels.load_table import turned
from limitsurf.kernels.vectors import Vector, along

__all__ = [
    "contact_load",
    "effort",
    "freedom_of",
    "hold_at",
    "let_go",
    "nudged",
    "place_about_pivot",
    "stick",
    "without_velocity",
]


@compiled
def freedom_of(run: Run) -> Freedom:
    """Return how the part may move now."""
    pivot = int(run.state[PIVOT])
    if pivot < 0:
        return FREE
    return Freedom(pivot, run.feet.data[0, pivot], run.feet.data[1, pivot])


@compiled
def _needed(feet: Feet, now: Rate, v: Vector) -> tuple[float, float]:
    """Return the force f at the pivot."""
    Q = total_load(feet, now.load, now.friction, v)
    m = feet.mass
    return m * (now.v[0] - v[2] * v[1]) - Q[0], m * (now.v[1] + v[2] * v[0]) - Q[1]


@compiled
def _unstretched(feet: Feet, i: int, fx: float, fy: float) -> tuple[float, float]:
    """Return ``S^-1 f``."""
    a, b, d = stretch_of(Contacts(feet.data, 1, None), i)
    det = a * d - b * b
    return (d * fx - b * fy) / det, (a * fy - b * fx) / det


@compiled
def _same_place(feet: Feet, i: int, j: int) -> bool:
    data = feet.data
    same = data[0, i] == data[0, j] and data[1, i] == data[1, j]
    for k in range(3, data.shape[0]):
        same = same and data[k, i] == data[k, j]
    return bool(same)


@compiled
def effort(run: Run, pivot: int, now: Rate, v: Vector) -> float:
    """Return ``|S^-1 f|`` over the friction of the contacts at the pivot: above 1 they slip."""
    friction = 0.0
    for i in range(run.radii.shape[0]):
        if _same_place(run.feet, i, pivot):
            friction += run.radii[i]
    fx, fy = _needed(run.feet, now, v)
    gx, gy = _unstretched(run.feet, pivot, fx, fy)
    return math.sqrt(gx * gx + gy * gy) / friction


@compiled
def hold_at(run: Run, pivot: int) -> None:
    """Take the contacts at a place out of those that slide."""
    for i in range(run.radii.shape[0]):
        if _same_place(run.feet, i, pivot):
            run.feet.data[2, i] = 0.0


@compiled
def let_go(run: Run) -> None:
    """Let all contacts slide."""
    run.feet.data[2] = run.radii
    run.state[PIVOT] = -1.0


@compiled
def without_velocity(feet: Feet, i: int, v: Vector, ux: float, uy: float) -> Vector:
    """Return the twist after the impulse at contact i that takes off the velocity u of it."""
    m, inertia, x, y = feet.mass, feet.inertia, feet.data[0, i], feet.data[1, i]
    a, b, d = 1.0 / m + y * y / inertia, -x * y / inertia, 1.0 / m + x * x / inertia
    det = a * d - b * b
    px, py = (d * ux - b * uy) / det, (a * uy - b * ux) / det
    return along(v, -1.0, (px / m, py / m, (x * py - y * px) / inertia))


@compiled
def stick(run: Run, k: int, v: Vector) -> bool:
    """Make contact k a pivot if it holds the part; return whether."""
    feet, state = run.feet, run.state
    x, y = feet.data[0, k], feet.data[1, k]
    v = without_velocity(feet, k, v, v[0] - v[2] * y, v[1] + v[2] * x)
    v = v[2] * y, -v[2] * x, v[2]
    hold_at(run, k)
    now = rate(feet, Freedom(k, x, y), run.load, state[T], v, state[TURN])
    if effort(run, k, now, v) > 1.0:
        let_go(run)
        return False
    set_twist(state, v)
    arm = turned((x, y, 0.0), -state[TURN])
    state[PIVOT], state[PIVOT_X], state[PIVOT_Y] = k, state[X] + arm[0], state[Y] + arm[1]
    return True


@compiled
def place_about_pivot(run: Run, freedom: Freedom) -> None:
    """Set the place of the centre of mass by that of the pivot, and the angle."""
    state = run.state
    arm = turned((freedom.x, freedom.y, 0.0), -state[TURN])
    state[X], state[Y] = state[PIVOT_X] - arm[0], state[PIVOT_Y] - arm[1]


@compiled
def nudged(run: Run, k: int, v: Vector, speed: float) -> Vector:
    """Return the twist with contact k set in motion, against the force that would hold it."""
    feet, state = run.feet, run.state
    x, y = feet.data[0, k], feet.data[1, k]
    still = without_velocity(feet, k, v, v[0] - v[2] * y, v[1] + v[2] * x)
    still = still[2] * y, -still[2] * x, still[2]
    hold_at(run, k)
    now = rate(feet, Freedom(k, x, y), run.load, state[T], still, state[TURN])
    fx, fy = _needed(feet, now, still)
    let_go(run)
    gx, gy = _unstretched(feet, k, fx, fy)
    gx, gy = _unstretched(feet, k, gx, gy)
    size = math.sqrt(gx * gx + gy * gy)
    if size == 0.0:
        return v
    return without_velocity(feet, k, still, speed * gx / size, speed * gy / size)


@compiled
def contact_load(run: Run, now: Rate, v: Vector) -> Vector:
    """Return the load of the contacts on the moving part, pushes included, in body axes."""
    feet, freedom = run.feet, freedom_of(run)
    g, p = now.friction, feet.push
    load = p[0] - g[0], p[1] - g[1], p[2] - g[2]
    if freedom.pivot < 0:
        return load
    fx, fy = _needed(feet, now, v)
    return along(load, 1.0, (fx, fy, freedom.x * fy - freedom.y * fx))
