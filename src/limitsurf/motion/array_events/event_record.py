"""The record that an event-driven motion writes while it runs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.motion.array_events.event_state import State, View
from limitsurf.motion.array_events.tip_scene import Scene
from limitsurf.motion.trajectory import EventKind, MotionEvent, Outcome, Trajectory

__all__ = ["Record"]

Array = NDArray[np.float64]


class Record:
    """Frames and events; frames at the same instant replace each other."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._rows: list[Array] = []
        self._worst, self._told = 0.0, -1
        self.events: list[MotionEvent] = []

    @property
    def started(self) -> bool:
        """Whether there is a frame."""
        return bool(self._rows)

    def see(self, view: View) -> bool:
        """Take notice of an error bound; return whether something happened since the last one."""
        self._worst = max(self._worst, view.answer.bound)
        news = self._told != len(self.events)
        self._told = len(self.events)
        return news

    def frame(self, state: State, view: View, carriers: int, residual: float = 0.0) -> None:
        """Add a frame; `residual` is what loads do not add up to, at rest."""
        scene = self._scene
        v = state.twist if scene.inertial else view.answer.rate
        kinetic = 0.5 * float(v @ (scene.mass * v)) if scene.inertial else 0.0
        tips = carriers + int((view.shares > 0.0).sum())
        numbers = [state.time, *state.pose, *v, *view.answer.load]
        numbers += [view.answer.bound + residual, tips, kinetic, *state.energy, state.numerical]
        if self._rows and self._rows[-1][0] == state.time:
            self._rows.pop()
        self._rows.append(np.array(numbers))

    def event(self, time: float, kind: EventKind, tip: int = -1) -> None:
        """Add an event, of a tip or of the part."""
        where = () if tip < 0 else tuple(int(k) for k in self._scene.where[tip])
        self.events.append(MotionEvent(time, kind, where))

    def trajectory(self, outcome: Outcome) -> Trajectory:
        """Return the record."""
        frames = np.array(self._rows)
        worst = float(max(self._worst, frames[:, 10].max()) / self._scene.weight)
        return Trajectory.from_frames(frames, outcome, worst, self.events)
