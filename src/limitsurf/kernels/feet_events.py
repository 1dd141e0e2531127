r"""A part that slides, turns about a stuck contact, and rests: from event to event.

While all contacts slide, or all but those at one place, the motion is smooth, and `rosenbrock_step`
follows it with local errors below the tolerance, in steps of at most a share of the time that the
next contact has left. ``feet_settle`` says what happens when that is over. A pivot lets go where
the force at it leaves its friction, found by repeating the step with another length; a resting
part sets off as ``feet_rest`` says.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Contacts, contact_velocity
from limitsurf.kernels.feet_accept import accept
from limitsurf.kernels.feet_hold import closest, new_holder, set_quadratic, size_of
from limitsurf.kernels.feet_rates import Freedom, Rate, new_feet, rate
from limitsurf.kernels.feet_rest import exit_time
from limitsurf.kernels.feet_rosenbrock import rosenbrock_step
from limitsurf.kernels.feet_run import (
    BOUND,
    EVENTS,
    EXIT,
    PROPOSED,
    RESTING,
    SCALE,
    SLIP,
    START,
    STEPS,
    TURN,
    Run,
    T,
    record,
    set_twist,
    twist,
)
from limitsurf.kernels.feet_settle import (
    APPROACH,
    CHANGED,
    SHARE,
    find_pivot,
    happened,
    length_of_piece,
    load_now,
    settle,
    start,
    time_left,
)
from limitsurf.kernels.feet_stick import effort, freedom_of, nudged
from limitsurf.kernels.load_table import VARIES, Load, load_at, turned
from limitsurf.kernels.vectors import Vector, along

__all__ = ["feet_events"]

_GROWTH, _HALVED = 16.0, 8.0  # of the square of a speed; an error that halves the step
_LEAST = 1e-15  # of the time: no step is shorter


@compiled
def _try(run: Run, freedom: Freedom, now: Rate, h: float) -> tuple[Vector, float, float, float]:
    """Return twist, angle, error over tolerance, and effort of the pivot after a step h."""
    state, v = run.state, twist(run.state)
    v1, angle1, error = rosenbrock_step(
        run.feet, freedom, run.load, state[T], v, state[TURN], now, h, run.room
    )
    wrong = size_of(run.holder, error) / (run.tol * state[SCALE])
    if freedom.pivot < 0:
        return v1, angle1, wrong, 0.0
    v1 = v1[2] * freedom.y, -v1[2] * freedom.x, v1[2]
    end = rate(run.feet, freedom, run.load, state[T] + h, v1, angle1)
    return v1, angle1, wrong, effort(run, freedom.pivot, end, v1)


@compiled
def _slip(run: Run, freedom: Freedom, now: Rate, high: float, excess: float) -> None:
    """Step to the instant at which the pivot lets go, and let it slide."""
    low, below = 0.0, effort(run, freedom.pivot, now, twist(run.state)) - 1.0
    state, h = run.state, high
    v1, angle1 = twist(state), state[TURN]
    for k in range(60):
        share = below / (below - excess) if k % 3 < 2 and below < 0.0 else 0.5
        h = low + min(max(share, 1e-3), 0.999) * (high - low)
        v1, angle1, _, e = _try(run, freedom, now, h)
        if e - 1.0 > 0.0:
            high, excess = h, e - 1.0
        else:
            low, below = h, e - 1.0
        if high - low <= 1e-14 * state[T] or abs(e - 1.0) < 1e-13:
            break
    v1, angle1, _, _ = _try(run, freedom, now, high)
    accept(run, freedom, now, high, v1, angle1)
    set_twist(state, nudged(run, freedom.pivot, v1, 1e-3 * run.tol * state[SCALE]))
    state[PROPOSED] = 1e-3 * high + 1e-6 * run.tol
    happened(run, SLIP, freedom.pivot)


@compiled
def _outgrown(run: Run, v0: Vector, v1: Vector, change: float, h: float) -> bool:
    """Return whether a slow contact became several times as fast within a step.

    The stiffness of the step was that of its beginning: it holds back even a weak contact with
    any force, and hides the error.
    """
    feet, contacts = run.feet, Contacts(run.feet.data, 1, None)
    m, least = feet.data[2], 0.5 * run.tol * run.state[SCALE]
    if change * h <= least:
        return False
    for i in range(m.shape[0]):
        ux, uy = contact_velocity(contacts, i, v0)
        wx, wy = contact_velocity(contacts, i, v1)
        before, after = ux * ux + uy * uy, wx * wx + wy * wy
        if m[i] > 0.0 and after > _GROWTH * max(before, least * least):
            return True
    return False


@compiled
def _move(run: Run, end: float) -> None:
    """Take one step of a moving part, or let a contact stick."""
    state, v, freedom = run.state, twist(run.state), freedom_of(run)
    now = rate(run.feet, freedom, run.load, state[T], v, state[TURN])
    longest, first, left, whole = time_left(run, v, now.v)
    what = settle(run, now, first, left, whole)
    if what == CHANGED:
        return
    if what == APPROACH:
        longest = min(longest, SHARE * left)
    change = size_of(run.holder, now.v)
    if whole < np.inf and change > 0.0:
        longest = min(longest, max(SHARE * whole, 0.1 * run.tol * state[SCALE] / change))
    if freedom.pivot >= 0 and run.load.kind == VARIES:
        longest = min(longest, 0.1 * length_of_piece(run.load, state[T]))
    wanted = state[PROPOSED]
    h = min(wanted, longest, end - state[T])
    while True:
        state[STEPS] += 1
        v1, angle1, wrong, e = _try(run, freedom, now, h)
        if h <= _LEAST * state[T]:
            break
        if wrong <= 1.0 and not _outgrown(run, v, v1, change, h):
            break
        wrong = max(wrong, _HALVED)
        h *= max(0.1, 0.85 * wrong**-0.25) if wrong < np.inf else 0.1
        wanted = h
    if e > 1.0:
        _slip(run, freedom, now, h, e - 1.0)
        return
    accept(run, freedom, now, h, v1, angle1)
    grown = h * min(5.0, 0.85 * max(wrong, 1e-8) ** -0.25)
    state[PROPOSED] = max(grown, wanted) if h < wanted else grown


@compiled
def _begin(run: Run) -> None:
    """Find out whether the part rests at first, or turns about a contact."""
    state, v, push = run.state, twist(run.state), run.feet.push
    if v[0] != 0.0 or v[1] != 0.0 or v[2] != 0.0:
        find_pivot(run, v, 1e-12)
        record(run, load_now(run))
        return
    F, _ = load_at(run.load, state[T])
    free, held, state[BOUND] = closest(run.holder, along(turned(F, state[TURN]), 1.0, push))
    record(run, along(held, 1.0, push))
    if free[0] == 0.0 and free[1] == 0.0 and free[2] == 0.0:
        state[RESTING] = 1.0
        state[EXIT] = exit_time(run.holder, run.load, push, state[TURN], state[T])
    else:
        start(run)


@compiled
def _start_again(run: Run) -> None:
    """Set a part that rested in motion, and say so."""
    happened(run, START, -1)
    start(run)


@compiled
def _to_the_end(run: Run, duration: float, frames: int, most: int) -> bool:
    """Move the part; return False if steps or events were used up."""
    state = run.state
    _begin(run)
    for j in range(1, frames + 1):
        end = duration * j / frames
        while state[T] < end:
            if state[RESTING] == 0.0:
                _move(run, end)
            elif state[EXIT] < end:
                state[T] = state[EXIT]
                _start_again(run)
            elif run.load.kind == VARIES:
                state[T] = end
            else:
                return True
            if state[STEPS] > most or state[EVENTS] >= run.events.shape[0] - 1:
                return False
        record(run, load_now(run))
    return True


@compiled
def feet_events(
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
    """Move a part from event to event; return False if steps or events were used up.

    Parameters
    ----------
    places : (3, N) or (6, N) float
        Contacts from the centre of mass in body axes: x, y, m, and xx, xy, yy of S.
    body : (8,) float
        Mass, inertia, drag (3), load of the pushes (3).
    load : Load
        The external load, world axes.
    state : (STATE,) float
        Time, pose, twist in body axes, and what follows; overwritten with the end.
    duration, frames : float, int
        When to end [s], and the number of rows at equal distances in time before; others are
        written at events.
    tol : float
        Local errors of a step, relative to the largest speed.
    most : int
        Number of steps allowed.
    rows, events : (K, COLUMNS), (E, 3) float
        The record.
    """
    holder = new_holder(places)
    set_quadratic(holder, body[0], body[1])
    feet = new_feet(places, body)
    room = np.empty((6, 4))
    run = Run(feet, places[2].copy(), holder, load, state, rows, events, tol, room)
    return _to_the_end(run, duration, frames, most)
