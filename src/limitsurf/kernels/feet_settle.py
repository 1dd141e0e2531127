r"""What can happen to feet: a contact stops and sticks, the part rests, and starts again.

A contact that stops does so with a direction that settles while its speed falls to zero, in a time
of :math:`|u|^2 / (-u \cdot \dot u)`. When that is negligible, it sticks if the force that holds it
lies within its friction, or passes; the part rests when all contacts stop together.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.contact_pass import Contacts, contact_velocity
from limitsurf.kernels.feet_hold import size_of
from limitsurf.kernels.feet_rates import Rate, rate
from limitsurf.kernels.feet_rest import exit_time, is_held, start_moving
from limitsurf.kernels.feet_run import (
    BOUND,
    EXIT,
    FRICTION,
    PIVOT,
    PROPOSED,
    REST,
    RESTING,
    SCALE,
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
    freedom_of,
    let_go,
    nudged,
    place_about_pivot,
    stick,
)
from limitsurf.kernels.load_table import Load, load_at, piece_of, turned
from limitsurf.kernels.vectors import Vector, along, scaled

__all__ = [
    "APPROACH",
    "CHANGED",
    "GO_ON",
    "SHARE",
    "find_pivot",
    "happened",
    "length_of_piece",
    "load_now",
    "settle",
    "start",
    "time_left",
]

GO_ON, CHANGED, APPROACH = 0, 1, 2
SHARE = 0.9  # of the time that the next contact has left
_TOGETHER = 1e-3  # of the speed left when a contact stops: the others stop with it
_MANY = 100.0  # speeds of that many tolerances are small beside those of other contacts


@compiled
def load_now(run: Run) -> Vector:
    """Return the load of the contacts on the part now, in body axes."""
    state, v = run.state, twist(run.state)
    if state[RESTING] != 0.0:
        F, _ = load_at(run.load, state[T])
        return scaled(-1.0, turned(F, state[TURN]))
    now = rate(run.feet, freedom_of(run), run.load, state[T], v, state[TURN])
    return contact_load(run, now, v)


@compiled
def happened(run: Run, kind: int, contact: int) -> None:
    """Write an event and a row."""
    write_event(run, kind, contact)
    record(run, load_now(run))


@compiled
def time_left(run: Run, v: Vector, change: Vector) -> tuple[float, int, float, float]:
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
        if m[i] > 0.0 and (fall > 0.0 or square <= small * small):
            time = square / fall if fall > 0.0 else 0.0
            negligible = small * feet.mass / (2.0 * m[i] * feet.arm)
            if fall > 0.0:
                longest = min(longest, max(SHARE * time, negligible))
            soon = time <= negligible
            if (soon or square <= small * small) and square < slowest:
                first, left, slowest = i, time if soon else 0.0, square
    ratio = feet.inertia / feet.mass
    fall = -(v[0] * change[0] + v[1] * change[1] + ratio * v[2] * change[2])
    whole = size_of(run.holder, v) ** 2 / fall if fall > 0.0 else np.inf
    return longest, first, left, whole


@compiled
def rest(run: Run, time: float) -> None:
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
        happened(run, REST, -1)
    else:
        start(run)


@compiled
def length_of_piece(load: Load, t: float) -> float:
    """Return the length of the piece of a load at a time: a time in which it changes."""
    i = piece_of(load, t)
    return float(load.pieces[i, 1] - load.pieces[i, 0])


@compiled
def start(run: Run) -> None:
    """Set a part that is not held in motion."""
    state, feet, load = run.state, run.feet, run.load
    speed = run.tol * state[SCALE]
    longest = 0.1 * length_of_piece(load, state[T])
    s, v = start_moving(run.holder, load, feet.push, state[TURN], state[T], speed, longest)
    state[RESTING] = state[BOUND] = 0.0
    path = turned(scaled(s / 3.0, v), -state[TURN])
    state[X] += path[0]
    state[Y] += path[1]
    state[TURN] += path[2]
    state[T] += s
    state[WORK] += kinetic(feet, v)  # what friction takes of it is as small
    set_twist(state, v)
    state[PROPOSED] = s
    find_pivot(run, v, 1e-4)


@compiled
def find_pivot(run: Run, v: Vector, share: float) -> None:
    """Make the slowest contact a pivot if it does not move beside the others and holds."""
    contacts, slowest, k = Contacts(run.feet.data, 1, None), np.inf, -1
    for i in range(run.radii.shape[0]):
        ux, uy = contact_velocity(contacts, i, v)
        if run.radii[i] > 0.0 and ux * ux + uy * uy < slowest:
            slowest, k = ux * ux + uy * uy, i
    if k >= 0 and slowest <= (share * size_of(run.holder, v)) ** 2:
        stick(run, k, v, True)


@compiled
def settle(run: Run, now: Rate, first: int, left: float, whole: float) -> int:
    """Let the part rest, or a contact stick, if it is time to; return what is to be done."""
    state, v = run.state, twist(run.state)
    speed, small = size_of(run.holder, v), run.tol * state[SCALE]
    change = size_of(run.holder, now.v)
    if speed <= small and whole * change <= 4.0 * speed:
        rest(run, whole)
        return CHANGED
    if first < 0 or state[PIVOT] >= 0.0:
        return GO_ON
    together = size_of(run.holder, along(v, left, now.v))
    if together <= max(_TOGETHER * speed, _MANY * small):
        return GO_ON
    ux, uy = contact_velocity(Contacts(run.feet.data, 1, None), first, v)
    slow = math.sqrt(ux * ux + uy * uy)
    if slow > 4.0 * small:  # a weak contact, with time left that is negligible if it passes
        return APPROACH if stick(run, first, v, False) else GO_ON
    left = left if left * change <= 4.0 * small else 0.0
    if stick(run, first, along(v, left, now.v), True):
        state[T] += left
        happened(run, STICK, first)
        return CHANGED
    if slow <= 1e-6 * small:
        set_twist(state, nudged(run, first, v, 1e-3 * small))
        return CHANGED
    return GO_ON
