"""Ideal force fields in the plane, for activations to realise.

A field is a function from points (..., 2) [m] to forces (..., 2), in units of the push of one
actuator; any such function will do.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_number

__all__ = [
    "Field",
    "elliptic_field",
    "radial_field",
    "skewed_squeeze_field",
    "squeeze_field",
    "uniform_field",
]

Array = NDArray[np.float64]
Field = Callable[[Array], Array]


def uniform_field(angle: float) -> Field:
    """Return the field that pushes along `angle` [rad] everywhere.

    Examples
    --------
    >>> uniform_field(0.0)(np.zeros((1, 2)))
    array([[1., 0.]])
    """
    way = _unit(angle)
    return lambda points: np.broadcast_to(way, np.shape(points)).copy()


def squeeze_field(line: float, offset: float = 0.0) -> Field:
    """Return the field that pushes towards a line at the angle `line`, `offset` [m] to its left.

    Zero on the line itself. 1994 paper, section 3, assumption BILATERAL SYMMETRY.

    Examples
    --------
    >>> squeeze_field(0.0)(np.array([[5.0, 2.0], [5.0, -2.0]])) + 0.0
    array([[ 0., -1.],
           [ 0.,  1.]])
    """
    return skewed_squeeze_field(line, 0.0, offset)


def skewed_squeeze_field(line: float, skew: float, offset: float = 0.0) -> Field:
    r"""Return a squeeze field whose pushes are turned by `skew` [rad] from the normal of the line.

    Opposite on the two sides, ``-sign(z) (sin skew, cos skew)`` in axes along and across the line:
    positive skew turns the pushes clockwise, and a part counter-clockwise, perhaps for ever (K.-F.
    Boehringer, B. R. Donald, N. C. MacDonald, *Programmable force fields for distributed
    manipulation*, Int. J. Robotics Research 18, 1999).
    """
    along, normal = _unit(line), _unit(line + 0.5 * np.pi)
    if not abs(as_number("skew", skew)) < 0.5 * np.pi:
        raise InputError("skew", "must lie between -pi/2 and pi/2", value=skew)
    if not np.isfinite(as_number("offset", offset)):
        raise InputError("offset", "must be finite", value=offset)
    push = np.sin(skew) * along + np.cos(skew) * normal

    def field(points: Array) -> Array:
        return np.asarray(-np.sign(points @ normal - offset)[..., None] * push)

    return field


def radial_field(center: ArrayLike = (0.0, 0.0)) -> Field:
    """Return the unit field towards a point; zero there."""
    middle = as_array("center", center, 2)

    def field(points: Array) -> Array:
        arm = middle - points
        length = np.linalg.norm(arm, axis=-1, keepdims=True)
        return np.asarray(np.divide(arm, length, out=np.zeros_like(arm), where=length > 0.0))

    return field


def elliptic_field(stiffness: ArrayLike, reach: float, axis: float = 0.0) -> Field:
    r"""Return minus the gradient of an elliptic potential.

    ``f = -(alpha x, beta y) / (max(alpha, beta) reach)`` in axes turned by `axis`, so that the
    push is one at `reach` along the stiffer axis, and longer pushes are cut to length one there
    and beyond. A part has one stable pose in it, up to its symmetry (L. E. Kavraki, *Part
    orientation with programmable vector fields: two stable equilibria for most parts*, ICRA 1997).

    Parameters
    ----------
    stiffness : (2,) float
        alpha and beta, positive; only their ratio counts.
    reach : float
        Distance of full push [m].
    axis : float
        Angle of the first axis [rad].

    Examples
    --------
    >>> elliptic_field((2.0, 1.0), 1e-3)(np.array([[5e-4, 5e-4]]))
    array([[-0.5 , -0.25]])
    """
    alpha, beta = (float(s) for s in as_array("stiffness", stiffness, 2))
    if not (min(alpha, beta) > 0.0 and np.isfinite(alpha + beta)):
        raise InputError("stiffness", "must be two positive numbers", value=(alpha, beta))
    if not (np.isfinite(reach) and reach > 0.0):
        raise InputError("reach", "must be positive", value=reach)
    e, n = _unit(axis), _unit(axis + 0.5 * np.pi)
    matrix = (alpha * np.outer(e, e) + beta * np.outer(n, n)) / (max(alpha, beta) * reach)

    def field(points: Array) -> Array:
        force = -np.asarray(points) @ matrix
        return np.asarray(force / np.maximum(np.linalg.norm(force, axis=-1, keepdims=True), 1.0))

    return field


def _unit(angle: float) -> Array:
    if not np.isfinite(as_number("angle", angle)):
        raise InputError("angle", "must be finite", value=angle)
    way = np.array([np.cos(angle), np.sin(angle)])
    way[np.abs(way) < 1e-15] = 0.0
    return way
