r"""Quasi-static motion of feet: :math:`\dot q = v(q, t)`, v the twist of the closest point.

In the metric :math:`D^{-1}` of the drag the twist is :math:`v = D^{-1}(F - F^*)` (``feet_hold``), a
Lipschitz function of load and angle. Integrated by the pair of order 5(4) of J. R. Dormand and
P. J. Prince, *A family of embedded Runge-Kutta formulae*, J. Comput. Appl. Math. 6, 1980. Where the
part comes to rest, steps are halved until the instant is found; it starts again at `exit_time`.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.feet_hold import closest, new_holder, set_quadratic, size_of
from limitsurf.kernels.feet_rates import new_feet
from limitsurf.kernels.feet_rest import exit_time, is_held
from limitsurf.kernels.feet_run import (
    BOUND,
    EVENTS,
    EXIT,
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
    record,
    set_twist,
    write_event,
)
from limitsurf.kernels.load_table import VARIES, Load, load_at, turned
from limitsurf.kernels.vectors import Vector, along, dot

__all__ = ["feet_creep"]

_TIMES = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_A = np.zeros((7, 6))
_A[1, 0] = 1 / 5
_A[2, :2] = 3 / 40, 9 / 40
_A[3, :3] = 44 / 45, -56 / 15, 32 / 9
_A[4, :4] = 19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729
_A[5, :5] = 9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656
_A[6] = 35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84
_E = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@compiled
def _creep(run: Run, t: float, theta: float, out: Floats) -> Vector:
    """Fill twist in world axes and the powers of load, friction and drag; return the friction."""
    feet = run.feet
    F, _ = load_at(run.load, t)
    F = along(turned(F, theta), 1.0, feet.push)
    v, f, run.state[BOUND] = closest(run.holder, F)
    d = feet.drag
    out[0], out[1], out[2] = turned(v, -theta)
    out[3], out[4] = dot(F, v), -dot(f, v)
    out[5] = d[0] * v[0] * v[0] + d[1] * v[1] * v[1] + d[2] * v[2] * v[2]
    return along(f, 1.0, feet.push)


@compiled
def _still(row: Floats) -> bool:
    return bool(row[0] == 0.0 and row[1] == 0.0 and row[2] == 0.0)


@compiled
def _stages(run: Run, h: float) -> float:
    """Fill the stages of a step h; the first is known. Return the error of the pose."""
    state, K = run.state, run.room
    for i in range(1, 7):
        theta = state[TURN]
        for j in range(i):
            theta += h * _A[i, j] * K[j, 2]
        _creep(run, state[T] + _TIMES[i] * h, theta, K[i])
    x = y = turn = 0.0
    for i in range(7):
        x += h * _E[i] * K[i, 0]
        y += h * _E[i] * K[i, 1]
        turn += h * _E[i] * K[i, 2]
    return size_of(run.holder, (x, y, turn))


@compiled
def _move(run: Run, end: float, duration: float) -> None:
    """Take one step of a part that creeps."""
    state, K = run.state, run.room
    _creep(run, state[T], state[TURN], K[0])
    wanted = state[PROPOSED]
    while True:
        h = min(wanted, end - state[T])
        state[STEPS] += 1
        speed = max(state[SCALE], size_of(run.holder, (K[0, 0], K[0, 1], K[0, 2])))
        wrong = _stages(run, h) / (0.01 * duration * run.tol * max(speed, 1e-300))
        short = h <= 1e-10 * run.tol * duration or h <= 1e-15 * end
        if short or (wrong <= 1.0 and not _still(K[6])):
            break
        wanted = h * (max(0.2, 0.9 * wrong**-0.2) if wrong > 1.0 else 0.25)
    for i in range(6):
        state[X] += h * _A[6, i] * K[i, 0]
        state[Y] += h * _A[6, i] * K[i, 1]
        state[TURN] += h * _A[6, i] * K[i, 2]
        for k in range(3):
            state[WORK + k] += h * _A[6, i] * K[i, 3 + k]
    state[T] += h
    set_twist(state, turned((K[6, 0], K[6, 1], K[6, 2]), state[TURN]))
    state[SCALE], state[WORST] = speed, max(state[WORST], state[BOUND])
    state[PROPOSED] = max(h * min(5.0, 0.9 * max(wrong, 1e-6) ** -0.2), 0.0)
    if _still(K[6]):
        _come_to_rest(run)
        write_event(run, REST, -1)
        record(run, _load_now(run))


@compiled
def _load_now(run: Run) -> Vector:
    """Return the load of the contacts now, and set the twist."""
    out = np.empty(6)
    load = _creep(run, run.state[T], run.state[TURN], out)
    set_twist(run.state, turned((out[0], out[1], out[2]), run.state[TURN]))
    return load


@compiled
def _come_to_rest(run: Run) -> None:
    state, push = run.state, run.feet.push
    state[RESTING] = 1.0
    state[EXIT] = exit_time(run.holder, run.load, push, state[TURN], state[T])


@compiled
def feet_creep(
    places: Floats,
    body: Floats,
    load: Load,
    state: Floats,
    duration: float,
    frames: int,
    tol: float,
    most: int,
    rows: Floats,
    events: Floats,
) -> bool:
    """Move a part without inertia; return False if steps or events were used up.

    Parameters
    ----------
    places, body, load, state, duration, frames, tol, most, rows, events
        As in ``feet_events``.
    """
    holder = new_holder(places)
    set_quadratic(holder, body[2], body[4])
    room = np.empty((7, 6))
    run = Run(new_feet(places, body), places[2], holder, load, state, rows, events, tol, room)
    if is_held(holder, load, run.feet.push, state[TURN], state[T]):
        _come_to_rest(run)
    record(run, _load_now(run))
    for j in range(1, frames + 1):
        end = duration * j / frames
        while state[T] < end:
            if state[RESTING] == 0.0:
                _move(run, end, duration)
            elif state[EXIT] < end:
                state[T], state[RESTING] = state[EXIT], 0.0
                state[PROPOSED] = 1e-6 * duration
                write_event(run, START, -1)
                _leave(run, duration)
            elif load.kind == VARIES:
                state[T] = end
            else:
                return True
            if state[STEPS] > most or state[EVENTS] >= events.shape[0] - 1:
                return False
        record(run, _load_now(run))
    return True


@compiled
def _leave(run: Run, duration: float) -> None:
    """Pass the instant at which the load is no longer held, up to rounding."""
    state, s = run.state, 1e-14 * duration
    push = run.feet.push
    while is_held(run.holder, run.load, push, state[TURN], state[T] + s) and s < 1e-6 * duration:
        s *= 4.0
    state[T] += s
