"""Which engine moves a part, by what drives it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.actuators.density_field import DensityField
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.slide_step import Body, Pace
from limitsurf.motion.array_steps import ArraySteps
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.driven import Driven, DrivenMotion, Watch, as_activation
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.field_motion import field_motion
from limitsurf.motion.in_turn import Move, in_turn
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.loads import gravity, with_gravity
from limitsurf.motion.options import Options, checked_drag
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.time_scales import TimeScales, time_scales
from limitsurf.motion.tip_steps import TipSteps
from limitsurf.motion.trajectory import Trajectory
from limitsurf.sets.arguments import as_positive
from limitsurf.tolerances import CONTACT_STEP, REST_SPEED

__all__ = ["Drive", "Engine", "engine_of"]

Array = NDArray[np.float64]
Drive = Driven | ContactSet | DensityField | Schedule[ContactSet] | Schedule[DensityField]

_MAX_STEPS = 10_000_000
_USUALLY = 6.0  # the default time limit is that much longer than a squeeze of paper takes
_LONG = 20.0  # longest adaptive step, in default steps


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
        trajectory = self.move(self.drive, pose, twist, 0.0, self.duration)
        if watch is not None:
            watch(trajectory.duration, None)
        return trajectory


def engine_of(part: Part, drive: Drive, duration: float | None, **options: Any) -> Engine:
    """Return what moves a part."""
    chosen = Options(**options)
    if not isinstance(part, Part):
        raise InputError("part", "is no Part", value=part)
    limit = None if duration is None else as_positive("duration", duration)
    first = _first(drive)
    if isinstance(first, ContactSet):
        return _on_feet(part, drive, limit, chosen)
    if isinstance(first, DensityField):
        return _in_field(part, drive, limit, chosen)
    chosen.refuse("arrays", "friction")
    asked = drive(0.0) if callable(drive) else first
    return _on_array(part, drive, as_activation(asked), limit, chosen)  # type: ignore[arg-type]


def _first(drive: Drive) -> Any:
    """Return what drives first; InputError for a schedule of different kinds."""
    if not isinstance(drive, Schedule):
        return drive
    first: Any = drive.entries[0][1]
    for _, each in drive.entries:
        if type(each) is not type(first):
            what = f"has a {type(first).__name__} and a {type(each).__name__}"
            raise InputError("drive", what, remedy="schedule drives of one kind")
    return first


def _on_array(
    part: Part, drive: Driven, first: Activation, duration: float | None, options: Options
) -> Engine:
    array = first.array
    weight = gravity(part, options.tilt)
    drag = air_film_drag(part, array)
    if options.drag is not None:
        drag = checked_drag(options.drag, options.mode)
    table = with_gravity(weight, options.load, duration)
    scales = time_scales(part, array, load=table.largest, drag=drag)
    limit = scales.duration if duration is None else duration
    mass = np.array([part.mass, part.mass, part.inertia])
    if options.mode == "quasi-static":
        mass = np.zeros(3)
    edges = np.array(part.edges)  # a copy: kernels are compiled anew for read-only arrays
    body = Body(part.circumradius, edges, weight.normal, mass, drag, table.kernel)
    dt = _longest_step(options, scales, limit)
    usual = limit if duration is not None else limit / _USUALLY
    every, rest = max(usual / options.frames, dt), REST_SPEED * scales.speed
    stepper: ArraySteps | TipSteps
    if options.tip is not None:
        options.refuse("steps with a tip", "tolerance")
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


def _on_feet(part: Part, drive: Drive, duration: float | None, options: Options) -> Engine:
    options.refuse("feet", "tip", "friction")
    if duration is None:
        raise InputError("duration", "is missing", remedy="give it for parts on feet")
    table = with_gravity(gravity(part, options.tilt), options.load, duration)
    given: dict[str, Any] = {"method": options.method} if options.method is not None else {}

    def move(feet: ContactSet, q: Array, v: Array, begin: float, time: float) -> Trajectory:
        return feet_motion(
            part,
            feet,
            q,
            time,
            twist=v,
            load=_from(table, begin),
            drag=options.drag,
            mode=options.mode,
            time_step=options.time_step,
            tolerance=options.tolerance,
            frames=_share(options.frames, time, duration),
            **given,
        )

    return InTurn(drive, duration, move)


def _in_field(part: Part, drive: Drive, duration: float | None, options: Options) -> Engine:
    options.refuse("force fields", "tip")
    if duration is None and isinstance(drive, Schedule):
        raise InputError("duration", "is missing", remedy="give it for schedules")
    load: LoadLike = options.load
    if isinstance(load, LoadTable) and duration is not None:
        load = LoadTable.of(load, duration)
    if np.any(options.tilt):
        load = with_gravity(gravity(part, options.tilt), options.load, duration)
    given: dict[str, Any] = {"method": options.method} if options.method is not None else {}
    if options.tolerance is not None:
        given["tolerance"] = options.tolerance

    def move(field: DensityField, q: Array, v: Array, begin: float, time: float) -> Trajectory:
        return field_motion(
            part,
            field,
            q,
            time,
            twist=v,
            mode=options.mode,
            drag=options.drag,
            friction=options.friction,
            load=_from(load, begin),
            time_step=options.time_step,
            frames=_share(options.frames, time, duration),
            **given,
        )

    return InTurn(drive, duration, move)


def _share(frames: int, time: float | None, duration: float | None) -> int:
    """Return the frames of a piece of a schedule."""
    if time is None or duration is None:
        return frames
    return max(round(frames * time / duration), 1)


def _from(load: LoadLike, begin: float) -> LoadLike:
    """Return a load as a function of the time since `begin`."""
    if isinstance(load, LoadTable) and load.steady:
        return load(0.0)
    if begin == 0.0 or not callable(load):
        return load
    return lambda t: load(begin + t)
