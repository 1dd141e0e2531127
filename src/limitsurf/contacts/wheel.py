"""Wheels, rolling freely or driven."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.coulomb import contact_map
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_number
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.sections import Section, limit_curve

__all__ = ["Wheel"]

Array = NDArray[np.float64]


class Wheel:
    r"""A wheel under a part: easy to push along, hard to push sideways (paper, Figure 7).

    The forces that it can exert on the part are an ellipse,

    .. math:: a + \{ s\, F_b e + t\, \mu N e_\perp : s^2 + t^2 \le 1 \}, \quad
              a = \operatorname{clip}(\tau / r, -\mu N, \mu N)\, e

    Parameters
    ----------
    position : (2,) float
        Point of contact, from the part's reference point [m].
    direction : (2,) float
        Rolling direction; made a unit vector e.
    radius : float
        Radius r of the wheel [m].
    normal_force, mu : float
        Load N [N] and coefficient of friction: the traction is ``mu N``.
    bearing_friction : float
        Force F_b at the rim that turns the wheel against its bearing [N]; more than ``mu N`` counts
        as ``mu N``: the wheel is blocked. 0 makes the ellipse a segment.
    torque : float
        Driving torque [N m]; positive pushes the part along `direction`.

    Notes
    -----
    A torque shifts the limit curve by ``tau/r`` along e (Figure 7b), by no more than ``mu N``: then
    the wheel spins. The load nearest to the origin, with which a driven part sets off, is the shift
    less the bearing friction. The paper's curve is shifted without changing its shape; near the
    largest shift it holds forces a little longer than ``mu N`` to the sides, which a wheel that
    may slip in any direction does not have.

    Examples
    --------
    >>> wheel = Wheel([0, 0], [0, 1], 0.01, 2.0, 0.5, bearing_friction=0.1, torque=0.004)
    >>> wheel.drive
    array([0. , 0.4])
    >>> wheel.limit_surface().project([0.0, 0.0, 0.0]).point.round(12)
    array([0. , 0.3, 0. ])
    """

    def __init__(
        self,
        position: ArrayLike,
        direction: ArrayLike,
        radius: float,
        normal_force: float,
        mu: float,
        *,
        bearing_friction: float = 0.0,
        torque: float = 0.0,
    ) -> None:
        self.position = as_array("position", position, 2)
        e = as_array("direction", direction, 2)
        length = np.hypot(*e)
        if length == 0.0:
            raise InputError("direction", "is zero", remedy="say where the wheel rolls")
        self.direction = np.asarray(e / length)
        if not (np.isfinite(as_number("radius", radius)) and radius > 0.0):
            raise InputError("radius", "must be positive", value=radius)
        self.radius = float(radius)
        self.traction = _positive("mu", mu) * _positive("normal_force", normal_force)
        self.bearing_friction = min(_positive("bearing_friction", bearing_friction), self.traction)
        if not np.isfinite(as_number("torque", torque)):
            raise InputError("torque", "must be a finite number", value=torque)
        self.torque = float(torque)

    @property
    def drive(self) -> Array:
        """Shift a (2,) of the limit curve [N]."""
        push = min(max(self.torque / self.radius, -self.traction), self.traction)
        return push * self.direction

    @cached_property
    def _shape(self) -> Array:
        """Half axes (2, 2) of the ellipse of forces, one a column."""
        e = self.direction
        across = np.array([-e[1], e[0]])
        return np.column_stack([self.bearing_friction * e, self.traction * across])

    def limit_surface(self) -> Ellipsoid:
        """Return the loads that the wheel can exert on the part."""
        G = contact_map(self.position)
        return Ellipsoid(G @ self.drive, G @ self._shape)

    def limit_curve(self, tol: float = 1e-4) -> Section:
        """Return the forces, without moment about the contact itself (Figure 7)."""
        G = contact_map([0.0, 0.0])
        return limit_curve(Ellipsoid(G @ self.drive, G @ self._shape), tol=tol)

    def contact_set(self) -> ContactSet:
        """Return the wheel as one anisotropic contact."""
        if self.traction == 0.0:
            return ContactSet(self.position[None], 0.0)
        e, share = self.direction, self.bearing_friction / self.traction
        E = np.eye(2) + (share - 1.0) * np.outer(e, e)
        return ContactSet(self.position[None], self.traction, self.drive[None], ellipse=E[None])

    def __repr__(self) -> str:
        """Return traction, bearing friction and drive."""
        drive = f", driven by {self.torque:.4g} N m" if self.torque else ""
        return (
            f"Wheel(traction {self.traction:.4g} N, bearing {self.bearing_friction:.4g} N{drive})"
        )


def _positive(name: str, value: float) -> float:
    if not (np.isfinite(as_number(name, value)) and value >= 0.0):
        raise InputError(name, "must be at least 0", value=value)
    return float(value)
