"""Motion of a part on contacts that are fixed to it: plates on supports, carts on wheels."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.feet_events import feet_events
from limitsurf.kernels.feet_run import (
    COLUMNS,
    EVENTS,
    PROPOSED,
    RESTING,
    ROWS,
    SCALE,
    STATE,
    WORST,
)
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.trajectory import EnergyBalance, EventKind, MotionEvent, Outcome, Trajectory
from limitsurf.sets.arguments import as_array
from limitsurf.sets.contact_sum import ContactSum

__all__ = ["feet_motion"]

Array = NDArray[np.float64]

_KINDS = (EventKind.STICK, EventKind.SLIP, EventKind.START, EventKind.REST)
_EVENTS = 2000
_STEPS = 10_000_000


def feet_motion(
    part: Part,
    contacts: ContactSet,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    duration: float = 1.0,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    load: LoadLike = None,
    drag: ArrayLike | None = None,
    mode: Literal["inertial", "quasi-static"] = "inertial",
    method: Literal["steps", "events"] = "events",
    time_step: float | None = None,
    tolerance: float | None = None,
    frames: int = 200,
) -> Trajectory:
    position = as_array("pose", pose, 3)
    speed = as_array("twist", twist, 3)
    table = LoadTable.of(load, duration)
    viscous = np.zeros(3) if drag is None else as_array("drag", drag, 3)
    places = _places(contacts)
    body = np.concatenate([[part.mass, part.inertia], viscous, contacts.offset_load])
    state = np.zeros(STATE)
    state[1:4] = position
    cos, sin = np.cos(position[2]), np.sin(position[2])
    state[4] = cos * speed[0] + sin * speed[1]
    state[5] = cos * speed[1] - sin * speed[0]
    state[6] = speed[2]
    m, J = part.mass, part.inertia
    rho = np.sqrt(J / m)
    force = contacts.radius.sum() + np.hypot(*table.largest[:2]) + np.hypot(*contacts.offset_load[:2])
    force += (table.largest[2] + abs(contacts.offset_load[2])) / rho
    span = table.shortest
    scale = np.sqrt(speed[0] ** 2 + speed[1] ** 2 + rho**2 * speed[2] ** 2)
    if scale == 0.0:
        scale = 1e-3 * force / m * min(span, duration)
    state[SCALE] = scale
    state[PROPOSED] = 1e-3 * min(duration, scale / (force / m) if force else duration)
    state[16] = -1.0
    tol = 1e-8 if tolerance is None else tolerance
    rows = np.empty((frames + _EVENTS + 4, COLUMNS))
    events = np.empty((_EVENTS, 3))
    done = feet_events(places, body, table.kernel, state, duration, frames, tol, _STEPS, rows, events)
    global last_state
    last_state = state
    if not done:
        raise SolveFailed("feet_motion: too many steps or events")
    return _trajectory(rows[: int(state[ROWS])], events[: int(state[EVENTS])], state, body, len(contacts))


def _places(contacts: ContactSet) -> Array:
    surface = contacts.limit_surface()
    if not isinstance(surface, ContactSum):
        raise InputError("contacts", "are polygons", remedy="leave out sides")
    rows = [contacts.position.T, contacts.radius[None]]
    if surface.stretch is not None:
        rows.append(surface.stretch.T)
    return np.ascontiguousarray(np.concatenate(rows))


def _trajectory(rows: Array, events: Array, state: Array, body: Array, n: int) -> Trajectory:
    twists = rows[:, 4:7]
    kinetic = 0.5 * (twists * twists) @ np.array([body[0], body[0], body[1]])
    return Trajectory(
        times=rows[:, 0].copy(),
        poses=rows[:, 1:4].copy(),
        twists=twists.copy(),
        loads=rows[:, 7:10].copy(),
        error_bounds=rows[:, 10].copy(),
        tips=np.full(len(rows), n),
        outcome=Outcome.REST if state[RESTING] else Outcome.TIME_LIMIT,
        worst_error=float(state[WORST]),
        energy=EnergyBalance(kinetic, *rows[:, 11:15].T.copy()),
        events=tuple(
            MotionEvent(t, _KINDS[int(kind)], () if where < 0 else (int(where),))
            for t, kind, where in events.tolist()
        ),
    )
