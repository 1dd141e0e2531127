"""Soft contacts: a small area that also resists spinning."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.coulomb import contact_map
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_number
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.sections import Section, limit_curve

__all__ = ["SoftContact"]

Array = NDArray[np.float64]


class SoftContact:
    r"""A contact with spin torque: an ellipsoid with half axes ``(mu N, mu N, spin_torque)``.

    About the contact itself its loads are
    :math:`(f_x^2 + f_y^2)/(\mu N)^2 + m^2/\tau_s^2 \le 1`; a force f gives the moment
    ``x fy - y fx`` about the part's reference point besides.

    Parameters
    ----------
    position : (2,) float
        Centre of the contact, from the part's reference point [m].
    normal_force, mu : float
        Load N [N] and coefficient of friction.
    spin_torque : float
        Largest torque about the normal through the contact [N m]. For a disk of radius a:
        ``2/3 a mu N`` at uniform pressure, ``3 pi/16 a mu N`` at Hertz pressure.

    Notes
    -----
    The ellipsoid stands for the true limit surface of a small area of contact, which
    `PressurePatch` computes.

    Examples
    --------
    >>> finger = SoftContact([1.0, 0.0], 2.0, 0.5, 0.3)
    >>> finger.limit_surface().support([[0.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
    array([1. , 0.3])
    """

    def __init__(
        self, position: ArrayLike, normal_force: float, mu: float, spin_torque: float
    ) -> None:
        self.position = as_array("position", position, 2)
        given = {"normal_force": normal_force, "mu": mu, "spin_torque": spin_torque}
        for name, value in given.items():
            if not (np.isfinite(as_number(name, value)) and value >= 0.0):
                raise InputError(name, "must be at least 0", value=value)
        self.traction, self.spin_torque = float(mu) * float(normal_force), float(spin_torque)

    def limit_surface(self) -> Ellipsoid:
        """Return the loads that the contact can exert on the part."""
        return self._about(self.position)

    def limit_curve(self, tol: float = 1e-4) -> Section:
        """Return the forces without moment about the contact itself: a disk."""
        return limit_curve(self._about(np.zeros(2)), tol=tol)

    def _about(self, position: Array) -> Ellipsoid:
        axes = np.zeros((3, 3))
        axes[:, :2] = self.traction * contact_map(position)
        axes[2, 2] = self.spin_torque
        return Ellipsoid(np.zeros(3), axes)

    def __repr__(self) -> str:
        """Return traction and spin torque."""
        return f"SoftContact(traction {self.traction:.4g} N, spin {self.spin_torque:.4g} N m)"
