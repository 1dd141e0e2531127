"""What moves a part, whatever drives it; and what the kinds of drives share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from limitsurf.motion.driven import Watch
from limitsurf.motion.in_turn import Move, in_turn
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.trajectory import Trajectory

__all__ = ["Engine", "InTurn", "frames_of", "load_from"]

Array = NDArray[np.float64]


class Engine(Protocol):
    """What moves a part, for at most `duration` [s]."""

    @property
    def duration(self) -> float | None:
        """Time limit [s], if it is known before."""

    def __call__(self, pose: Array, twist: Array, watch: Watch | None = None) -> Trajectory:
        """Return the motion from a pose and a twist."""


@dataclass(frozen=True, eq=False)
class InTurn:
    """An `Engine` for one drive, or a schedule of drives that each are moved on at once."""

    drive: Any
    duration: float | None
    move: Move[Any]

    def __call__(self, pose: Array, twist: Array, watch: Watch | None = None) -> Trajectory:
        """Return the motion from a pose and a twist; it is watched when a drive is done."""
        if isinstance(self.drive, Schedule):
            assert self.duration is not None
            return in_turn(self.drive.pieces(self.duration), self.move, pose, twist, watch)
        trajectory = self.move(self.drive, pose, twist, 0.0, self.duration, watch)
        if watch is not None:
            watch(trajectory.duration, None)
        return trajectory


def frames_of(frames: int, time: float | None, duration: float | None) -> int:
    """Return the frames of a piece of a schedule."""
    if time is None or duration is None:
        return frames
    return max(round(frames * time / duration), 1)


def load_from(load: LoadLike, begin: float) -> LoadLike:
    """Return a load as a function of the time since `begin`."""
    if isinstance(load, LoadTable) and load.steady:
        return load(0.0)
    if begin == 0.0 or not callable(load):
        return load
    return lambda t: load(begin + t)
