r"""Implicit steps of a part on feet, in its own axes, of fixed or controlled length.

With the angle and the contacts of the beginning and the load F of the end of a step,

.. math:: v = \arg\min_v\; \tfrac12 (v-v_0)^T M (v-v_0)
        + \Delta t \left( h_L(-v) + \tfrac12 v^T D v - F \cdot v \right),

the closest-point problem of ``feet_hold`` with :math:`Q = M/\Delta t + D` and the load
:math:`F + M v_0/\Delta t`; the momentum keeps its direction in the world. M = 0 is quasi-static
motion. Of controlled steps, each is taken whole and in two halves, which stay: it is halved until
the two agree to the tolerance, and doubled when they agree to a quarter of it.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.feet_hold import Holder, closest, new_holder, set_quadratic, size_of
from limitsurf.kernels.feet_rates import Feet, new_feet
from limitsurf.kernels.feet_run import (
    BOUND,
    DRAG,
    EVENTS,
    FRICTION,
    NUMERICAL,
    PROPOSED,
    REST,
    RESTING,
    SCALE,
    START,
    STEPS,
    TURN,
    WORK,
    WORST,
    Run,
    T,
    X,
    Y,
    kinetic,
    record,
    set_twist,
    twist,
    write_event,
)
from limitsurf.kernels.load_table import VARIES, Load, load_at, turned
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = ["feet_steps"]


@compiled
def _set_step(holder: Holder, feet: Feet, inertial: float, dt: float) -> None:
    """Set Q for a time step."""
    first = inertial * feet.mass / dt + feet.drag[0]
    set_quadratic(holder, first, inertial * feet.inertia / dt + feet.drag[2])


@compiled
def _step(run: Run, holder: Holder, inertial: float, dt: float) -> Vector:
    """Take one step; return the load of the contacts, in the body axes of the end."""
    state, feet = run.state, run.feet
    theta, v0 = state[TURN], scaled(inertial, twist(state))
    F, _ = load_at(run.load, state[T] + dt)
    F = along(turned(F, theta), 1.0, feet.push)
    p = feet.mass / dt * v0[0], feet.mass / dt * v0[1], feet.inertia / dt * v0[2]
    v, f, bound = closest(holder, along(F, 1.0, p))
    world, d = turned(v, -theta), feet.drag
    state[X] += dt * world[0]
    state[Y] += dt * world[1]
    state[TURN] += dt * world[2]
    state[T] += dt
    set_twist(state, turned(world, state[TURN]))
    state[WORK] += dt * dot(F, v)
    state[FRICTION] -= dt * dot(f, v)
    state[DRAG] += dt * (d[0] * v[0] * v[0] + d[1] * v[1] * v[1] + d[2] * v[2] * v[2])
    state[NUMERICAL] += inertial * kinetic(feet, along(v, -1.0, v0))
    state[BOUND] = bound
    state[WORST] = max(state[WORST], bound)
    state[STEPS] += 1.0
    resting = v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0
    if resting != (state[RESTING] != 0.0):
        state[RESTING] = 1.0 if resting else 0.0
        write_event(run, REST if resting else START, -1)
    return turned(turned(along(f, 1.0, feet.push), -theta), state[TURN])


@compiled
def _differ(run: Run, one: Floats, two: Floats) -> float:
    """Return how far the ends of a step and of its halves are apart, over the tolerance."""
    v1, v2 = turned(twist(one), -one[TURN]), turned(twist(two), -two[TURN])
    far = size_of(run.holder, along(v2, -1.0, v1))
    scale = max(two[SCALE], size_of(run.holder, v2))
    moved = size_of(run.holder, (two[X] - one[X], two[Y] - one[Y], two[TURN] - one[TURN]))
    elapsed = two[T] if two[T] > 0.0 else 1.0
    return max(far, moved / elapsed) / (run.tol * scale) if scale > 0.0 else 0.0


@compiled
def _copy(source: Floats, target: Floats) -> None:
    for k in range(source.shape[0]):
        target[k] = source[k]


@compiled
def _controlled(run: Run, half: Holder, inertial: float, end: float, spare: Floats) -> Vector:
    """Take one step of controlled length up to a time at most; return the load of the contacts."""
    state, before, one = run.state, spare[0], spare[1]
    _copy(state, before)
    wanted = state[PROPOSED]
    while True:
        dt = min(wanted, end - state[T])
        last = dt == end - state[T]
        _set_step(run.holder, run.feet, inertial, dt)
        _set_step(half, run.feet, inertial, 0.5 * dt)
        _step(run, run.holder, inertial, dt)
        _copy(state, one)
        _copy(before, state)
        _step(run, half, inertial, 0.5 * dt)
        load = _step(run, half, inertial, 0.5 * dt)
        wrong = _differ(run, one, state)
        if wrong <= 1.0 or dt <= 1e-12 * end:
            break
        _copy(before, state)
        wanted = 0.5 * dt
    if last:
        state[T] = end
    state[SCALE] = max(state[SCALE], size_of(run.holder, twist(state)))
    state[PROPOSED] = 2.0 * wanted if wrong <= 0.25 and not last else wanted
    return load


@compiled
def feet_steps(
    places: Floats,
    body: Floats,
    load: Load,
    state: Floats,
    duration: float,
    frames: int,
    tol: float,
    steps: int,
    most: int,
    inertial: float,
    rows: Floats,
    events: Floats,
) -> bool:
    """Move a part by implicit steps; return False if steps or events were used up.

    Parameters
    ----------
    places, body, load, state, duration, frames, rows, events
        As in ``feet_events``.
    tol : float
        Tolerance of controlled steps, relative to the largest speed.
    steps : int
        Number of equal steps between two frames, or 0 for controlled ones.
    most : int
        Number of steps allowed.
    inertial : float
        1, or 0 for quasi-static motion.
    """
    holder, half = new_holder(places), new_holder(places)
    run = Run(
        new_feet(places, body), places[2], holder, load, state, rows, events, tol, np.empty((0, 0))
    )
    spare = np.empty((2, state.shape[0]))
    v = twist(state)
    state[RESTING] = 1.0 if v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0 else 0.0
    record(run, scaled(0.0, v))
    dt = duration / (frames * max(steps, 1))
    _set_step(holder, run.feet, inertial, dt)
    for j in range(frames):
        forces, k = scaled(0.0, v), 0
        end = duration * (j + 1) / frames
        while state[T] < end if steps == 0 else k < steps:
            if steps > 0:
                forces = _step(run, holder, inertial, dt)
                state[T] = (j * steps + k + 1) * dt
            else:
                forces = _controlled(run, half, inertial, end, spare)
            k += 1
            over = state[RESTING] != 0.0 and load.kind != VARIES
            if over or state[STEPS] > most or state[EVENTS] >= events.shape[0] - 2:
                record(run, forces)
                return over
        record(run, forces)
    return True
