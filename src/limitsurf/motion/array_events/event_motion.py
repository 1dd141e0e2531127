"""Event-driven motion of a part on an activated array: exact crossings, exact rest on borders."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part
from limitsurf.motion.array_events.event_run import EventRun
from limitsurf.motion.array_events.tip_scene import Load, build_scene
from limitsurf.motion.driven import Watch
from limitsurf.motion.options import Mode
from limitsurf.motion.trajectory import Outcome, Trajectory
from limitsurf.sets.arguments import as_array, as_count, as_number, as_positive

__all__ = ["event_motion"]

Array = NDArray[np.float64]


def event_motion(
    part: Part,
    drive: Activation,
    pose: ArrayLike,
    duration: float,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    mode: Mode = "quasi-static",
    drag: ArrayLike,
    load: Load = None,
    weight: float | None = None,
    tolerance: float = 1e-9,
    max_events: int = 100_000,
    frames: int = 200,
    watch: Watch | None = None,
) -> Trajectory:
    r"""Return the motion of a part on an activated array, event by event.

    The configuration space is cut into cells in which the same tips carry the part. Within a cell
    the motion is smooth and integrated by DOP853; where a tip, taken as a point, comes under the
    outline or leaves it, the instant is found to rounding. On the border of cells the part crosses,
    slides along it, or rests, with the share of the tip that follows (``motion/border.py``). A part
    with mass bounces about a border that it is pushed to from both sides; bounces lower than a
    millionth of the pitch are taken to be over.

    Parameters
    ----------
    part, drive : Part, Activation
        What moves on what; the width of the tips is not used.
    pose : (3,) float
        Start ``(x, y, theta)`` of the centre of mass, array frame [m, m, rad].
    duration : float
        Time limit [s].
    twist : (3,) float
        Start velocity [m/s, m/s, rad/s]; ignored in quasi-static mode.
    mode : {"quasi-static", "inertial"}
        Drag alone, or with the part's mass.
    drag : (3,) float
        Viscous drag, the same along x and y [kg/s, kg/s, kg m^2/s]; zero only with mass.
    load : (3,) float or callable, optional
        External load about the centre of mass, world axes [N, N, N m], or that as a smooth function
        of time.
    weight : float, optional
        What the tips carry [N], less than the part's weight on a slope.
    tolerance : float
        Error of a step of the integrator, relative to the pitch.
    max_events : int
        Events after which to give up.
    frames : int
        About how many frames to record besides those at events.
    watch : callable, optional
        Called with the time now and then, and with the record so far if the motion is interrupted.

    Returns
    -------
    Trajectory

    Raises
    ------
    PartTooHeavy
        The active tips cannot carry the part.
    InputError
        Arguments that are not finite or not positive; a start off the array.
    TooManyEvents
        `max_events` are not enough.

    Examples
    --------
    >>> from limitsurf.actuators.activation import squeeze_activation
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.motion.drag import air_film_drag
    >>> array, part = load_array("resonator64"), Part.from_file("paper_t")
    >>> drive, drag = squeeze_activation(array, 0.0), air_film_drag(part, array)
    >>> path = event_motion(part, drive, (0.0, 1e-4, 1.5), 20.0, drag=drag)
    >>> print(path.events[-1].kind)
    the part rests
    """
    start = np.array(as_array("pose", pose, 3))
    moving = np.array(as_array("twist", twist, 3))
    limit = as_positive("duration", duration)
    if not 0.0 < as_number("tolerance", tolerance) < 1.0:
        raise InputError("tolerance", "must lie between 0 and 1", value=tolerance)
    count, most = as_count("frames", frames), as_count("max_events", max_events)
    scene = build_scene(part, drive, drag, load, mode, weight)
    if not scene.inertial:
        moving[:] = 0.0
    run = EventRun(scene, start, moving, limit, float(tolerance), limit / count)
    try:
        outcome = run.until_the_end(most, watch)
    except BaseException:
        if watch is not None and run.record.started:
            watch(run.time, run.record.trajectory(Outcome.INTERRUPTED))
        raise
    if outcome is Outcome.NOT_LIFTED and np.isfinite(run.normal):
        pixel, voltage = drive.array.pixel, drive.array.voltage
        raise PartTooHeavy(run.normal, scene.lift, voltage, pixel.lifting_voltage(run.normal))
    return run.record.trajectory(outcome)
