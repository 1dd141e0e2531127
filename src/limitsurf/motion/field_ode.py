"""Motion in a force density as an ordinary differential equation between stops."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from limitsurf.errors import InputError, SolveFailed
from limitsurf.motion.field_problem import FieldProblem
from limitsurf.motion.trajectory import EnergyBalance, EventKind, MotionEvent, Outcome, Trajectory

__all__ = ["field_ode", "polished"]

Array = NDArray[np.float64]

_NUDGE = 1e-3  # of the rest speed: how fast a part starts from a stop
_NEAR = 1e-2  # of the circumradius: how far an equilibrium may be from where a motion ends


@dataclass
class _Record:
    """Frames of a motion: times and states ``pose, twist, work, friction, drag``."""

    times: list[float] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    events: list[MotionEvent] = field(default_factory=list)

    def add(self, time: float, state: Array) -> None:
        """Add a frame, in place of one of the same time."""
        if self.times and time <= self.times[-1]:
            self.states[-1] = state
        else:
            self.times.append(time)
            self.states.append(state)

    def started(self, time: float, rests: bool) -> None:
        """Add the event that a part starts from a stop, unless it rests."""
        if not rests:
            self.events.append(MotionEvent(time, EventKind.START))


def field_ode(
    problem: FieldProblem, pose: Array, twist: Array, limit: float, tolerance: float, frames: int
) -> Trajectory:
    """Integrate until the part rests or the time is up; see `field_motion`."""
    stops = problem.inertial and problem.friction is not None
    if stops and not problem.steady:
        raise InputError(
            "method", "takes no changing load on a mass with friction", remedy="use steps"
        )
    state, record, time = np.zeros(9), _Record(), 0.0
    state[:3], state[3:6] = pose, twist if problem.inertial else 0.0
    state[3:6] = _twist(problem, time, state)
    record.add(time, state)
    rests = problem.steady and _restless(problem, time, state) <= 0.0
    if stops and rests:
        rests, state = _started(problem, state)
        record.started(time, rests)
    while not rests and time < limit:
        time, state, stopped = _slide(problem, record, time, state, limit, tolerance, frames)
        if not stopped:
            break
        rests = True
        if stops:
            rests, state, lasts = _stopped(problem, state)
            time += lasts
            record.started(time, rests)
        record.add(time, state)
    if rests:
        record.events.append(MotionEvent(time, EventKind.REST))
        if problem.friction is None:
            record.states[-1] = _at_equilibrium(problem, time, record.states[-1])
    return _trajectory(problem, record, rests)


def _twist(problem: FieldProblem, time: float, state: Array) -> Array:
    """Return the twist of a state: its own, or of a quasi-static part what its loads say."""
    own: Array = state[3:6]
    if problem.inertial:
        return own
    return problem.balance(state[2], _pull(problem, time, state), problem.drag)[0]


def _pull(problem: FieldProblem, time: float, state: Array) -> Array:
    """Return the load of the field and from outside."""
    return np.asarray(problem.field.load(problem.part, state[:3]) + problem.external(time))


def _rates(problem: FieldProblem, time: float, state: Array) -> Array:
    """Return the derivatives of pose, twist, and the work done and lost so far."""
    pull, rate = _pull(problem, time, state), np.zeros(9)
    if problem.inertial:
        v = state[3:6]
        friction = problem.sliding_friction(state[2], v)
        rate[3:6] = (pull + friction - problem.drag * v) / problem.mass
    else:
        v, friction, *_ = problem.balance(state[2], pull, problem.drag)
    rate[:3], rate[6:] = v, (pull @ v, -friction @ v, problem.drag @ (v * v))
    return rate


def _restless(problem: FieldProblem, time: float, state: Array) -> float:
    """Return the speed above that of rest, counting what a mass without friction will gain."""
    speed = problem.rim_speed(_twist(problem, time, state))
    if problem.inertial and problem.friction is None:
        gain = problem.time * _rates(problem, time, state)[3:6]
        speed = max(speed, problem.rim_speed(gain))
    return speed - problem.rest_speed


def _slide(
    problem: FieldProblem,
    record: _Record,
    begin: float,
    state: Array,
    limit: float,
    tolerance: float,
    frames: int,
) -> tuple[float, Array, bool]:
    """Integrate to a stop or the limit; record frames; return time, state, and which."""
    R, speed = problem.part.circumradius, max(problem.speed, 1e-300)
    work = max(problem.force * R, 1e-300)
    unit = np.array([R, R, 1.0, speed, speed, speed / R, work, work, work])

    def rates(time: float, scaled: Array) -> Array:
        return np.asarray(_rates(problem, time, unit * scaled) / unit)

    def rest(time: float, scaled: Array) -> float:
        return _restless(problem, time, unit * scaled) / speed if problem.steady else 1.0

    rest.terminal, rest.direction = True, -1.0  # type: ignore[attr-defined]
    found = solve_ivp(
        rates,
        (begin, limit),
        state / unit,
        method="LSODA",
        rtol=tolerance,
        atol=tolerance,
        events=rest,
        dense_output=True,
    )
    if not found.success:
        raise SolveFailed(f"field_motion: {found.message}", best=found)
    end = float(found.t[-1])
    for time in np.linspace(begin, end, frames + 1)[1:]:
        frame = unit * found.sol(time)
        frame[3:6] = _twist(problem, float(time), frame)
        record.add(float(time), frame)
    return end, record.states[-1], found.status == 1


def _started(problem: FieldProblem, state: Array) -> tuple[bool, Array]:
    """Return whether friction holds a part at rest, and if not its state as it starts."""
    pull = _pull(problem, 0.0, state)
    v, _, _, held = problem.balance(state[2], pull, problem.mass / problem.time)
    after = state.copy()
    nudge = 0.0 if held else _NUDGE * problem.rest_speed / problem.rim_speed(v)
    after[3:6] = nudge * v
    return held, after


def _stopped(problem: FieldProblem, state: Array) -> tuple[bool, Array, float]:
    """Return whether a slow part stays where it stops, the state there, and the time it takes.

    Friction and pull hardly change before the stop: the speed falls linearly.
    """
    v, pull, after = state[3:6], _pull(problem, 0.0, state), state.copy()
    friction = problem.sliding_friction(state[2], v)
    force, lasts = -(pull + friction - problem.drag * v) @ v, 0.0
    if force > 0.0:
        lasts = float(v @ (problem.mass * v) / force)
        after[:3] += 0.5 * lasts * v
        lost = (pull @ v / 2.0, -friction @ v / 2.0, problem.drag @ (v * v) / 3.0)
        after[6:] += lasts * np.array(lost)
    held, after = _started(problem, after)
    return held, after, lasts


def polished(problem: FieldProblem, time: float, pose: Array) -> Array:
    """Return the stable equilibrium next to a pose; the pose itself if there is none nearby.

    Newton's method, its steps the least ones where the load does not change along some direction.
    """
    R = problem.part.circumradius
    unit, here = np.array([R, R, 1.0]), pose.copy()

    def load(q: Array) -> Array:
        state = np.append(q, np.zeros(6))
        return np.asarray(_pull(problem, time, state) * unit / (problem.force * R))

    before = float(np.linalg.norm(load(here)))
    for _ in range(8):
        J = unit[:, None] * problem.field.jacobian(problem.part, here) * unit / (problem.force * R)
        step = unit * np.linalg.lstsq(J, -load(here), rcond=1e-10)[0]
        if not np.linalg.norm((here + step - pose) / unit) <= _NEAR:
            return pose
        here = here + step
    root = 1.0 / np.sqrt(problem.drag if problem.drag.min() > 0.0 else problem.mass)
    J = problem.field.jacobian(problem.part, here)
    rates = np.linalg.eigvals(root[:, None] * J * root)
    stable = rates.real.max() <= 1e-9 * np.abs(rates).max()
    return here if stable and np.linalg.norm(load(here)) <= before else pose


def _at_equilibrium(problem: FieldProblem, time: float, state: Array) -> Array:
    after = state.copy()
    after[:3] = polished(problem, time, state[:3]) if problem.force > 0.0 else state[:3]
    return after


def _trajectory(problem: FieldProblem, record: _Record, rests: bool) -> Trajectory:
    states, times = np.array(record.states), np.array(record.times)
    loads, bounds = np.empty((len(states), 3)), np.zeros(len(states))
    Q = problem.mass / problem.time if problem.inertial else problem.drag
    for k, state in enumerate(states):
        friction = problem.sliding_friction(state[2], state[3:6])
        if not (problem.inertial and state[3:6].any()):
            pull = _pull(problem, times[k], state)
            _, friction, bounds[k], _ = problem.balance(state[2], pull, Q)
        loads[k] = problem.field.load(problem.part, state[:3]) + friction
    bounds *= np.sqrt(Q[0])
    kinetic = 0.5 * (states[:, 3:6] ** 2) @ problem.mass
    work, friction_loss, drag_loss = states[:, 6:].T
    return Trajectory(
        times=times,
        poses=states[:, :3],
        twists=states[:, 3:6],
        loads=loads,
        error_bounds=bounds,
        tips=np.zeros(len(states), dtype=np.int64),
        outcome=Outcome.REST if rests else Outcome.TIME_LIMIT,
        worst_error=float(bounds.max() / max(problem.force, 1e-300)),
        energy=EnergyBalance(kinetic, work, friction_loss, drag_loss, np.zeros(len(states))),
        events=tuple(record.events),
    )
