"""The loop of an event-driven motion: smooth stretches, cut where something happens."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError, TooManyEvents
from limitsurf.kernels.outline_crossings import first_crossing, first_exit
from limitsurf.kernels.pose_arc import Arc
from limitsurf.motion.array_events.border_events import BorderCut, first_border_cut, snapped
from limitsurf.motion.array_events.event_record import Record
from limitsurf.motion.array_events.event_state import Path, State, Steps, Stretch, View, integrate
from limitsurf.motion.array_events.regroup import Regrouping
from limitsurf.motion.array_events.tip_scene import Scene
from limitsurf.motion.array_events.touching import close_tips, gone_round, tips_under, touching_tips
from limitsurf.motion.driven import Watch
from limitsurf.motion.trajectory import EventKind, Outcome
from limitsurf.tolerances import REST_SPEED

__all__ = ["EventRun"]

Array = NDArray[np.float64]

_STIFF = 300.0  # changes of velocity by friction in a step, from which it is stiff
_BALANCED = 1e-9  # of the drive's force: what may be left at rest


class Cut(NamedTuple):
    """Where a stretch ends, as a share of its path, and why."""

    tau: float
    crossing: tuple[int, int] = (-1, -1)
    edge: bool = False
    border: BorderCut | None = None


class EventRun:
    """A motion from its start on; `record` is what happened, `normal` the load on a tip now.

    Parameters
    ----------
    scene : Scene
        Part and tips.
    pose, twist : (3,) float
        Start.
    limit : float
        Time limit [s].
    tolerance : float
        Of the integrator, relative to the pitch.
    interval : float
        Time between frames [s].
    """

    def __init__(
        self,
        scene: Scene,
        pose: Array,
        twist: Array,
        limit: float,
        tolerance: float,
        interval: float,
    ) -> None:
        self._scene, self._limit, self._interval = scene, limit, interval
        self._state = State(0.0, pose, twist)
        self.record, self.normal = Record(scene), 0.0
        self._tolerance = tolerance * _sizes(scene)
        self._first, self._cuts = interval, 0
        if not scene.on_array(pose):
            raise InputError(
                "pose", "puts the part over the edge of the array", value=tuple(pose.tolist())
            )
        self._groups = Regrouping(scene, self.record)
        touching = touching_tips(scene, pose, [], scene.near)
        self._carriers = self._groups.first(self._state, tips_under(scene, pose), touching)

    @property
    def time(self) -> float:
        """How far the motion has come [s]."""
        return self._state.time

    def until_the_end(self, max_events: int, watch: Watch | None = None) -> Outcome:
        """Go on until the part rests, leaves, sinks or the time is up; return which."""
        while True:
            stretch = Stretch(self._scene, self._state, self._carriers)
            state = self._state
            view = stretch.look(state.time, state.pose, state.twist)
            outcome = self._ending(view)
            if self.record.see(view) or outcome is not None:
                self._frame(state, view, outcome)
            if outcome is not None:
                return outcome
            if watch is not None:
                watch(state.time, None)
            if self._cuts >= max_events:
                raise TooManyEvents(max_events, state.time)
            if self._advance(stretch, view):
                self.record.event(self._state.time, EventKind.EDGE)
                view = stretch.look(self._state.time, self._state.pose, self._state.twist)
                self._frame(self._state, view, None)
                return Outcome.LEFT_ARRAY

    def _ending(self, view: View) -> Outcome | None:
        """Return how the motion ends here, if it does."""
        scene, state = self._scene, self._state
        self.normal = view.normal
        if self.normal > scene.lift:
            return Outcome.NOT_LIFTED
        if scene.steady and self._rests(view):
            self.record.event(state.time, EventKind.REST)
            return Outcome.REST
        return Outcome.TIME_LIMIT if state.time >= self._limit else None

    def _rests(self, view: View) -> bool:
        scene, slow = self._scene, REST_SPEED * self._scene.speed
        if not scene.inertial:
            return view.answer.sticks or scene.rim_speed(view.answer.rate) <= slow
        twist, rate = self._state.twist, view.answer.rate
        if not twist.any():
            limit = _BALANCED * scene.force / scene.mass[0]
            return view.answer.sticks or scene.rim_speed(rate) <= limit
        if scene.rim_speed(twist) > slow or scene.drag.min() == 0.0:
            return False
        net = view.answer.load + scene.load(self._state.time)
        return scene.rim_speed(net / scene.drag) <= slow

    def _frame(self, state: State, view: View, outcome: Outcome | None) -> None:
        residual = 0.0
        if outcome is Outcome.REST and not view.answer.sticks:
            net = view.answer.load + self._scene.load(state.time)
            Q = self._scene.quadratic
            residual = float(np.linalg.norm(net / [1.0, 1.0, np.sqrt(Q[2] / Q[0])]))
        self.record.frame(state, view, int(self._carriers.inside.sum()), residual)

    def _advance(self, stretch: Stretch, view: View) -> bool:
        """Move to the next event, or by a step; return whether the part leaves the array."""
        state, scene, carriers = self._state, self._scene, self._carriers
        longest = self._longest(view)
        steps = Steps(self._first, longest, view.fading * longest > _STIFF)
        path = integrate(stretch, state.time, self._limit, steps, self._tolerance)
        cut = self._cut(stretch, path, view)
        self._first = 2.5 * path.length
        if cut.tau < 1.0:
            self._cuts += 1
            self._first = max(path.length, 2.0 * cut.tau * path.length)
        touching = touching_tips(scene, state.pose, carriers.border, scene.near)
        corners = [t for t in touching if t.corner and t.tip != cut.crossing[0] and cut.tau > 0.0]
        turned = gone_round(scene, corners, carriers, stretch.split(path.at(cut.tau))[0])
        if turned:
            self._carriers = self._groups.turned(state, carriers, turned)
            self._cuts += 1
            return False
        self._frames_until(stretch, path, cut.tau)
        self._state = self._end_of(stretch, path, cut)
        if not cut.edge:
            self._happen(cut)
        return cut.edge

    def _end_of(self, stretch: Stretch, path: Path, cut: Cut) -> State:
        """Return the state where a path is cut."""
        pose, twist, energy = stretch.split(path.at(cut.tau))
        last = cut.tau == 1.0 and path.begin + path.length >= self._limit
        time = self._limit if last else path.begin + cut.tau * path.length
        pose = self._held(pose, cut.crossing)
        return State(time, pose, twist, energy, self._state.numerical)

    def _longest(self, view: View) -> float:
        """Return a step in which the part moves half a pitch or so."""
        scene = self._scene
        v = self._state.twist if scene.inertial else view.answer.rate
        longest = 0.5 * scene.pitch / max(scene.rim_speed(v), 1e-300)
        if scene.inertial:
            fall = np.sqrt(scene.pitch / max(scene.rim_speed(view.answer.rate), 1e-300))
            longest = min(longest, float(fall)) if v.any() else float(fall)
        return longest if scene.steady else min(longest, self._limit / 200)

    def _cut(self, stretch: Stretch, path: Path, view: View) -> Cut:
        """Return the first thing that happens on a path."""
        scene, border = self._scene, self._carriers.border
        arc = Arc(self._state.pose, np.ascontiguousarray(path.powers[:, :3]))
        skip = np.zeros(len(scene.points), dtype=np.bool_)
        skip[[tip.tip for tip in border]] = True
        tau, tip, edge = first_crossing(
            arc, scene.edges, scene.points, self._carriers.inside, skip, scene.near
        )
        cut = Cut(min(tau, 1.0), (tip, edge) if tau < 1.0 else (-1, -1))
        leaving = first_exit(arc, scene.edges, scene.walls, scene.near)
        if leaving < cut.tau:
            cut = Cut(leaving, edge=True)
        at = first_border_cut(scene, stretch, path, self._carriers, view, cut.tau)
        return cut if at is None else Cut(at.tau, border=at)

    def _frames_until(self, stretch: Stretch, path: Path, tau: float) -> None:
        end = path.begin + tau * path.length
        first = np.floor(path.begin / self._interval) + 1
        for k in np.arange(first, np.ceil(end / self._interval)):
            time = k * self._interval
            if not path.begin < time < end:
                continue
            y = path.at((time - path.begin) / path.length)
            pose, twist, energy = stretch.split(y)
            state = State(time, self._held(pose), twist, energy, self._state.numerical)
            self._frame(state, stretch.look(time, state.pose, twist), None)

    def _held(self, pose: Array, crossing: tuple[int, int] = (-1, -1)) -> Array:
        """Return the pose with the tips that stay on the outline put back on it."""
        tips = [self._carriers.border[k] for k in self._carriers.free]
        return snapped(self._scene, pose, tips, crossing) if tips else pose

    def _happen(self, cut: Cut) -> None:
        """Let happen what the cut says, and what goes with it at the same instant."""
        groups, state, carriers = self._groups, self._state, self._carriers
        if cut.border is not None:
            self._carriers = groups.border_event(state, carriers, cut.border)
        elif cut.crossing[0] >= 0:
            scene, border = self._scene, carriers.border
            touching = touching_tips(scene, state.pose, border, scene.near)
            close = close_tips(scene, state, border)
            self._carriers = groups.crossing(state, carriers, touching, close)
        else:
            self._carriers = groups.step(state, carriers)


def _sizes(scene: Scene) -> Array:
    """Return the sizes that errors of the integrator are measured by."""
    length, turn = scene.pitch, scene.pitch / scene.radius
    energy = 0.01 * scene.force * scene.pitch
    speed = 0.1 * scene.speed
    speeds = [speed, speed, speed / scene.radius] if scene.inertial else []
    return np.array([length, length, turn, *speeds, *[energy] * 3])
