"""Motion of a part in a continuum force field, without an array."""

from __future__ import annotations

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.density_field import DensityField
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.field_steps import ENERGIES, FRAME, field_steps
from limitsurf.motion.field_ode import field_ode
from limitsurf.motion.field_problem import FieldProblem, field_problem
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.options import Method, Mode, check_choice
from limitsurf.motion.trajectory import EnergyBalance, EventKind, MotionEvent, Outcome, Trajectory
from limitsurf.sets.arguments import as_array, as_count, as_positive
from limitsurf.tolerances import CONTACT_SUM

__all__ = ["field_motion"]

Array = NDArray[np.float64]

_MAX_STEPS = 10_000_000
_STEPS_PER_TIME = 200  # default steps while the part goes a circumradius


def field_motion(
    part: Part,
    field: DensityField,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    duration: float | None = None,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    mode: Mode = "inertial",
    drag: ArrayLike | None = None,
    friction: UniformFriction | None = None,
    load: LoadLike = None,
    method: Method = "events",
    time_step: float | None = None,
    tolerance: float = 1e-9,
    frames: int = 200,
) -> Trajectory:
    r"""Move a part through a force density until it rests or the time is up.

    .. math:: M \dot v = F(q) + F_{ext} + F_f - D v, \qquad -F_f = \nabla h(v)

    with friction F_f of uniform traction; M = 0 in quasi-static mode.

    Parameters
    ----------
    part : Part
        The part; with areal density in inertial mode.
    field : DensityField
        What pushes.
    pose : (3,) float
        Start ``(x, y, theta)`` of the centre of mass [m, m, rad].
    duration : float, optional
        Time limit [s]; by default sixty times what the part needs for its circumradius.
    twist : (3,) float
        Start velocity [m/s, m/s, rad/s]; not used in quasi-static mode.
    mode : {"inertial", "quasi-static"}
        With the part's mass, or drag alone.
    drag : (3,) float, optional
        Viscous drag [kg/s, kg/s, kg m^2/s], as of `air_film_drag`; quasi-static motion needs it.
    friction : UniformFriction, optional
        Friction fixed to the part, about its centre of mass.
    load : (3,) float or callable, optional
        External load, world axes [N, N, N m], perhaps of the time [s]; a part under a load that
        changes is never said to rest.
    method : {"steps", "events"}
        ``"steps"`` solves for every implicit step with a certified closest point; first order, any
        friction. ``"events"`` integrates the smooth motion between stops with control of the error
        and finds the stops; it does not take friction together with mass and a changing load.
    time_step : float, optional
        Step [s] of ``"steps"``, or a little less, so that the last one ends at the limit; by
        default a two-hundredth of the time for a circumradius.
    tolerance : float
        Error of ``"events"``, relative to circumradius, speed and work.
    frames : int
        About how many frames to record; with ``"events"`` between stops.

    Returns
    -------
    Trajectory
        `loads` are those of field and friction; `tips` are zeros. Events: rest, and with
        ``"events"`` each start of a mass from where friction stopped or held it.

    Notes
    -----
    Without friction ``"events"`` ends a motion that comes to rest in the equilibrium itself:
    Newton's method with the exact Jacobian, if that is near and stable.

    Raises
    ------
    InputError
        No drag in quasi-static mode, no mass in inertial mode, numbers out of range.

    Examples
    --------
    A rectangle comes to rest along the line that it is squeezed towards:

    >>> card = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> squeeze = DensityField.squeeze(0.0, 1.0)
    >>> path = field_motion(card, squeeze, (0, 0.2, 0.4), mode="quasi-static", drag=(2, 2, 1))
    >>> path.outcome.name, path.final_pose.round(9)[1:] + 0.0
    ('REST', array([0., 0.]))
    """
    start, speed = as_array("pose", pose, 3), as_array("twist", twist, 3)
    check_choice("method", method, get_args(Method))
    count = as_count("frames", frames)
    problem = field_problem(part, field, start, speed, mode, drag, friction, load)
    limit = as_positive("duration", 60.0 * problem.time if duration is None else duration)
    if isinstance(load, LoadTable):
        LoadTable.of(load, limit)
    if method == "events":
        return field_ode(problem, start, speed, limit, as_positive("tolerance", tolerance), count)
    default = problem.time / _STEPS_PER_TIME
    longest = default if time_step is None else as_positive("time_step", time_step)
    steps = np.ceil(limit / longest * (1.0 - 1e-12))
    if steps > _MAX_STEPS:
        raise InputError("time_step", f"needs {steps:.3g} steps", value=longest, remedy="raise it")
    return _by_steps(problem, start, speed, limit / steps, int(steps), count)


def _by_steps(
    problem: FieldProblem, pose: Array, twist: Array, dt: float, steps: int, frames: int
) -> Trajectory:
    stride = max(1, steps // frames)
    whens = dt * np.arange(1, 2 if problem.steady else steps + 1)  # loads at the ends of the steps
    loads = np.array([problem.external(float(t)) for t in whens])
    rows = np.empty((steps // stride + 3, FRAME))
    velocity = twist if problem.inertial else np.zeros(3)
    rests, written, worst = field_steps(
        problem.body,
        problem.field.kernel_data,
        loads,
        (tuple(pose.tolist()), tuple(velocity.tolist())),
        (dt, steps, stride),
        CONTACT_SUM,
        (problem.rest_speed, problem.time),
        rows,
    )
    table = rows[:written]
    end = float(table[-1, 0])
    unit = np.sqrt(problem.mass[0] / dt + problem.drag[0]) / max(problem.force, 1e-300)
    return Trajectory(
        times=table[:, 0].copy(),
        poses=table[:, 1:4].copy(),
        twists=table[:, 4:7].copy(),
        loads=table[:, 7:10].copy(),
        error_bounds=table[:, 10].copy(),
        tips=np.zeros(written, dtype=np.int64),
        outcome=Outcome.REST if rests else Outcome.TIME_LIMIT,
        worst_error=float(worst * unit),
        energy=EnergyBalance(*table[:, ENERGIES:].T.copy()),
        events=(MotionEvent(end, EventKind.REST),) if rests else (),
    )
