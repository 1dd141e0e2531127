"""A part on an array that is driven by one activation after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.kernels.slide_step import (
    HEAVIEST,
    NEXT_FRAME,
    STEPS,
    TIME,
    TWIST_NOW,
    WORST,
    new_motion,
)
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.time_scales import refuse_heavy
from limitsurf.motion.trajectory import (
    EventKind,
    MotionEvent,
    Outcome,
    Trajectory,
)

__all__ = ["Driven", "DrivenMotion", "Stepper", "Watch", "as_activation"]

Array = NDArray[np.float64]
Driven = Activation | Schedule[Activation] | Callable[[float], Activation]

#: Called now and then with the time [s], and with the record so far if the motion is interrupted.
Watch = Callable[[float, Trajectory | None], None]


class Stepper(Protocol):
    """What moves a part on one activation."""

    def advance(
        self, activation: Activation, motion: Array, until: float, final: bool
    ) -> tuple[int, Array, bool]:
        """Move the numbers of a motion on (`kernels.slide`) for a second or two, at most `until`.

        Return the status, frames (k, FRAME), and whether the motion is over on this activation.
        """


@dataclass(frozen=True, eq=False)
class DrivenMotion:
    """Motions on an array, driven by one activation after the other.

    Attributes
    ----------
    stepper : Stepper
        What moves the part.
    drive : Activation, Schedule of activations, or callable
        What runs when; a callable is asked at the beginning of every step.
    duration, step : float
        Time limit, and how often to ask a callable [s].
    """

    stepper: Stepper
    drive: Driven
    duration: float
    step: float

    def __call__(self, pose: Array, twist: Array, watch: Watch | None = None) -> Trajectory:
        """Return the motion from a pose and a twist."""
        motion, log = new_motion(np.array(pose), np.array(twist)), _Log()
        try:
            outcome, array = self._run_all(motion, log, watch)
        except BaseException:
            if watch is not None and log.rows:
                watch(float(motion[TIME]), log.trajectory(motion, Outcome.INTERRUPTED))
            raise
        if outcome is Outcome.NOT_LIFTED and np.isfinite(motion[HEAVIEST]):
            refuse_heavy(float(motion[HEAVIEST]), array)
        if outcome is Outcome.LEFT_ARRAY and motion[STEPS] == 0.0:
            raise InputError(
                "pose",
                "puts the part over the edge of the array",
                value=tuple(pose.tolist()),
                remedy="move it or take a larger array",
            )
        return log.trajectory(motion, outcome)

    def _run_all(
        self, motion: Array, log: _Log, watch: Watch | None
    ) -> tuple[Outcome, ActuatorArray]:
        """Move on all activations; return how it ended, and where."""
        last, outcome = None, Outcome.TIME_LIMIT
        for activation, until, final in _pieces(self.drive, self.duration, self.step):
            begin = float(motion[TIME])
            if last is not None and not _same(activation, last):
                log.add(begin, EventKind.SWITCH)
            last = activation
            outcome = self._run(activation, motion, until, final, log, watch)
            waits = log.tell(outcome, begin, float(motion[TIME]))
            if outcome in (Outcome.LEFT_ARRAY, Outcome.NOT_LIFTED):
                break
            if outcome is Outcome.REST and not final:
                if waits:
                    log.rows.pop()
                motion[TIME] = motion[NEXT_FRAME] = until
                motion[TWIST_NOW : TWIST_NOW + 3] = 0.0
        assert last is not None
        return outcome, last.array

    def _run(
        self,
        activation: Activation,
        motion: Array,
        until: float,
        final: bool,
        log: _Log,
        watch: Watch | None,
    ) -> Outcome:
        over, status = False, int(Outcome.TIME_LIMIT)
        while not over:
            status, frames, over = self.stepper.advance(activation, motion, until, final)
            log.rows.append(frames)
            if watch is not None:
                watch(float(motion[TIME]), None)
        return Outcome(status)


@dataclass
class _Log:
    """Frames and events of a motion so far."""

    rows: list[Array] = field(default_factory=list)
    events: list[MotionEvent] = field(default_factory=list)
    still: bool = False

    def add(self, time: float, kind: EventKind) -> None:
        self.events.append(MotionEvent(time, kind))

    def tell(self, outcome: Outcome, begin: float, end: float) -> bool:
        """Add what a piece of the motion from begin to end tells; return if all of it is rest."""
        rests = outcome is Outcome.REST
        waits = self.still and rests and end == begin
        if self.still and not waits:
            self.add(begin, EventKind.START)
            self.still = False
        if rests and not self.still:
            self.add(end, EventKind.REST)
        if outcome is Outcome.LEFT_ARRAY:
            self.add(end, EventKind.EDGE)
        self.still = rests
        return waits

    def trajectory(self, motion: Array, outcome: Outcome) -> Trajectory:
        frames = np.concatenate(self.rows)
        return Trajectory.from_frames(frames, outcome, float(motion[WORST]), self.events)


def _pieces(
    drive: Driven, duration: float, step: float
) -> Iterator[tuple[Activation, float, bool]]:
    """Yield activations, until when each runs, and whether it is the last."""
    if isinstance(drive, Activation):
        yield drive, duration, True
    elif isinstance(drive, Schedule):
        pieces = drive.pieces(duration)
        for k, (_, end, activation) in enumerate(pieces):
            yield activation, end, k == len(pieces) - 1
    else:
        count = max(int(np.ceil(duration / step - 1e-9)), 1)
        for k in range(count):
            yield as_activation(drive(k * step)), min((k + 1) * step, duration), k == count - 1


def as_activation(drive: Any) -> Activation:
    """Return what drives an array; InputError unless it is an activation."""
    if isinstance(drive, Activation):
        return drive
    raise InputError(
        "drive",
        f"is or gives a {type(drive).__name__}",
        remedy="give an Activation or a function of time that returns one, a DensityField, a "
        "ContactSet, or a Schedule of these",
    )


def _same(one: Activation, other: Activation) -> bool:
    """Return whether the same actuators run; functions of time may return new objects."""
    return one is other or (
        one.array is other.array and bool(np.array_equal(one.active, other.active))
    )
