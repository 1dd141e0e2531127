"""Simulate a part on an array, on feet, or in a force field."""

from __future__ import annotations

from pathlib import Path

from numpy.typing import ArrayLike
from rich.progress import Progress

from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.geometry.part import Part
from limitsurf.motion.engines import Drive, engine_of
from limitsurf.motion.load_table import LoadLike
from limitsurf.motion.netcdf import as_target
from limitsurf.motion.options import Method, Mode
from limitsurf.motion.trajectory import Trajectory
from limitsurf.sets.arguments import as_array

__all__ = ["simulate"]


def simulate(
    part: Part,
    drive: Drive,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    duration: float | None = None,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    method: Method | None = None,
    mode: Mode = "inertial",
    load: LoadLike = None,
    tilt: ArrayLike = (0.0, 0.0),
    drag: ArrayLike | None = None,
    tip: OscillatingContact | None = None,
    friction: UniformFriction | None = None,
    time_step: float | None = None,
    tolerance: float | None = None,
    frames: int = 200,
    progress: bool = False,
    save: str | Path | None = None,
) -> Trajectory:
    """Simulate a part until it rests, leaves the array, or the time is up.

    On an array each step finds the tips under the part, shares its weight equally among them, and
    solves for the closest point of their limit surface, with a certified error. Feet fixed to the
    part, and force fields without an array, move it likewise.

    Parameters
    ----------
    part : Part
        The part, with areal density.
    drive : Activation, ContactSet, DensityField, a Schedule of these, or callable
        Which actuators run; a function of time [s] that returns an activation is asked in
        every step. A `ContactSet` is what the part stands on, fixed to it: see `feet_motion`. A
        `DensityField` is a continuum of force: see `field_motion`.
    pose : (3,) float
        Start ``(x, y, theta)`` of the centre of mass, array frame [m, m, rad].
    duration : float, optional
        Time limit [s]; `time_scales` gives the default. Feet, and loads that change, need it.
    twist : (3,) float
        Start velocity [m/s, m/s, rad/s]; ignored in quasi-static mode.
    method : {"steps", "events"}, optional
        Implicit steps, the default on arrays; or smooth motion from event to event, the default for
        feet and fields.
    mode : {"inertial", "quasi-static"}
        With the part's mass, or drag alone. Paper is nearly quasi-static, cards are not.
    load : (3,) float, or callable of time that returns one
        External load about the centre of mass, array axes [N, N, N m].
    tilt : (2,) float
        Direction in which the array falls, times the angle [rad].
    drag : (3,) float, optional
        Viscous drag for x, y and theta [N s/m, N s/m, N m s]; by default that of the array's air
        film, and none without an array.
    tip : OscillatingContact, optional
        The motion of a tip, such as `ResonatorPixel.tip`. Then the tips have their full mean
        friction, which falls with the speed of the part, instead of what they exert at rest: a
        hundred times slower, and not with a tolerance.
    friction : UniformFriction, optional
        Friction of the ground under the part in a force field.
    time_step : float, optional
        Step [s], the longest one with a tolerance; by default the part moves at most a tip width
        in one, at the speed that it reaches from rest.
    tolerance : float, optional
        Local error of a step over the part's circumradius: steps adapt to it. On arrays about 1e-4
        is five times faster than the default, fixed steps. What it is for feet and fields, see
        there.
    frames : int
        About how many frames to record.
    progress : bool
        Show a progress bar.
    save : path, optional
        NetCDF file for the trajectory; if the user interrupts, it holds what there is.

    Returns
    -------
    Trajectory

    Raises
    ------
    PartTooHeavy
        The active tips cannot carry the part; names the voltage that would lift it.
    InputError
        Arguments that are not finite or not positive; a start off the array; no drag in
        quasi-static mode; a drive of another kind or shape.

    Examples
    --------
    >>> from limitsurf.actuators.activation import squeeze_activation
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> drive = squeeze_activation(load_array("resonator64"), 0.0)
    >>> simulate(Part.from_file("paper_t"), drive, (0.0, 1e-3, 1.0)).outcome.name
    'REST'
    """
    target = as_target(save)
    start, speed = as_array("pose", pose, 3), as_array("twist", twist, 3)
    engine = engine_of(
        part,
        drive,
        duration,
        method=method,
        mode=mode,
        load=load,
        tilt=tilt,
        drag=drag,
        tip=tip,
        friction=friction,
        time_step=time_step,
        tolerance=tolerance,
        frames=frames,
    )
    with Progress(disable=not progress) as bar:
        task = bar.add_task("Simulating", total=engine.duration)

        def watch(time: float, interrupted: Trajectory | None) -> None:
            bar.update(task, completed=time)
            if interrupted is not None and target is not None:
                interrupted.save(target)

        trajectory = engine(start, speed, watch)
    if target is not None:
        trajectory.save(target)
    return trajectory
