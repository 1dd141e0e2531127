"""Motions on one drive after the other, joined to one record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from limitsurf.motion.driven import Watch
from limitsurf.motion.trajectory import (
    EnergyBalance,
    EventKind,
    MotionEvent,
    Outcome,
    Trajectory,
)

__all__ = ["in_turn", "joined"]

Array = NDArray[np.float64]
Drive = TypeVar("Drive")

#: Moves a part on a drive from pose and twist at a time for a duration, watched.
Move = Callable[[Drive, Array, Array, float, Any, Watch | None], Trajectory]


def in_turn(
    pieces: Sequence[tuple[float, float, Drive]],
    move: Move[Drive],
    pose: Array,
    twist: Array,
    watch: Watch | None = None,
) -> Trajectory:
    """Return the motion on drives ``(begin, end, drive)`` of a schedule, each from where it was.

    A part that rests waits for the next drive.
    """
    parts: list[tuple[float, Trajectory]] = []
    try:
        for begin, end, drive in pieces:
            found = move(drive, pose, twist, begin, end - begin, _within(parts, begin, watch))
            parts.append((begin, found))
            if watch is not None:
                watch(begin + found.duration, None)
            if found.outcome not in (Outcome.REST, Outcome.TIME_LIMIT):
                break
            rests = found.outcome is Outcome.REST
            pose, twist = found.final_pose, np.zeros(3) if rests else found.twists[-1]
    except BaseException:
        if watch is not None and parts:
            record = replace(joined(parts), outcome=Outcome.INTERRUPTED)
            watch(record.duration, record)
        raise
    return joined(parts)


def _within(parts: list[tuple[float, Trajectory]], begin: float, watch: Watch | None) -> Watch:
    """Return what watches one drive of several: it keeps an interrupted record as the last part."""

    def see(time: float, interrupted: Trajectory | None) -> None:
        if interrupted is not None:
            parts.append((begin, interrupted))
        elif watch is not None:
            watch(begin + time, None)

    return see


def joined(parts: Sequence[tuple[float, Trajectory]]) -> Trajectory:
    """Return trajectories, each with the time at which it begins, as one.

    At the time of a switch the record holds what follows it.
    """

    def column(name: str) -> Array:
        ends = [getattr(part, name)[: _kept(k, parts)] for k, (_, part) in enumerate(parts)]
        return np.concatenate(ends)

    last = parts[-1][1]
    times = [begin + part.times[: _kept(k, parts)] for k, (begin, part) in enumerate(parts)]
    return Trajectory(
        times=np.concatenate(times),
        poses=column("poses"),
        twists=column("twists"),
        loads=column("loads"),
        error_bounds=column("error_bounds"),
        tips=np.asarray(column("tips"), dtype=np.int64),
        outcome=last.outcome,
        worst_error=max(part.worst_error for _, part in parts),
        energy=_energies(parts),
        events=tuple(_events(parts)),
    )


def _events(parts: Sequence[tuple[float, Trajectory]]) -> list[MotionEvent]:
    """Return the events in order; a part that waits at rest neither starts nor rests again."""
    events: list[MotionEvent] = []
    rests = False
    for k, (begin, part) in enumerate(parts):
        if k > 0:
            events.append(MotionEvent(begin, EventKind.SWITCH))
        own = [MotionEvent(begin + e.time, e.kind, e.where) for e in part.events]
        changes = [e.kind for e in own if e.kind in (EventKind.START, EventKind.REST)]
        waits = rests and part.outcome is Outcome.REST and part.duration == 0.0
        if rests and not waits and changes[:1] != [EventKind.START]:
            events.append(MotionEvent(begin, EventKind.START))
        events += [] if waits else own
        rests = part.outcome is Outcome.REST
    return events


def _kept(k: int, parts: Sequence[tuple[float, Trajectory]]) -> int:
    """Return how many frames of a part to keep: the last one is the first of the next, if as late.

    A part that rested earlier keeps it.
    """
    begin, part = parts[k]
    if k == len(parts) - 1 or begin + part.times[-1] < parts[k + 1][0]:
        return len(part.times)
    return len(part.times) - 1


def _energies(parts: Sequence[tuple[float, Trajectory]]) -> EnergyBalance:
    """Return the energies, summed up over the parts."""
    columns: dict[str, list[Array]] = {}
    for name in ("kinetic", "work", "friction", "drag", "numerical"):
        so_far, rows = 0.0, []
        for k, (_, part) in enumerate(parts):
            values = getattr(part.energy, name)
            rows.append(so_far + values[: _kept(k, parts)])
            so_far += 0.0 if name == "kinetic" else float(values[-1])
        columns[name] = rows
    return EnergyBalance(**{name: np.concatenate(rows) for name, rows in columns.items()})
