r"""A part that slides, turns about a stuck contact, and rests: from event to event.

While all contacts slide, or all but those at one place, the motion is smooth, and `rosenbrock_step`
follows it with local errors below the tolerance. A contact that stops does so with a direction
that settles while its speed falls to zero: steps are at most a share of the time that it has left,
until that is negligible. Then it sticks, or passes; with all others, the part rests. A pivot lets
go where the force at it leaves its friction, found by repeating the step with another length; a
resting part sets off as `exit_time` and `start_moving` say. A quantity that does not act back on
the motion, p with rate :math:`\dot p`, is integrated by the corrected trapezoidal rule
:math:`\tfrac h2 (p_0 + p_1) + \tfrac{h^2}{12} (\dot p_0 - \dot p_1)`.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Contacts, contact_velocity
from limitsurf.kernels.feet_hold import closest, new_holder, set_quadratic, size_of
from limitsurf.kernels.feet_rates import Feet, Freedom, Rate, new_feet, rate
from limitsurf.kernels.feet_rest import exit_time, is_held, start_moving
from limitsurf.kernels.feet_rosenbrock import rosenbrock_step
from limitsurf.kernels.feet_run import (
    BOUND,
    EVENTS,
    EXIT,
    FRICTION,
    PIVOT,
    PROPOSED,
    REST,
    RESTING,
    SCALE,
    SLIP,
    START,
    STEPS,
    STICK,
    TURN,
    WORK,
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
from limitsurf.kernels.feet_stick import (
    contact_load,
    effort,
    freedom_of,
    let_go,
    nudged,
    place_about_pivot,
    stick,
)
from limitsurf.kernels.load_table import VARIES, Load, load_at, piece_of, turned
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = ["feet_events"]

_SHARE = 0.9  # of the time that the next contact has left
_TOGETHER = 1e-3  # of the speed left when a contact stops: the others stop with it
_LEAST = 1e-15


@compiled
def _load_now(run: Run) -> Vector:
    """Return the load of the contacts on the part now, in body axes."""
    state, v = run.state, twist(run.state)
    if state[RESTING] != 0.0:
        F, _ = load_at(run.load, state[T])
        return scaled(-1.0, turned(F, state[TURN]))
    now = rate(run.feet, freedom_of(run), run.load, state[T], v, state[TURN])
    return contact_load(run, now, v)


@compiled
def _happened(run: Run, kind: int, contact: int) -> None:
    """Write an event and a row."""
    write_event(run, kind, contact)
    record(run, _load_now(run))


@compiled
def _time_left(run: Run, v: Vector, change: Vector) -> tuple[float, int, float, float]:
    """Return the longest step, and the contact that stops first, if it does within it.

    Also return the time that this contact and that the part as a whole has left. A contact may be
    stepped over where the jump of its force changes the twist by less than the tolerance.
    """
    feet, contacts = run.feet, Contacts(run.feet.data, 1, None)
    small = run.tol * run.state[SCALE]
    longest, first, left, slowest = np.inf, -1, np.inf, np.inf
    m = feet.data[2]
    for i in range(m.shape[0]):
        ux, uy = contact_velocity(contacts, i, v)
        dx, dy = contact_velocity(contacts, i, change)
        square, fall = ux * ux + uy * uy, -(ux * dx + uy * dy)
        if m[i] > 0.0 and (fall > 0.0 or square == 0.0):
            time = square / fall if fall > 0.0 else 0.0
            negligible = small * feet.mass / (2.0 * m[i] * feet.arm)
            longest = min(longest, max(_SHARE * time, negligible))
            if time <= negligible and square < slowest:
                first, left, slowest = i, time, square
    ratio = feet.inertia / feet.mass
    fall = -(v[0] * change[0] + v[1] * change[1] + ratio * v[2] * change[2])
    whole = size_of(run.holder, v) ** 2 / fall if fall > 0.0 else np.inf
    return longest, first, left, whole


@compiled
def _rest(run: Run, time: float) -> None:
    """Bring the part to rest after a time that is negligible, or start it anew."""
    state, v, feet = run.state, twist(run.state), run.feet
    path = turned(scaled(0.5 * time, v), -state[TURN])
    if state[PIVOT] < 0.0:
        state[X] += path[0]
        state[Y] += path[1]
        state[TURN] += path[2]
    else:
        state[TURN] += path[2]
        place_about_pivot(run, freedom_of(run))
    state[T] += time
    state[FRICTION] += kinetic(feet, v)
    let_go(run)
    set_twist(state, (0.0, 0.0, 0.0))
    if is_held(run.holder, run.load, feet.push, state[TURN], state[T]):
        state[RESTING] = 1.0
        state[EXIT] = exit_time(run.holder, run.load, feet.push, state[TURN], state[T])
        _happened(run, REST, -1)
    else:
        _start(run)


@compiled
def _length_of_piece(load: Load, t: float) -> float:
    """Return the length of the piece of a load at a time: a time in which it changes."""
    i = piece_of(load, t)
    return float(load.pieces[i, 1] - load.pieces[i, 0])


@compiled
def _start(run: Run) -> None:
    """Set a part that is not held in motion."""
    state, feet, load = run.state, run.feet, run.load
    speed = run.tol * state[SCALE]
    longest = 0.1 * _length_of_piece(load, state[T])
    s, v = start_moving(run.holder, load, feet.push, state[TURN], state[T], speed, longest)
    state[RESTING] = 0.0
    path = turned(scaled(s / 3.0, v), -state[TURN])
    state[X] += path[0]
    state[Y] += path[1]
    state[TURN] += path[2]
    state[T] += s
    state[WORK] += kinetic(feet, v)  # what friction takes of it is as small
    set_twist(state, v)
    state[PROPOSED] = s
    _find_pivot(run, v, 1e-6)


@compiled
def _find_pivot(run: Run, v: Vector, share: float) -> None:
    """Make the slowest contact a pivot if it does not move beside the others and holds."""
    contacts, slowest, k = Contacts(run.feet.data, 1, None), np.inf, -1
    for i in range(run.radii.shape[0]):
        ux, uy = contact_velocity(contacts, i, v)
        if run.radii[i] > 0.0 and ux * ux + uy * uy < slowest:
            slowest, k = ux * ux + uy * uy, i
    if k >= 0 and slowest <= (share * size_of(run.holder, v)) ** 2:
        stick(run, k, v)


@compiled
def _settle(run: Run, now: Rate, first: int, left: float, whole: float) -> bool:
    """Let the part rest or a contact stick if it is time to; return whether the state changed."""
    state, v = run.state, twist(run.state)
    speed, small = size_of(run.holder, v), run.tol * state[SCALE]
    if speed <= small and whole < np.inf:
        change = size_of(run.holder, now.v)
        if whole * change <= 4.0 * speed:
            _rest(run, whole)
            return True
    if first < 0 or state[PIVOT] >= 0.0:
        return False
    after = along(v, left, now.v)
    if size_of(run.holder, after) <= max(_TOGETHER * speed, small):
        return False
    ux, uy = contact_velocity(Contacts(run.feet.data, 1, None), first, v)
    if stick(run, first, after):
        state[T] += left
        _happened(run, STICK, first)
        return True
    if math.sqrt(ux * ux + uy * uy) <= 1e-6 * small:
        set_twist(state, nudged(run, first, v, 1e-3 * small))
        return True
    return False


@compiled
def _shift(state_v: Vector, change: Vector, angle: float) -> tuple[Vector, Vector]:
    """Return velocity and acceleration of the centre of mass in world axes."""
    v, w = state_v, state_v[2]
    a = change[0] - w * v[1], change[1] + w * v[0], change[2]
    return turned(v, -angle), turned(a, -angle)


@compiled
def _rule(h: float, p0: float, p1: float, d0: float, d1: float) -> float:
    """Return the integral by the corrected trapezoidal rule."""
    return 0.5 * h * (p0 + p1) + h * h / 12.0 * (d0 - d1)


@compiled
def _powers(feet: Feet, now: Rate, v: Vector) -> tuple[Vector, Vector]:
    """Return the powers of loads, friction and drag, and their rates."""
    d = feet.drag
    dv = d[0] * v[0], d[1] * v[1], d[2] * v[2]
    rate_of_load = along(now.by_time, v[2], now.by_angle)
    return (
        (dot(now.load, v), dot(now.friction, v), dot(dv, v)),
        (
            dot(now.load, now.v) + dot(rate_of_load, v),
            dot(now.friction, now.v),
            2.0 * dot(dv, now.v),
        ),
    )


@compiled
def _accept(run: Run, freedom: Freedom, now: Rate, h: float, v1: Vector, angle1: float) -> None:
    """Take a step: place, energies, twist, time."""
    state, feet = run.state, run.feet
    v0, angle0 = twist(state), state[TURN]
    end = rate(feet, freedom, run.load, state[T] + h, v1, angle1)
    p0, d0 = _powers(feet, now, v0)
    p1, d1 = _powers(feet, end, v1)
    for k in range(3):
        state[WORK + k] += _rule(h, p0[k], p1[k], d0[k], d1[k])
    u0, a0 = _shift(v0, now.v, angle0)
    u1, a1 = _shift(v1, end.v, angle1)
    state[X] += _rule(h, u0[0], u1[0], a0[0], a1[0])
    state[Y] += _rule(h, u0[1], u1[1], a0[1], a1[1])
    state[TURN] = angle1
    if freedom.pivot >= 0:
        place_about_pivot(run, freedom)
    set_twist(state, v1)
    state[T] += h
    state[SCALE] = max(state[SCALE], size_of(run.holder, v1))


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
    _accept(run, freedom, now, high, v1, angle1)
    set_twist(state, nudged(run, freedom.pivot, v1, 1e-3 * run.tol * state[SCALE]))
    state[PROPOSED] = 1e-3 * high + 1e-6 * run.tol
    _happened(run, SLIP, freedom.pivot)


@compiled
def _move(run: Run, end: float) -> None:
    """Take one step of a moving part, or let a contact stick."""
    state, v, freedom = run.state, twist(run.state), freedom_of(run)
    now = rate(run.feet, freedom, run.load, state[T], v, state[TURN])
    longest, first, left, whole = _time_left(run, v, now.v)
    if _settle(run, now, first, left, whole):
        return
    change = size_of(run.holder, now.v)
    if whole < np.inf and change > 0.0:
        longest = min(longest, max(_SHARE * whole, 0.1 * run.tol * state[SCALE] / change))
    if freedom.pivot >= 0 and run.load.kind == VARIES:
        longest = min(longest, 0.1 * _length_of_piece(run.load, state[T]))
    wanted = state[PROPOSED]
    h = min(wanted, longest, end - state[T])
    while True:
        state[STEPS] += 1
        v1, angle1, wrong, e = _try(run, freedom, now, h)
        if wrong <= 1.0 or h <= _LEAST * state[T]:
            break
        h *= max(0.1, 0.85 * wrong**-0.25) if wrong < np.inf else 0.1
        wanted = h
    if e > 1.0:
        _slip(run, freedom, now, h, e - 1.0)
        return
    _accept(run, freedom, now, h, v1, angle1)
    grown = h * min(5.0, 0.85 * max(wrong, 1e-8) ** -0.25)
    state[PROPOSED] = max(grown, wanted) if h < wanted else grown


@compiled
def _begin(run: Run) -> None:
    """Find out whether the part rests at first, or turns about a contact."""
    state, v, push = run.state, twist(run.state), run.feet.push
    if v[0] != 0.0 or v[1] != 0.0 or v[2] != 0.0:
        _find_pivot(run, v, 1e-12)
        record(run, _load_now(run))
        return
    F, _ = load_at(run.load, state[T])
    free, held, state[BOUND] = closest(run.holder, along(turned(F, state[TURN]), 1.0, push))
    record(run, along(held, 1.0, push))
    if free[0] == 0.0 and free[1] == 0.0 and free[2] == 0.0:
        state[RESTING] = 1.0
        state[EXIT] = exit_time(run.holder, run.load, push, state[TURN], state[T])
    else:
        _start(run)


@compiled
def _start_again(run: Run) -> None:
    """Set a part that rested in motion, and say so."""
    write_event(run, START, -1)
    _start(run)
    record(run, _load_now(run))


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
        record(run, _load_now(run))
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
