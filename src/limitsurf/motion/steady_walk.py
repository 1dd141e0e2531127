"""A walker whose feet push the same way all the time: a straight line or a circle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.friction_load import friction_load
from limitsurf.errors import InputError
from limitsurf.motion.rigid_motion import compose, displacement
from limitsurf.sets.arguments import as_array
from limitsurf.sets.projection import Projection

__all__ = ["SteadyWalk", "steady_walk"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SteadyWalk:
    """The motion of a walker, constant in the frame of its body.

    Attributes
    ----------
    twist : (3,) float
        Velocity of the reference point and of rotation, body axes [m/s, m/s, rad/s].
    load : (3,) float
        Load of the ground on the feet, about the reference point, body axes [N, N, N m].
    held : bool
        Whether the walker stays where it is: minus the external load lies in the limit surface.
    powers : (3,) float
        Power of pushes and external load, and what friction and drag dissipate of it [W].
    error_bound, relative_error : float
        Certified error of the load [N], moments over the drag's radius ``sqrt(D_m / D_f)``, and the
        same over the sum of all forces.
    feet : int
        Number of contacts.
    projection : Projection
        The closest point behind it, with status and certificate.
    """

    twist: Array
    load: Array
    held: bool
    powers: Array
    error_bound: float
    relative_error: float
    feet: int
    projection: Projection

    @property
    def center(self) -> Array | None:
        """Center of rotation (2,) in the body frame [m]; None on a straight line or if held."""
        vx, vy, omega = self.twist
        return np.array([-vy, vx]) / omega if omega != 0.0 else None

    @property
    def radius(self) -> float:
        """Radius of the reference point's circle [m]; inf on a straight line, nan if held."""
        if self.held:
            return float(np.nan)
        vx, vy, omega = self.twist
        return float(np.hypot(vx, vy) / abs(omega)) if omega != 0.0 else float(np.inf)

    def poses(self, times: ArrayLike, start: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
        """Return the exact poses (..., 3) at times (...) [s] after a start pose.

        Examples
        --------
        >>> walker = steady_walk(ContactSet([[0.0, 1.0]], 0.0, [[1.0, 0.0]]), (1.0, 1.0, 2.0))
        >>> walker.poses(np.pi).round(12)  # a quarter turn about (0, -2)
        array([ 2.        , -2.        , -1.57079633])
        """
        moments = as_array("times", times, *np.shape(times))
        return compose(as_array("start", start, 3), displacement(self.twist, moments))

    def __repr__(self) -> str:
        """Return how it moves."""
        if self.held:
            return "SteadyWalk(held)"
        speed = float(np.hypot(*self.twist[:2]))
        turn = "" if self.twist[2] == 0.0 else f", {self.twist[2]:.4g} rad/s"
        return f"SteadyWalk({speed:.4g} m/s{turn})"


def steady_walk(
    contacts: ContactSet,
    drag: ArrayLike = (1.0, 1.0, 1.0),
    load: ArrayLike = (0.0, 0.0, 0.0),
) -> SteadyWalk:
    r"""Return how a body walks on feet that are fixed to it (the paper's "upside-down" array).

    .. math:: D v = F_{ext} + F, \qquad F = \arg\min_{F \in L} |F + F_{ext}|_{D^{-1}}

    L, the loads that the ground can exert on the body through the feet, moves with the body.
    So do F and v: without an external load, F is the point of L nearest to the origin, and the
    walker is held if L contains the origin.

    Parameters
    ----------
    contacts : ContactSet
        Feet in the body frame, with the pushes of the ground on the active ones as offsets.
    drag : (3,) float
        Viscous drag D > 0 of the body [N s/m, N s/m, N m s]. ``(1, 1, 1)`` is the paper's motion
        prediction, velocity equal to force.
    load : (3,) float
        External load fixed to the body [N, N, N m]. A load fixed to the world, such as gravity on a
        slope, turns with respect to the feet: `simulate` does that.

    Raises
    ------
    InputError
        Feet that are no `ContactSet`; drag that is not positive.

    Examples
    --------
    Two feet that push forwards with 1 N, the left one against friction of a passive third foot:

    >>> feet = [[0.0, 1.0], [0.0, -1.0], [0.0, 1.0]]
    >>> pushes = [[1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]
    >>> walker = steady_walk(ContactSet(feet, [0.0, 0.0, 0.5], pushes), (2.0, 2.0, 2.0))
    >>> walker
    SteadyWalk(0.75 m/s, 0.25 rad/s)
    >>> round(walker.radius, 12)
    3.0
    """
    if not isinstance(contacts, ContactSet):
        raise InputError("contacts", "is no ContactSet", value=contacts, remedy="give feet as one")
    D = as_array("drag", drag, 3)
    if (D <= 0.0).any():
        raise InputError("drag", "must be positive", value=drag, remedy="it sets the speed")
    external = as_array("load", load, 3)
    found = friction_load(contacts, external, 1.0 / D)
    v, F = found.twist, found.friction
    push = contacts.offset_load
    unit = float(np.sqrt(D[:2].max()))
    bound = unit * float(found.projection.error_bound)
    size = contacts.radius.sum() + np.hypot(*contacts.offset.T).sum()
    size += unit * np.sqrt((external * external / D).sum())
    return SteadyWalk(
        twist=v,
        load=F,
        held=bool(found.sticks),
        powers=np.array([(push + external) @ v, (push - F) @ v, D @ (v * v)]),
        error_bound=bound,
        relative_error=bound / float(size) if bound > 0.0 else 0.0,
        feet=len(contacts),
        projection=found.projection,
    )
