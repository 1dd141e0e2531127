"""Walkers: bodies on feet of their own, on a homogeneous floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.motion.rigid_motion import to_world
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.steady_walk import SteadyWalk, steady_walk
from limitsurf.motion.trajectory import (
    EnergyBalance,
    EventKind,
    MotionEvent,
    Outcome,
    Trajectory,
)
from limitsurf.sets.arguments import as_array, as_count, as_positive

__all__ = ["walk"]

Array = NDArray[np.float64]
Piece = tuple[float, float, SteadyWalk]


def walk(
    contacts: ContactSet | Schedule[ContactSet],
    duration: float,
    *,
    drag: ArrayLike = (1.0, 1.0, 1.0),
    pose: ArrayLike = (0.0, 0.0, 0.0),
    load: ArrayLike = (0.0, 0.0, 0.0),
    frames: int = 200,
) -> Trajectory:
    """Walk on feet that are fixed to the body, quasi-statically, in closed form.

    Each set of feet gives a straight line or a circle, exact at all recorded times; see
    `steady_walk` for the formula. A gait is a schedule of feet, and its path a chain of arcs.

    Parameters
    ----------
    contacts : ContactSet or Schedule of ContactSet
        Feet in the body frame, with the pushes of the ground on the active ones as offsets.
    duration : float
        Time limit [s].
    drag : (3,) float
        Viscous drag of the body, body axes [N s/m, N s/m, N m s]. By default the paper's own rule:
        the velocity is the load, in SI units.
    pose : (3,) float
        Start ``(x, y, theta)`` of the reference point [m, m, rad].
    load : (3,) float
        External load fixed to the body [N, N, N m].
    frames : int
        About how many frames to record, besides the times at which the feet change.

    Returns
    -------
    Trajectory
        It ends, with `Outcome.REST`, where no feet move the body from then on; at time 0 if
        the limit surface holds it from the start. `SteadyWalk.projection` is the certificate.

    Raises
    ------
    InputError
        Arguments that are not finite or not positive.

    Examples
    --------
    A quarter turn about a point 2 m to the right, and legs that turn it back:

    >>> right = ContactSet([[0.0, 1.0]], 0.0, [[1.0, 0.0]])
    >>> left = ContactSet([[0.0, -1.0]], 0.0, [[1.0, 0.0]])
    >>> gait = Schedule([(0.0, right), (np.pi, left)], period=2 * np.pi)
    >>> walk(gait, 2 * np.pi, drag=(1.0, 1.0, 2.0)).final_pose.round(12)
    array([ 4., -4.,  0.])
    """
    limit, count = as_positive("duration", duration), as_count("frames", frames)
    gait = contacts if isinstance(contacts, Schedule) else Schedule([(0.0, contacts)])
    phases = [(t, steady_walk(feet, drag, load)) for t, feet in gait.entries]
    plan = Schedule(phases, gait.period)
    rest = _rest_time(plan)
    end, rests = min(limit, rest), rest <= limit
    pieces = plan.pieces(end)
    rows = _rows(pieces, plan.at(end), as_array("pose", pose, 3), end, count)
    zero = np.zeros(len(rows))
    return Trajectory(
        times=rows[:, 0],
        poses=rows[:, 1:4],
        twists=to_world(rows[:, 4:7], rows[:, 3]),
        loads=to_world(rows[:, 7:10], rows[:, 3]),
        error_bounds=rows[:, 10],
        tips=rows[:, 11].astype(np.int64),
        outcome=Outcome.REST if rests else Outcome.TIME_LIMIT,
        worst_error=max(w.relative_error for _, w in phases),
        energy=EnergyBalance(zero, rows[:, 12], rows[:, 13], rows[:, 14], zero),
        events=tuple(_events(pieces, end if rests else None)),
    )


def _rest_time(plan: Schedule[SteadyWalk]) -> float:
    """Return the time from which on the feet move the body no more, perhaps inf."""
    rest = np.inf
    for time, phase in reversed(plan.entries):
        if not phase.held:
            break
        rest = time
    return rest if plan.period is None or rest == 0.0 else np.inf


def _rows(pieces: list[Piece], last: SteadyWalk, pose: Array, end: float, frames: int) -> Array:
    """Return rows ``time, pose, twist, load, error bound, feet, work, friction, drag``.

    Twists and loads are in the body frame.
    """
    grid, gap = np.linspace(0.0, end, frames + 1), 1e-9 * end  # no two frames at a switch
    spent, tables = np.zeros(3), []
    for begin, until, phase in pieces:
        times = np.append(begin, grid[(grid > begin + gap) & (grid < until - gap)])
        tables.append(_table(phase, times, begin, pose, spent))
        pose, spent = phase.poses(until - begin, pose), spent + (until - begin) * phase.powers
    return np.vstack([*tables, _table(last, np.array([end]), end, pose, spent)])


def _table(phase: SteadyWalk, times: Array, begin: float, pose: Array, spent: Array) -> Array:
    steady = [*phase.twist, *phase.load, phase.error_bound, phase.feet]
    passed = (times - begin)[:, None]
    return np.hstack(
        [
            times[:, None],
            phase.poses(times - begin, pose),
            np.tile(steady, (len(times), 1)),
            spent + passed * phase.powers,
        ]
    )


def _events(pieces: list[Piece], rest: float | None) -> list[MotionEvent]:
    """Return when the feet change, and when the body starts and rests by that."""
    found, held = [], False
    changes = [(begin, phase.held) for begin, _, phase in pieces]
    if rest is not None:
        changes.append((rest, True))
    for time, holds in changes:
        if time > 0.0:
            found.append(MotionEvent(time, EventKind.SWITCH))
        if holds != held:
            found.append(MotionEvent(time, EventKind.REST if holds else EventKind.START))
        held = holds
    return found
