"""Parts that are pushed at one point, slowly, against the friction of their supports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.kernels.push import NODE, push_balance, push_path
from limitsurf.motion.rigid_motion import to_world
from limitsurf.motion.trajectory import EnergyBalance, Outcome, Trajectory
from limitsurf.sets.arguments import as_array, as_count
from limitsurf.sets.contact_sum import ContactSum

__all__ = ["Push", "push", "push_along"]

Array = NDArray[np.float64]

_ROUNDING = 1e-15


@dataclass(frozen=True, eq=False)
class Push:
    """What a push at one point does to a part at rest on its contacts.

    Attributes
    ----------
    twist : (3,) float
        Velocity of the part: the pushed point moves as prescribed [m/s, m/s, rad/s].
    load : (3,) float
        Load of the contacts on the part, about its reference point [N, N, N m].
    force : (2,) float
        Force of the pusher on the part [N].
    power : float
        What friction dissipates [W].
    error_bound : float
        Certified error of the force along the push [N]: what `power` and the work of the forces
        differ by, over the speed.
    """

    twist: Array
    load: Array
    force: Array
    power: float
    error_bound: float

    def __repr__(self) -> str:
        """Return the twist and the size of the force."""
        v = np.array2string(self.twist, precision=4, separator=", ")
        return f"Push(twist {v}, force {float(np.hypot(*self.force)):.4g} N)"


def push(contacts: ContactSet, point: ArrayLike, velocity: ArrayLike) -> Push:
    r"""Return how a part moves that is pushed, quasi-statically, at a point that sticks.

    Of all motions in which the point has the velocity u, the part takes the one in which friction
    dissipates least:

    .. math:: \omega = \arg\min_\omega h_L(-v), \quad
              v = (u_x + \omega r_y, u_y - \omega r_x, \omega)

    Parameters
    ----------
    contacts : ContactSet
        Contacts of the part, disks or ellipses. Friction coefficients scale out of the motion.
    point : (2,) float
        Pushed point r, from the reference point [m].
    velocity : (2,) float
        Its velocity u [m/s].

    Returns
    -------
    Push
        Where several rates are minimal, such as with all contacts under the point, with the least.

    Raises
    ------
    InputError
        Polygons; active contacts that turn the part faster and faster about the point.

    Notes
    -----
    The minimum is found to neighbouring floats. The forces are those of the minimum, also where
    a contact is the centre of rotation (M. A. Peshkin, A. C. Sanderson, IEEE J. Robotics and
    Automation 4, 1988).

    Examples
    --------
    A bar on two feet, pushed across at one of them, turns about the other:

    >>> bar = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.5)
    >>> push(bar, [1.0, 0.0], [0.0, 0.2])
    Push(twist [0. , 0.1, 0.1], force 0.5 N)
    """
    r, u = as_array("point", point, 2), as_array("velocity", velocity, 2)
    levers, n = _levers(contacts, r)
    omega, power, fx, fy, moment = push_balance(levers, n, *u)
    load = _loads(contacts, r, np.array([fx, fy, moment]))
    twist = np.array([u[0] + omega * r[1], u[1] - omega * r[0], omega])
    gap = power - (omega * n - fx * u[0] - fy * u[1])
    bound = gap / float(np.hypot(*u)) if gap > 0.0 else 0.0
    return Push(twist, load, -load[:2], power, bound)


def push_along(
    contacts: ContactSet,
    path: ArrayLike,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    *,
    times: ArrayLike | None = None,
    steps: int = 4,
) -> Trajectory:
    """Push a part along a path that one of its points follows.

    Parameters
    ----------
    contacts : ContactSet
        Contacts in the body frame, about the centre of mass; see `push`.
    path : (k, 2) float
        Places of the pushed point, joined by segments [m]. The first, with the pose, says which
        point of the part it is.
    pose : (3,) float
        Start ``(x, y, theta)`` [m, m, rad].
    times : (k,) float, optional
        When the point is there [s], rising; without, the path takes 1 s a segment. The motion does
        not depend on it.
    steps : int
        Runge-Kutta steps of order four on each segment. Where a contact becomes or ceases to be the
        centre of rotation, the rate has a kink, and the order drops to two.

    Returns
    -------
    Trajectory
        Poses at the places of the path; error bounds are those of the pusher's force along it, and
        the work is that of pusher and active contacts.

    Examples
    --------
    A caster, pulled across, falls in behind on a tractrix, ``tan(phi/2) = exp(-s/d) tan(phi_0/2)``:

    >>> caster = ContactSet([[0.0, 0.0]], 1.0)
    >>> path = np.linspace([0.0, 0.1], [0.3, 0.1], 31)  # pulled at (0, 0.1)
    >>> push_along(caster, path).poses[[0, 10, 20, 30], 2].round(4)
    array([ 0.    , -0.8658, -1.3018, -1.4713])
    >>> (2 * np.arctan(np.exp([0.0, -1.0, -2.0, -3.0])) - np.pi / 2).round(4)
    array([ 0.    , -0.8658, -1.3018, -1.4713])
    """
    places, start = as_array("path", path, None, 2), as_array("pose", pose, 3)
    if len(places) == 0:
        raise InputError("path", "is empty", remedy="give places of the pushed point")
    moments = _times(times, len(places))
    arm = np.array([*(places[0] - start[:2]), 0.0])
    r = to_world(arm, -start[2])[:2]
    count, nodes = as_count("steps", steps), np.empty((len(places), NODE))
    worst = push_path(*_levers(contacts, r), np.array(places), float(start[2]), count, nodes)
    return _record(contacts, r, places, moments, nodes, worst)


def _record(
    contacts: ContactSet, r: Array, places: Array, times: Array, nodes: Array, worst: float
) -> Trajectory:
    theta, count = nodes[:, 0], len(nodes)
    arms = to_world(np.array([*r, 0.0]), theta)[:, :2]
    speed = np.zeros(count)
    u = np.zeros((count, 2))
    if count > 1:
        speed = 1.0 / np.diff(times, append=2 * times[-1] - times[-2])
        u = np.diff(places, axis=0, append=2 * places[-1:] - places[-2:-1]) * speed[:, None]
    omega = nodes[:, 1] * speed
    size = contacts.radius.sum() + np.hypot(*contacts.offset.T).sum()
    zero = np.zeros(count)
    return Trajectory(
        times=times,
        poses=np.column_stack([places - arms, theta]),
        twists=np.column_stack([u[:, 0] + omega * arms[:, 1], u[:, 1] - omega * arms[:, 0], omega]),
        loads=to_world(_loads(contacts, r, nodes[:, 3:6]), theta),
        error_bounds=np.full(count, worst),
        tips=np.full(count, len(contacts)),
        outcome=Outcome.TIME_LIMIT,
        worst_error=worst / float(size) if worst > 0.0 else 0.0,
        energy=EnergyBalance(zero, nodes[:, 6], nodes[:, 7], zero, zero),
    )


def _times(times: ArrayLike | None, count: int) -> Array:
    if times is None:
        return np.arange(count, dtype=np.float64)
    moments = as_array("times", times, count)
    if (np.diff(moments) <= 0.0).any():
        raise InputError("times", "do not rise", remedy="sort the places of the path by time")
    return moments


def _levers(contacts: ContactSet, r: Array) -> tuple[Array, float]:
    """Return the rows that `push_rate` takes, and the moment of the offsets about r."""
    if not isinstance(contacts, ContactSet):
        raise InputError("contacts", "is no ContactSet", value=contacts)
    surface = contacts.limit_surface()
    if not isinstance(surface, ContactSum):
        raise InputError("contacts", "are polygons", remedy="push needs disks or ellipses")
    count, d = len(contacts), contacts.position - r
    disks = np.tile([1.0, 0.0, 1.0], (count, 1))
    a, b, e = (disks if surface.stretch is None else surface.stretch).T
    wx, wy = b * d[:, 0] - a * d[:, 1], e * d[:, 0] - b * d[:, 1]
    fx, fy, moment = contacts.offset_load
    n = float(moment - (r[0] * fy - r[1] * fx))
    noise = _ROUNDING * (abs(moment) + abs(r[0] * fy) + abs(r[1] * fx))
    if abs(n) > noise and abs(n) >= contacts.radius @ np.hypot(wx, wy):
        raise InputError(
            "contacts",
            f"turn the part about the pushed point with {n:.3g} N m, which friction does not stop",
            remedy="raise their friction radii or lower the offsets",
        )
    return np.stack([wx, wy, contacts.radius, a, b, e]), n


def _loads(contacts: ContactSet, r: Array, friction: Array) -> Array:
    """Return the loads (..., 3) of the contacts about the reference point, body axes.

    `friction` is force, and moment about the pushed point.
    """
    fx, fy, moment = np.moveaxis(friction, -1, 0)
    load = np.stack([fx, fy, moment + r[0] * fy - r[1] * fx], axis=-1)
    return np.asarray(load + contacts.offset_load)
