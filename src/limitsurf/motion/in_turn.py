"""Motions on one drive after the other, joined to one record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

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

#: Moves a part on a drive from pose and twist at a time for a duration.
Move = Callable[[Drive, Array, Array, float, Any], Trajectory]


def in_turn(
    pieces: Sequence[tuple[float, float, Drive]], move: Move[Drive], pose: Array, twist: Array
) -> Trajectory:
    """Return the motion on drives ``(begin, end, drive)`` of a schedule, each from where it was.

    A part that rests waits for the next drive.
    """
    parts: list[tuple[float, Trajectory]] = []
    for begin, end, drive in pieces:
        found = move(drive, pose, twist, begin, end - begin)
        parts.append((begin, found))
        if found.outcome not in (Outcome.REST, Outcome.TIME_LIMIT):
            break
        rests = found.outcome is Outcome.REST
        pose, twist = found.final_pose, np.zeros(3) if rests else found.twists[-1]
    return joined(parts)


def joined(parts: Sequence[tuple[float, Trajectory]]) -> Trajectory:
    """Return trajectories, each with the time at which it begins, as one.

    At the time of a switch the record holds what follows it.
    """
    events: list[MotionEvent] = []
    for k, (begin, part) in enumerate(parts):
        if k > 0:
            events.append(MotionEvent(begin, EventKind.SWITCH))
        events += [MotionEvent(begin + e.time, e.kind, e.where) for e in part.events]

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
        events=tuple(events),
    )


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
