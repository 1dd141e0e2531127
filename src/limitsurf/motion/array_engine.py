"""What moves a part on an activated array: steps, steps with shaking tips, or events."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.slide_step import Body, Pace
from limitsurf.motion.array_events.event_motion import event_motion
from limitsurf.motion.array_steps import ArraySteps
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.driven import Driven, DrivenMotion, Watch
from limitsurf.motion.engine import Engine, InTurn, frames_of, load_from
from limitsurf.motion.load_table import LoadTable
from limitsurf.motion.loads import Gravity, gravity, with_gravity
from limitsurf.motion.options import Options, checked_drag
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.time_scales import TimeScales, time_scales
from limitsurf.motion.tip_steps import TipSteps
from limitsurf.motion.trajectory import Trajectory
from limitsurf.tolerances import CONTACT_STEP, REST_SPEED

__all__ = ["on_array"]

Array = NDArray[np.float64]

_MAX_STEPS = 10_000_000
_USUALLY = 6.0  # the default time limit is that much longer than a squeeze of paper takes
_LONG = 20.0  # longest adaptive step, in default steps


def on_array(
    part: Part, drive: Driven, first: Activation, duration: float | None, options: Options
) -> Engine:
    """Return what moves a part on the activations of an array, `first` being the first."""
    array = first.array
    weight = gravity(part, options.tilt)
    drag = air_film_drag(part, array)
    if options.drag is not None:
        drag = checked_drag(options.drag, options.mode)
    table = with_gravity(weight, options.load, duration)
    scales = time_scales(part, array, load=table.largest, drag=drag)
    limit = scales.duration if duration is None else duration
    if options.method == "events":
        return _by_events(part, drive, limit, options, drag, weight, table)
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


def _by_events(
    part: Part,
    drive: Driven,
    duration: float,
    options: Options,
    drag: Array,
    weight: Gravity,
    table: LoadTable,
) -> Engine:
    options.refuse("events on arrays", "tip")
    if not isinstance(drive, Activation | Schedule):
        raise InputError("drive", "is a function of time", remedy="give a Schedule for events")
    given: dict[str, Any] = {}
    if options.tolerance is not None:
        given["tolerance"] = options.tolerance

    def move(
        activation: Activation, q: Array, v: Array, begin: float, time: float, watch: Watch | None
    ) -> Trajectory:
        return event_motion(
            part,
            activation,
            q,
            time,
            twist=v,
            mode=options.mode,
            drag=drag,
            load=load_from(table, begin),
            weight=weight.normal,
            frames=frames_of(options.frames, time, duration),
            watch=watch,
            **given,
        )

    return InTurn(drive, duration, move)
