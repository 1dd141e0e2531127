"""Which engine moves a part: checks what `simulate` is given, and chooses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.slide_step import Body, Pace
from limitsurf.motion.array_steps import ArraySteps
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.driven import Driven, DrivenMotion, Watch
from limitsurf.motion.load_table import LoadLike
from limitsurf.motion.loads import gravity, with_gravity
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.time_scales import TimeScales, check_lift, time_scales
from limitsurf.motion.tip_steps import TipSteps
from limitsurf.motion.trajectory import Trajectory
from limitsurf.sets.arguments import as_array, as_number
from limitsurf.tolerances import CONTACT_STEP, REST_SPEED

__all__ = ["Drive", "Engine", "Method", "Mode", "Options", "engine_of"]

Array = NDArray[np.float64]
Mode = Literal["inertial", "quasi-static"]
Method = Literal["steps", "events"]
Drive = Driven


class Engine(Protocol):
    """What moves a part, for at most `duration` [s]."""

    @property
    def duration(self) -> float:
        """Time limit [s]."""

    def __call__(self, pose: Array, twist: Array, watch: Watch | None = None) -> Trajectory:
        """Return the motion from a pose and a twist."""


_MAX_STEPS = 10_000_000
_LONG = 20.0  # longest adaptive step, in default steps


@dataclass(frozen=True, kw_only=True, eq=False)
class Options:
    """Options of `simulate`, which explains them."""

    method: Method = "steps"
    mode: Mode = "inertial"
    load: LoadLike = None
    tilt: ArrayLike = (0.0, 0.0)
    drag: ArrayLike | None = None
    tip: OscillatingContact | None = None
    time_step: float | None = None
    tolerance: float | None = None
    frames: int = 200

    def __post_init__(self) -> None:
        """Check those that need nothing else."""
        _choice("method", self.method, get_args(Method))
        _choice("mode", self.mode, get_args(Mode))
        if self.frames < 1:
            raise InputError("frames", "must be at least 1", value=self.frames)
        for name in ("time_step", "tolerance"):
            if getattr(self, name) is not None:
                _positive(name, getattr(self, name))


def engine_of(part: Part, drive: Drive, duration: float | None, **options: Any) -> Engine:
    """Return what moves a part: a function of pose and twist that returns a trajectory."""
    chosen = Options(**options)
    first = _first_activation(drive)
    return _on_array(part, drive, first.array, duration, chosen)


def _first_activation(drive: Any) -> Activation:
    """Return what runs first; InputError unless it is an activation."""
    first = drive.at(0.0) if isinstance(drive, Schedule) else drive
    first = first(0.0) if callable(first) else first
    if isinstance(first, Activation):
        return first
    raise InputError(
        "drive",
        f"is or gives a {type(first).__name__}",
        remedy="give an Activation, a Schedule of them, or a function of time that returns one",
    )


def _on_array(
    part: Part, drive: Driven, array: ActuatorArray, duration: float | None, options: Options
) -> Engine:
    check_lift(part, array)
    weight = gravity(part, options.tilt)
    drag = air_film_drag(part, array)
    if options.drag is not None:
        drag = _checked_drag(options.drag, options.mode)
    table = with_gravity(weight, options.load, duration)
    scales = time_scales(part, array, load=table.largest, drag=drag)
    limit = scales.duration if duration is None else _positive("duration", duration)
    mass = np.array([part.mass, part.mass, part.inertia])
    if options.mode == "quasi-static":
        mass = np.zeros(3)
    body = Body(part.circumradius, part.edges, weight.normal, mass, drag, table.kernel)
    dt = _longest_step(options, scales, limit)
    every, rest = max(limit / options.frames, dt), REST_SPEED * scales.speed
    stepper: ArraySteps | TipSteps
    if options.tip is not None:
        stepper = TipSteps(part, body, table, options.tip, dt, every, rest)
    else:
        stepper = ArraySteps(body, Pace(dt, options.tolerance or 0.0, CONTACT_STEP, rest), every)
    return DrivenMotion(stepper, drive, limit, dt)


def _longest_step(options: Options, scales: TimeScales, limit: float) -> float:
    if options.time_step is None:
        dt = scales.step if options.tolerance is None else _LONG * scales.step
    else:
        dt = options.time_step
    if limit / dt > _MAX_STEPS:
        raise InputError("time_step", f"needs {limit / dt:.3g} steps", value=dt, remedy="raise it")
    return dt


def _checked_drag(given: ArrayLike, mode: Mode) -> Array:
    drag = as_array("drag", given, 3)
    if not (np.isfinite(drag).all() and (drag >= 0.0).all()):
        raise InputError("drag", "must be finite and at least 0", value=tuple(drag.tolist()))
    if mode == "quasi-static" and not drag.all():
        raise InputError(
            "drag",
            "must be positive in quasi-static mode, where it alone limits the speed",
            value=tuple(drag.tolist()),
            remedy="use mode='inertial' or give all three",
        )
    return drag


def _choice(name: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise InputError(name, "is unknown", value=value, remedy=f"use {' or '.join(known)}")


def _positive(name: str, value: float) -> float:
    number = as_number(name, value)
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(name, "must be positive", value=value)
    return float(number)
