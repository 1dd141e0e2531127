"""Continuum force fields: piecewise-linear densities, and their exact loads on parts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import g

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.actuators.density_piece import DensityPiece, finite
from limitsurf.actuators.density_traits import (
    centers_of,
    flat_directions,
    known_convex,
    turning_bound,
)
from limitsurf.actuators.potential_field import ConvexField, FieldSum
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.density import JACOBIAN, POTENTIAL, STATE, Pieces, density_states
from limitsurf.sets.arguments import as_array, as_number, as_points

__all__ = ["DensityField", "push_density"]

Array = NDArray[np.float64]

_EVERYWHERE = np.empty((0, 2))


class DensityField:
    r"""A piecewise-linear force density over the plane [N/m^2].

    Regions are convex and should not overlap: where they do, densities add up; where there is
    none, the density is zero. Loads are exact integrals over a part, to rounding.

    Parameters
    ----------
    pieces : iterable of DensityPiece
        What pushes where.

    Examples
    --------
    A square of side 2 m, 0.1 m to the left of the line, is pushed back by the difference of areas,
    and left alone on the line:

    >>> part = Part([(0, 0), (2, 0), (2, 2), (0, 2)])
    >>> squeeze = DensityField.squeeze(0.0, 1.0)
    >>> squeeze.load(part, (0.0, 0.1, 0.0)).round(12) + 0.0
    array([ 0. , -0.4,  0. ])
    >>> float(squeeze.potential(part, (0.0, 0.0, 0.0)).round(12))
    2.0

    On points it is a field as in `force_fields`, in [N/m^2]:

    >>> squeeze(np.array([[5.0, 2.0], [5.0, -2.0]])) + 0.0
    array([[ 0., -1.],
           [ 0.,  1.]])
    """

    def __init__(self, pieces: Iterable[DensityPiece]) -> None:
        self._pieces = tuple(pieces)
        if not self._pieces:
            raise InputError("pieces", "are none", remedy="give one, perhaps of zero density")
        for piece in self._pieces:
            if not isinstance(piece, DensityPiece):
                raise InputError("pieces", "hold one that is no DensityPiece", value=piece)

    @classmethod
    def uniform(cls, angle: float, density: float) -> DensityField:
        """Return the same push along `angle` [rad] everywhere, of a density [N/m^2]."""
        return cls([DensityPiece(finite("density", density) * _unit(angle), level=0.0)])

    @classmethod
    def squeeze(cls, line: float, density: float, offset: float = 0.0) -> DensityField:
        """Return pushes towards a line at the angle `line` [rad], `offset` [m] to its left.

        1994 paper, section 3, assumption BILATERAL SYMMETRY.
        """
        return cls.skewed_squeeze(line, 0.0, density, offset)

    @classmethod
    def skewed_squeeze(
        cls, line: float, skew: float, density: float, offset: float = 0.0
    ) -> DensityField:
        """Return a squeeze whose pushes are turned by `skew` [rad] from the normal of the line.

        Positive skew turns the pushes clockwise, and a part counter-clockwise. Without potential
        unless the skew is zero; see `force_fields.skewed_squeeze_field`.
        """
        along, normal = _unit(line), _unit(line + 0.5 * np.pi)
        if not abs(finite("skew", skew)) < 0.5 * np.pi:
            raise InputError("skew", "must lie between -pi/2 and pi/2", value=skew)
        push = finite("density", density) * (np.sin(skew) * along + np.cos(skew) * normal)
        z, level = finite("offset", offset), 0.0 if skew == 0.0 else None
        left = DensityPiece(-push, anchor=z * normal, normals=[-normal], bounds=[-z], level=level)
        right = DensityPiece(push, anchor=z * normal, normals=[normal], bounds=[z], level=level)
        return cls([left, right])

    @classmethod
    def linear(cls, stiffness: ArrayLike, center: ArrayLike = (0.0, 0.0)) -> DensityField:
        """Return the density ``-K (x - center)``, K a number or (2, 2) [N/m^3].

        A multiple of the identity pulls the centroid to the center without moment; a symmetric K
        has a potential, an elliptic one turns parts.
        """
        scalar = np.ndim(stiffness) == 0
        K = as_number("stiffness", stiffness) * np.eye(2) if scalar else stiffness
        K = as_array("stiffness", K, 2, 2)
        if np.ptp([K[0, 1], K[1, 0]]) <= 1e-14 * np.abs(K).max():  # rounding apart
            K = 0.5 * (K + K.T)
        level = 0.0 if K[0, 1] == K[1, 0] else None
        return cls([DensityPiece((0.0, 0.0), slope=-K, anchor=center, level=level)])

    @property
    def pieces(self) -> tuple[DensityPiece, ...]:
        """The pieces."""
        return self._pieces

    @property
    def has_potential(self) -> bool:
        """Whether loads are minus the gradient of a potential."""
        return all(piece.level is not None for piece in self._pieces)

    @cached_property
    def convex(self) -> bool:
        """Whether the potential is known to be convex in the position of any part."""
        return self.has_potential and known_convex(self._pieces)

    @property
    def flat(self) -> Array:
        """Orthonormal directions (d, 2) in which the density does not change."""
        return flat_directions(self._pieces)

    @property
    def centers(self) -> Array:
        """Anchors (c, 2) of the pieces that change from place to place [m]."""
        return centers_of(self._pieces)

    def turning_bound(self, part: Part, center: ArrayLike | None, reach: float) -> float:
        """Return a bound on the second derivative of the potential; see `ConvexField`."""
        about = None if center is None else as_array("center", center, 2)
        return turning_bound(self._pieces, part, about, reach)

    def __add__(self, other: ConvexField) -> FieldSum:
        """Return the sum with another field."""
        return FieldSum(self, other)

    def scaled(self, factor: float) -> DensityField:
        """Return the field times a number.

        ``field.scaled(1 / push_density(part, array))`` gives pushes in units of an actuator's, for
        `activate` and `realise`.
        """
        by = finite("factor", factor)
        return DensityField(
            replace(
                piece,
                force=by * piece.force,
                slope=by * piece.slope,
                level=None if piece.level is None else by * piece.level,
            )
            for piece in self._pieces
        )

    def __call__(self, points: ArrayLike) -> Array:
        """Return densities (..., 2) at points (..., 2); on a border the mean of its sides."""
        rows, shape = as_points("points", points, 2)
        total = np.zeros_like(rows)
        for piece in self._pieces:
            inner = piece.bounds - rows @ piece.normals.T
            share = np.heaviside(inner, 0.5).prod(axis=1)
            density = piece.force + (rows - piece.anchor) @ piece.slope.T
            total += share[:, None] * density
        return total.reshape(*shape, 2)

    def load(self, part: Part, pose: ArrayLike) -> Array:
        """Return loads (..., 3) on a part at poses (..., 3), about its centre of mass [N, N m]."""
        return self.states(part, pose)[..., :POTENTIAL]

    def jacobian(self, part: Part, pose: ArrayLike) -> Array:
        """Return the derivatives (..., 3, 3) of `load` with respect to the poses.

        Row by row those of force and moment, columns for x, y and theta. Of one side where an edge
        of the part lies along a border.
        """
        states = self.states(part, pose)
        return states[..., JACOBIAN:].reshape(*states.shape[:-1], 3, 3)

    def potential(self, part: Part, pose: ArrayLike) -> Array:
        """Return the potential (...) of a part at poses (..., 3) [J]; minus its gradient is `load`.

        That of a squeeze is its density times ``integral |distance to the line| dA``.

        Raises
        ------
        InputError
            The field has none.
        """
        if not self.has_potential:
            raise InputError(
                "field", "has no potential", remedy="skews have none; give pieces a level"
            )
        return self.states(part, pose)[..., POTENTIAL]

    @cached_property
    def kernel_data(self) -> Pieces:
        """What the kernels take."""
        normals = [piece.normals for piece in self._pieces]
        return Pieces(
            np.cumsum([0, *map(len, normals)], dtype=np.int32),
            np.vstack([_EVERYWHERE, *normals]),
            np.concatenate([piece.bounds for piece in self._pieces]),
            np.array([piece.anchor for piece in self._pieces]),
            np.array([piece.force for piece in self._pieces]),
            np.array([piece.slope for piece in self._pieces]),
            np.array([piece.level or 0.0 for piece in self._pieces]),
        )

    def states(self, part: Part, pose: ArrayLike) -> Array:
        """Return load, potential and Jacobian by rows, (..., 13), in one go."""
        poses, shape = as_points("pose", pose, 3)
        states = np.empty((len(poses), STATE))
        density_states(part.edges, poses, self.kernel_data, states)
        return states.reshape(*shape, STATE)

    def __repr__(self) -> str:
        """Return the number of pieces."""
        return f"DensityField({len(self._pieces)} pieces)"


def push_density(part: Part, array: ActuatorArray) -> float:
    r"""Return the density [N/m^2] with which running actuators push a part that they carry.

    Push over weight times weight over area, :math:`\mu\, a\, \sigma g`, with `offset_fraction` a
    and areal density :math:`\sigma`: fewer actuators carry more each.
    """
    return float(array.pixel.friction * array.pixel.offset_fraction * part.mass / part.area * g)


def _unit(angle: float) -> Array:
    finite("angle", angle)
    way = np.array([np.cos(angle), np.sin(angle)])
    way[np.abs(way) < 1e-15] = 0.0
    return way
