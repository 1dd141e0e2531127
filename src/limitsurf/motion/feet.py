"""Motion of a part on contacts that are fixed to it: plates on supports, carts on wheels."""

from __future__ import annotations

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.feet_creep import feet_creep
from limitsurf.kernels.feet_events import feet_events
from limitsurf.kernels.feet_run import (
    COLUMNS,
    EVENTS,
    PIVOT,
    PROPOSED,
    RESTING,
    ROWS,
    SCALE,
    STATE,
    WORST,
)
from limitsurf.kernels.feet_steps import feet_steps
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.options import Method, Mode, check_choice
from limitsurf.motion.trajectory import EnergyBalance, EventKind, MotionEvent, Outcome, Trajectory
from limitsurf.sets.arguments import as_array, as_count, as_number, as_positive
from limitsurf.sets.contact_sum import ContactSum

__all__ = ["feet_motion"]

Array = NDArray[np.float64]

_KINDS = (EventKind.STICK, EventKind.SLIP, EventKind.START, EventKind.REST)
_EVENTS, _STEPS = 20_000, 20_000_000
_TOLERANCE = {"events": 1e-8, "steps": 1e-4}
_FLAT = 1e-6  # ratio of the axes of an ellipse below which it is a segment


def feet_motion(
    part: Part,
    contacts: ContactSet,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    duration: float = 1.0,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    load: LoadLike = None,
    drag: ArrayLike | None = None,
    mode: Mode = "inertial",
    method: Method = "events",
    time_step: float | None = None,
    tolerance: float | None = None,
    frames: int = 200,
) -> Trajectory:
    r"""Move a part that slides on contacts fixed to it.

    .. math:: M \dot v = F(t) + P - D v - \partial h(v), \qquad h(v) = \sum_i m_i |S_i u_i|

    with the pushes P of the contacts turning with the part. Exact stick: a part whose load is held
    has twist zero and keeps its pose bit for bit.

    Parameters
    ----------
    part : Part
        The part, with areal density.
    contacts : ContactSet
        Disks or ellipses, from the centre of mass in the part's own axes.
    pose, twist : (3,) float
        Start of the centre of mass [m, m, rad], [m/s, m/s, rad/s]; quasi-static motion has no
        initial twist.
    duration : float
        Time limit [s]. A part that rests under a constant load ends earlier.
    load : (3,) float, callable ``t -> (3,)``, LoadTable, or None
        External load about the centre of mass, world axes [N, N, N m]; smooth in time.
    drag : (3,) float, optional
        Viscous drag [kg/s, kg/s, kg m^2/s], the same along x and y; zero by default.
    mode : {"inertial", "quasi-static"}
        With the part's mass, or with drag alone.
    method : {"events", "steps"}
        "events" follows the smooth motion between located events, in which contacts stick and
        slip, and the part rests and starts, by Rosenbrock steps of order 4 (quasi-static motion:
        Runge-Kutta of order 5). "steps" takes implicit steps of first order, which dissipate a
        little and never drift.
    time_step : float, optional
        Of "steps" [s], rounded so that frames are met; without it steps are controlled.
    tolerance : float, optional
        Local errors of twists over the largest speed; 1e-8 for "events", 1e-4 for "steps".
        Loads that change are known to 1e-10.
    frames : int
        Frames at equal distances in time; "events" adds one at each event.

    Returns
    -------
    Trajectory

    Raises
    ------
    InputError
        Arguments that are not finite or not positive; polygonal contacts; quasi-static motion
        without drag; "events" with ellipses that are segments, such as wheels without bearing
        friction.
    SolveFailed
        Steps or events were used up: 2e7 and 2e4.

    Notes
    -----
    Speeds of twists are measured by :math:`|v|^2 = v_x^2 + v_y^2 + \omega^2 J/m`. Contacts that
    stick at two places hold the part; so at most one place sticks while the part moves. Contacts
    within 1e-7 radii of gyration of each other are at one place.

    Examples
    --------
    A block of 1 kg on four feet slides for ``v^2 / (2 mu g)``:

    >>> block = Part([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)], 100.0)
    >>> feet = ContactSet([[1, 1], [-1, 1], [-1, -1], [1, -1]], 0.25)
    >>> path = feet_motion(block, feet, duration=5.0, twist=[2.0, 0.0, 0.0])
    >>> path.final_pose.round(7), str(path.events[0])
    (array([2., 0., 0.]), '2 s: the part rests')
    """
    limit, count, tol = _checked(duration, frames, tolerance, mode, method)
    places, table = _places(contacts, mode, method), LoadTable.of(load, limit)
    body = _body(part, contacts, drag, mode)
    q, v = as_array("pose", pose, 3), as_array("twist", twist, 3)
    force = _force(contacts, table, body)
    state = _state(q, v, body, force, min(limit, table.shortest), mode)
    rows, events = np.empty((count + _EVENTS + 3, COLUMNS)), np.empty((_EVENTS, 3))
    common = places, body, table.kernel, state, limit, count, tol
    if method == "steps":
        steps = 0 if time_step is None else _steps(time_step, limit, count)
        inertial = 1.0 if mode == "inertial" else 0.0
        done = feet_steps(*common, steps, _STEPS, inertial, rows, events)
    else:
        if time_step is not None:
            raise InputError("time_step", "is for steps", remedy='say method="steps"')
        run = feet_events if mode == "inertial" else feet_creep
        done = run(*common, _STEPS, rows, events)
    path = _trajectory(rows, events, state, body, force, len(contacts), mode)
    if not done:
        raise SolveFailed(f"feet_motion: steps or events used up at {path.duration:g} s", best=path)
    return path


def _checked(
    duration: float, frames: int, tolerance: float | None, mode: str, method: str
) -> tuple[float, int, float]:
    """Return duration, frames and tolerance as numbers."""
    check_choice("mode", mode, get_args(Mode))
    check_choice("method", method, get_args(Method))
    limit, count = as_positive("duration", duration), as_count("frames", frames)
    tol = as_number("tolerance", _TOLERANCE[method] if tolerance is None else tolerance)
    if not 1e-14 <= tol < 1.0:
        raise InputError("tolerance", "must lie between 1e-14 and 1", value=tolerance)
    return limit, count, tol


def _places(contacts: ContactSet, mode: str, method: str) -> Array:
    """Return rows x, y, m, and for ellipses xx, xy, yy of S."""
    surface = contacts.limit_surface()
    if not isinstance(surface, ContactSum):
        raise InputError("contacts", "are polygons", remedy="leave out sides")
    rows = [contacts.position.T, contacts.radius[None]]
    if surface.stretch is not None:
        a, b, d = surface.stretch.T
        flat = a * d - b * b <= _FLAT * (0.5 * (a + d)) ** 2
        if mode == "inertial" and method == "events" and (flat & (contacts.radius > 0.0)).any():
            raise InputError(
                "contacts",
                "have ellipses that are segments",
                remedy='give wheels bearing friction, or say method="steps"',
            )
        rows.append(surface.stretch.T)
    return np.ascontiguousarray(np.concatenate(rows))


def _body(part: Part, contacts: ContactSet, drag: ArrayLike | None, mode: str) -> Array:
    """Return mass, inertia, drag (3), and the load of the pushes (3)."""
    body = np.zeros(8)
    body[:2], body[5:] = (part.mass, part.inertia), contacts.offset_load
    if drag is not None:
        body[2:5] = as_array("drag", drag, 3)
        if body[2] != body[3] or body[2:5].min() < 0.0:
            raise InputError(
                "drag", "must be at least 0 and the same along x and y", value=body[2:5].tolist()
            )
    if mode == "quasi-static" and not body[2:5].min() > 0.0:
        raise InputError("drag", "must be positive in quasi-static motion", remedy="give drag")
    return body


def _force(contacts: ContactSet, table: LoadTable, body: Array) -> float:
    """Return the size of all loads together [N], moments over the radius of gyration."""
    rho = np.sqrt(body[1] / body[0])
    fx, fy, m = table.largest + np.abs(body[5:])
    return float(contacts.radius.sum() + np.hypot(fx, fy) + m / rho)


def _state(q: Array, v: Array, body: Array, force: float, span: float, mode: str) -> Array:
    """Return the state at the beginning; `span` is the time in which the load changes."""
    state = np.zeros(STATE)
    cos, sin = np.cos(q[2]), np.sin(q[2])
    state[1:4], state[PIVOT] = q, -1.0
    if mode == "quasi-static":
        state[SCALE], state[PROPOSED] = 1e-3 * force / body[2], 1e-3 * span
        return state
    state[4:7] = cos * v[0] + sin * v[1], cos * v[1] - sin * v[0], v[2]
    speed = np.sqrt(v[0] ** 2 + v[1] ** 2 + body[1] / body[0] * v[2] ** 2)
    stop = body[0] * speed / force if force > 0.0 else span
    state[SCALE] = speed if speed > 0.0 else 1e-3 * force / body[0] * span
    state[PROPOSED] = 1e-3 * (min(stop, span) if speed > 0.0 else span)
    return state


def _steps(time_step: float, limit: float, frames: int) -> int:
    """Return the number of equal steps between two frames."""
    step = as_positive("time_step", time_step)
    if limit / step > _STEPS:
        raise InputError("time_step", f"needs {limit / step:.3g} steps", remedy="raise it")
    return max(1, int(np.ceil(limit / (frames * step) - 1e-9)))


def _trajectory(
    rows: Array, events: Array, state: Array, body: Array, force: float, n: int, mode: str
) -> Trajectory:
    rows = rows[: int(state[ROWS])].copy()
    twists = rows[:, 4:7]
    mass = body[:2] if mode == "inertial" else np.zeros(2)
    kinetic = 0.5 * (twists * twists) @ mass[[0, 0, 1]]
    return Trajectory(
        times=rows[:, 0],
        poses=rows[:, 1:4],
        twists=twists,
        loads=rows[:, 7:10],
        error_bounds=rows[:, 10],
        tips=np.full(len(rows), n),
        outcome=Outcome.REST if state[RESTING] else Outcome.TIME_LIMIT,
        worst_error=float(state[WORST]) / force if force > 0.0 else 0.0,
        energy=EnergyBalance(kinetic, rows[:, 11], rows[:, 12], rows[:, 13], rows[:, 14]),
        events=tuple(
            MotionEvent(t, _KINDS[int(kind)], () if where < 0 else (int(where),))
            for t, kind, where in events[: int(state[EVENTS])].tolist()
        ),
    )
