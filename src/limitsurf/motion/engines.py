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
from limitsurf.motion.driven import Driven, DrivenMotion, Watch, as_activation
from limitsurf.motion.load_table import LoadLike
from limitsurf.motion.loads import gravity, with_gravity
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.time_scales import TimeScales, time_scales
from limitsurf.motion.tip_steps import TipSteps
from limitsurf.motion.trajectory import Trajectory
from limitsurf.sets.arguments import as_array, as_count, as_positive
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
        as_count("frames", self.frames)
        for name in ("time_step", "tolerance"):
            if getattr(self, name) is not None:
                as_positive(name, getattr(self, name))
        if self.tip is not None and self.tolerance is not None:
            raise InputError("tolerance", "does not go with a tip", remedy="choose a time_step")


def engine_of(part: Part, drive: Drive, duration: float | None, **options: Any) -> Engine:
    """Return what moves a part: a function of pose and twist that returns a trajectory."""
    chosen = Options(**options)
    if not isinstance(part, Part):
        raise InputError("part", "is no Part", value=part)
    limit = None if duration is None else as_positive("duration", duration)
    return _on_array(part, drive, _first_activation(drive).array, limit, chosen)


def _first_activation(drive: Any) -> Activation:
    """Return what runs first; InputError unless it, and all of a schedule, are activations."""
    if isinstance(drive, Schedule):
        first, *_ = [as_activation(each) for _, each in drive.entries]
        return first
    return as_activation(drive(0.0) if callable(drive) else drive)


def _on_array(
    part: Part, drive: Driven, array: ActuatorArray, duration: float | None, options: Options
) -> Engine:
    weight = gravity(part, options.tilt)
    drag = air_film_drag(part, array)
    if options.drag is not None:
        drag = _checked_drag(options.drag, options.mode)
    table = with_gravity(weight, options.load, duration)
    scales = time_scales(part, array, load=table.largest, drag=drag)
    limit = scales.duration if duration is None else duration
    mass = np.array([part.mass, part.mass, part.inertia])
    if options.mode == "quasi-static":
        mass = np.zeros(3)
    edges = np.array(part.edges)  # a copy: kernels are compiled anew for read-only arrays
    body = Body(part.circumradius, edges, weight.normal, mass, drag, table.kernel)
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
    drag = np.array(as_array("drag", given, 3))
    if not (drag >= 0.0).all():
        raise InputError("drag", "must be at least 0", value=tuple(drag.tolist()))
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
