"""Simulate a part on an activated array."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.constants import g

from limitsurf.actuators.activation import Activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part
from limitsurf.kernels.lattice import Lattice
from limitsurf.kernels.slide import Body, Ground, slide
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.trajectory import EnergyBalance, Outcome, Trajectory
from limitsurf.tolerances import CONTACT_STEP, REST_SPEED

__all__ = ["Mode", "TimeScales", "check_lift", "simulate", "time_scales"]

Mode = Literal["inertial", "quasi-static"]

_MAX_STEPS = 10_000_000


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


def time_scales(part: Part, array: ActuatorArray) -> TimeScales:
    """Return the time scales of a part on an array."""
    acceleration = array.pixel.offset_fraction * array.pixel.friction * g
    if acceleration == 0.0:
        raise InputError("array", "its actuators do not push", remedy="raise offset_fraction")
    terminal = part.mass * acceleration / air_film_drag(part, array)[0]
    speed = min(terminal, np.sqrt(2 * acceleration * part.circumradius))
    reach = array.pixel.tip_width or 0.1 * array.site_pitch
    return TimeScales(float(speed), float(reach / speed), float(60 * part.circumradius / speed))


def check_lift(part: Part, array: ActuatorArray) -> None:
    """Raise PartTooHeavy unless one active tip a pixel can carry the part."""
    density = part.mass / part.area
    _refuse_heavy(density * g * array.pixel.pitch**2, array)


def _refuse_heavy(normal: float, array: ActuatorArray) -> None:
    force = array.pixel.vertical_force(array.voltage)
    if normal > force:
        raise PartTooHeavy(normal, force, array.voltage, array.pixel.lifting_voltage(normal))


def simulate(
    part: Part,
    drive: Activation,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    duration: float | None = None,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    mode: Mode = "inertial",
    time_step: float | None = None,
    frames: int = 200,
) -> Trajectory:
    """Simulate a part until it rests, leaves the array, or the time is up.

    Each step finds the tips under the part, shares its weight equally among them, and solves for
    the closest point of their limit surface, with a certified error.

    Parameters
    ----------
    part : Part
        The part, with areal density.
    drive : Activation
        Which actuators run.
    pose : (3,) float
        Start ``(x, y, theta)`` of the centre of mass, array frame [m, m, rad].
    duration : float, optional
        Time limit [s]; `time_scales` gives the default.
    twist : (3,) float
        Start velocity [m/s, m/s, rad/s]; ignored in quasi-static mode.
    mode : {"inertial", "quasi-static"}
        With the part's mass, or drag alone. Paper is nearly quasi-static, cards are not.
    time_step : float, optional
        Step [s]; by default the part moves at most a tip width in one.
    frames : int
        About how many frames to record.

    Returns
    -------
    Trajectory

    Raises
    ------
    PartTooHeavy
        The active tips cannot carry the part; names the voltage that would lift it.
    InputError
        Arguments that are not finite or not positive; a start off the array.

    Examples
    --------
    >>> from limitsurf.actuators.activation import squeeze_activation
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> drive = squeeze_activation(load_array("resonator64"), 0.0)
    >>> simulate(Part.from_file("paper_t"), drive, (0.0, 1e-3, 1.0)).outcome.name
    'REST'
    """
    array = drive.array
    check_lift(part, array)
    scales = time_scales(part, array)
    limit = _positive("duration", scales.duration if duration is None else duration)
    dt = _positive("time_step", scales.step if time_step is None else time_step)
    if frames < 1:
        raise InputError("frames", "must be at least 1", value=frames)
    if limit / dt > _MAX_STEPS:
        raise InputError("time_step", f"needs {limit / dt:.3g} steps", value=dt, remedy="raise it")
    steps = int(np.ceil(limit / dt))
    stride = max(1, steps // frames)
    end, speed = _vector("pose", pose), _vector("twist", twist)
    rows = np.empty((steps // stride + 3, 12))
    status, _, written, worst, heaviest = slide(
        _body(part, array, mode),
        _ground(drive),
        end,
        speed,
        dt,
        steps,
        stride,
        CONTACT_STEP,
        REST_SPEED * scales.speed,
        rows,
    )
    outcome = Outcome(status)
    if outcome is Outcome.NOT_LIFTED and np.isfinite(heaviest):
        _refuse_heavy(heaviest, array)
    if outcome is Outcome.LEFT_ARRAY and written == 1:
        raise InputError("pose", "puts the part over the edge of the array", value=tuple(end))
    table = rows[:written]
    return Trajectory(
        times=table[:, 0].copy(),
        poses=table[:, 1:4].copy(),
        twists=table[:, 4:7].copy(),
        loads=table[:, 7:10].copy(),
        error_bounds=table[:, 10].copy(),
        tips=table[:, 11].astype(np.int64),
        outcome=outcome,
        worst_error=worst,
        energy=EnergyBalance(*np.full((5, written), np.nan)),
    )


def _body(part: Part, array: ActuatorArray, mode: Mode) -> Body:
    if mode not in ("inertial", "quasi-static"):
        raise InputError("mode", "is unknown", value=mode, remedy="use inertial or quasi-static")
    mass = np.array([part.mass, part.mass, part.inertia])
    return Body(
        reach=part.circumradius,
        edges=part.edges,
        weight=part.mass * g,
        mass=mass if mode == "inertial" else np.zeros(3),
        drag=air_film_drag(part, array),
    )


def _ground(drive: Activation) -> Ground:
    array, pixel = drive.array, drive.array.pixel
    return Ground(
        lattice=Lattice(
            *array.first_site, array.site_pitch, drive.active, tip_width=pixel.tip_width
        ),
        directions=array.site_directions,
        push=pixel.friction * pixel.offset_fraction,
        grip=pixel.friction * pixel.residual_fraction,
        lift=pixel.vertical_force(array.voltage),
    )


def _positive(name: str, value: float) -> float:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(name, "must be positive", value=value)
    return float(value)


def _vector(name: str, value: ArrayLike) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    vector = np.array(value, dtype=np.float64)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError(name, "must be three finite numbers", value=value)
    return vector
