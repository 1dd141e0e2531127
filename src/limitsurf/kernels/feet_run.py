"""The state of a motion on feet, its record, and what both engines do with them."""

from __future__ import annotations

from typing import NamedTuple

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.feet_hold import Holder
from limitsurf.kernels.feet_rates import Feet
from limitsurf.kernels.load_table import Load, turned
from limitsurf.kernels.vectors import Vector

__all__ = [
    "BOUND",
    "COLUMNS",
    "DRAG",
    "EVENTS",
    "EXIT",
    "FRICTION",
    "NUMERICAL",
    "PIVOT",
    "PIVOT_X",
    "PIVOT_Y",
    "PROPOSED",
    "REST",
    "RESTING",
    "ROWS",
    "SCALE",
    "SLIP",
    "START",
    "STATE",
    "STEPS",
    "STICK",
    "TURN",
    "WORK",
    "WORST",
    "Run",
    "T",
    "angle",
    "kinetic",
    "record",
    "set_twist",
    "twist",
    "write_event",
]

# numbers of the state; the twist is in body axes
T, X, Y, TURN, TWIST, WORK, FRICTION, DRAG, NUMERICAL = 0, 1, 2, 3, 4, 7, 8, 9, 10
BOUND, WORST, SCALE, PROPOSED, EXIT = 11, 12, 13, 14, 15
PIVOT, PIVOT_X, PIVOT_Y, RESTING, ROWS, EVENTS, STEPS, STATE = 16, 17, 18, 19, 20, 21, 22, 23

# columns of a row: time, pose, twist, load of the contacts, bound, work and the three losses
COLUMNS = 15

STICK, SLIP, START, REST = 0, 1, 2, 3


class Run(NamedTuple):
    """A motion: feet, all friction radii, what holds them, the load, state, and its record.

    `rows` (K, COLUMNS) and `events` (E, 3), time, kind and contact, are filled.
    """

    feet: Feet
    radii: Floats
    holder: Holder
    load: Load
    state: Floats
    rows: Floats
    events: Floats
    tol: float
    room: Floats


@compiled
def twist(state: Floats) -> Vector:
    """Return the twist in body axes."""
    return state[TWIST], state[TWIST + 1], state[TWIST + 2]


@compiled
def angle(state: Floats) -> float:
    """Return the angle."""
    return float(state[TURN])


@compiled
def set_twist(state: Floats, v: Vector) -> None:
    """Set the twist in body axes."""
    state[TWIST], state[TWIST + 1], state[TWIST + 2] = v


@compiled
def kinetic(feet: Feet, v: Vector) -> float:
    """Return the kinetic energy."""
    return 0.5 * (feet.mass * (v[0] * v[0] + v[1] * v[1]) + feet.inertia * v[2] * v[2])


@compiled
def record(run: Run, load: Vector) -> None:
    """Write a row of the state, in world axes, and the load of the contacts, in body axes."""
    state = run.state
    if state[ROWS] > 0 and run.rows[int(state[ROWS]) - 1, 0] == state[T]:
        state[ROWS] -= 1  # of two rows at an instant the later one stays
    row = run.rows[int(state[ROWS])]
    row[:4] = state[:4]
    row[4], row[5], row[6] = turned(twist(state), -state[TURN])
    row[7], row[8], row[9] = turned(load, -state[TURN])
    row[10] = state[BOUND]
    row[11:15] = state[WORK : WORK + 4]
    state[ROWS] += 1


@compiled
def write_event(run: Run, kind: int, contact: int) -> None:
    """Write an event now."""
    event = run.events[int(run.state[EVENTS])]
    event[0], event[1], event[2] = run.state[T], kind, contact
    run.state[EVENTS] += 1
