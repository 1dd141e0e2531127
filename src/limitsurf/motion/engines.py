"""Which engine moves a part, by what drives it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.density_field import DensityField
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.array_engine import on_array
from limitsurf.motion.driven import Driven, Watch, as_activation
from limitsurf.motion.engine import Engine, InTurn, frames_of, load_from
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.field_motion import field_motion
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.loads import gravity, with_gravity
from limitsurf.motion.options import Options
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.trajectory import Trajectory
from limitsurf.sets.arguments import as_positive

__all__ = ["Drive", "engine_of"]

Array = NDArray[np.float64]
Drive = Driven | ContactSet | DensityField | Schedule[ContactSet] | Schedule[DensityField]


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
    asked = _asked(drive) if callable(drive) else first
    return on_array(part, drive, as_activation(asked), limit, chosen)  # type: ignore[arg-type]


def _asked(drive: Callable[[float], Any]) -> Any:
    """Return what a function of time gives at its beginning."""
    try:
        return drive(0.0)
    except Exception as error:
        raise InputError(
            "drive",
            "fails as a function of time",
            remedy="for a field of points, give a DensityField or `activate` an array with it",
        ) from error


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


def _on_feet(part: Part, drive: Drive, duration: float | None, options: Options) -> Engine:
    options.refuse("feet", "tip", "friction")
    if duration is None:
        raise InputError("duration", "is missing", remedy="give it for parts on feet")
    table = with_gravity(gravity(part, options.tilt), options.load, duration)
    given: dict[str, Any] = {"method": options.method} if options.method is not None else {}

    def move(
        feet: ContactSet, q: Array, v: Array, begin: float, time: float, _: Watch | None
    ) -> Trajectory:
        return feet_motion(
            part,
            feet,
            q,
            time,
            twist=v,
            load=load_from(table, begin),
            drag=options.drag,
            mode=options.mode,
            time_step=options.time_step,
            tolerance=options.tolerance,
            frames=frames_of(options.frames, time, duration),
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

    def move(
        field: DensityField, q: Array, v: Array, begin: float, time: float, _: Watch | None
    ) -> Trajectory:
        return field_motion(
            part,
            field,
            q,
            time,
            twist=v,
            mode=options.mode,
            drag=options.drag,
            friction=options.friction,
            load=load_from(load, begin),
            time_step=options.time_step,
            frames=frames_of(options.frames, time, duration),
            **given,
        )

    return InTurn(drive, duration, move)
