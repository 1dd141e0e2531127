r"""The limit surface of one Coulomb contact: its friction disk, mapped to loads.

A force f at r = (x, y) gives the load ``G f = (f_x, f_y, x f_y - y f_x)``. The disk of radius
``mu N`` becomes a flat ellipse, tilted by ``arctan |r|`` (paper, Figure 8).
"""

from __future__ import annotations

from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_number
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["contact_map", "coulomb_contact", "elliptic_contact", "polygonal_contact"]

Array = NDArray[np.float64]


def contact_map(position: ArrayLike) -> Array:
    """Return G (3, 2), which maps a force at `position` [m] to its load about the origin."""
    x, y = as_array("position", position, 2)
    return np.array([[1.0, 0.0], [0.0, 1.0], [-y, x]])


def coulomb_contact(position: ArrayLike, radius: float) -> Ellipsoid:
    """Return the limit surface of a contact with friction disk of a radius ``mu N`` [N].

    Examples
    --------
    >>> coulomb_contact([1.0, 0.0], 2.0).support([0.0, 0.0, 1.0])
    array(2.)
    """
    return Ellipsoid(np.zeros(3), _checked(radius) * contact_map(position))


def elliptic_contact(
    position: ArrayLike, half_axes: ArrayLike, direction: ArrayLike = (1.0, 0.0)
) -> Ellipsoid:
    """Return the limit surface of a contact whose friction depends on the direction.

    Parameters
    ----------
    position : (2,) float
        Contact [m].
    half_axes : (2,) float
        Largest forces along and across `direction` [N].
    direction : (2,) float
        A direction of symmetry.

    Examples
    --------
    >>> elliptic_contact([0.0, 0.0], [1.0, 3.0], [0.0, 1.0]).support([[1, 0, 0], [0, 1, 0]])
    array([3., 1.])
    """
    along, across = (_checked(float(a), "half_axes") for a in as_array("half_axes", half_axes, 2))
    e = as_array("direction", direction, 2)
    if not e.any():
        raise InputError("direction", "is zero", remedy="give a direction of symmetry")
    e = e / np.hypot(*e)
    forces = np.array([[along * e[0], -across * e[1]], [along * e[1], across * e[0]]])
    return Ellipsoid(np.zeros(3), contact_map(position) @ forces)


def polygonal_contact(
    position: ArrayLike, radius: float, sides: int, *, outside: bool = False
) -> tuple[VPolytope, float]:
    """Return a contact with a regular polygon instead of the disk, and its error.

    Parameters
    ----------
    position : (2,) float
        Contact [m].
    radius : float
        Radius ``mu N`` of the disk [N].
    sides : int
        Sides of the polygon, at least 3.
    outside : bool
        Put the polygon around the disk, not into it.

    Returns
    -------
    polytope : VPolytope
        Inside or outside approximation of `coulomb_contact`.
    error : float
        Hausdorff distance of the two in load space: ``radius (1 - cos(pi/n))``, or outside
        ``radius (1/cos(pi/n) - 1)``, times the largest stretch ``sqrt(1 + |r|^2)`` of G.
    """
    if not isinstance(sides, Integral) or sides < 3:
        raise InputError("sides", "must be a whole number from 3 on", value=sides)
    half = np.pi / sides
    reach = _checked(radius) / (np.cos(half) if outside else 1.0)
    angles = 2 * half * np.arange(sides)
    forces = reach * np.column_stack([np.cos(angles), np.sin(angles)])
    G = contact_map(position)
    error = (reach - radius) if outside else radius * (1.0 - np.cos(half))
    return VPolytope(forces @ G.T), float(error * np.linalg.norm(G, 2))


def _checked(radius: float, name: str = "radius") -> float:
    if not (np.isfinite(as_number(name, radius)) and radius >= 0.0):
        raise InputError(name, "must be at least 0", value=radius)
    return float(radius)
