"""Speeds and times that a part on an array goes with, and whether it is carried."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.constants import g

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.sets.arguments import as_array

__all__ = ["TimeScales", "check_lift", "refuse_heavy", "time_scales"]


@dataclass(frozen=True)
class TimeScales:
    """Speeds and times that a part on an array goes with.

    Attributes
    ----------
    speed : float
        What the part can reach [m/s]: the lesser of the terminal speed against drag and the
        speed after accelerating over the part's circumradius.
    step : float
        Time step [s] in which the part moves at most a tip width at that speed.
    duration : float
        Time [s] after which a squeeze should be over: sixty circumradii at that speed.
    """

    speed: float
    step: float
    duration: float


def time_scales(
    part: Part,
    array: ActuatorArray,
    *,
    load: ArrayLike = (0.0, 0.0, 0.0),
    drag: ArrayLike | None = None,
) -> TimeScales:
    """Return the time scales of a part on an array, under an external load [N, N, N m]."""
    fx, fy, m = as_array("load", load, 3)
    pulled = (float(np.hypot(fx, fy)) + abs(float(m)) / part.circumradius) / part.mass
    acceleration = array.pixel.offset_fraction * array.pixel.friction * g + pulled
    if acceleration == 0.0:
        raise InputError("array", "its actuators do not push", remedy="raise offset_fraction")
    resistance = air_film_drag(part, array) if drag is None else as_array("drag", drag, 3)
    speed = float(np.sqrt(2 * acceleration * part.circumradius))
    if resistance[0] > 0.0:
        speed = min(speed, part.mass * acceleration / float(resistance[0]))
    reach = array.pixel.tip_width or 0.1 * array.site_pitch
    return TimeScales(speed, float(reach / speed), float(60 * part.circumradius / speed))


def check_lift(part: Part, array: ActuatorArray) -> None:
    """Raise PartTooHeavy unless one active tip a pixel can carry the part."""
    density = part.mass / part.area
    refuse_heavy(density * g * array.pixel.pitch**2, array)


def refuse_heavy(normal: float, array: ActuatorArray) -> None:
    """Raise PartTooHeavy if a tip cannot carry a normal force [N]."""
    force = array.pixel.vertical_force(array.voltage)
    if normal > force:
        raise PartTooHeavy(normal, force, array.voltage, array.pixel.lifting_voltage(normal))
