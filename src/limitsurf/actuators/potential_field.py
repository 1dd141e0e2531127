"""What a force field with a potential offers, and sums of fields."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part

__all__ = ["ConvexField", "FieldSum", "LoadField"]

Array = NDArray[np.float64]


class LoadField(Protocol):
    """A force density with exact loads on parts, at poses (..., 3) [m, m, rad]."""

    @property
    def has_potential(self) -> bool:
        """Whether loads are minus the gradient of a potential."""
        ...

    def load(self, part: Part, pose: ArrayLike) -> Array:
        """Return loads (..., 3) about the centre of mass [N, N m]."""
        ...

    def jacobian(self, part: Part, pose: ArrayLike) -> Array:
        """Return the derivatives (..., 3, 3) of `load` with respect to the poses."""
        ...

    def potential(self, part: Part, pose: ArrayLike) -> Array:
        """Return the potential (...) [J]; minus its gradient is `load`."""
        ...


@runtime_checkable
class ConvexField(LoadField, Protocol):
    """A field that says more about itself, so that equilibria can be found with certainty."""

    @property
    def convex(self) -> bool:
        """Whether the potential is known to be convex in the position of any part."""
        ...

    @property
    def flat(self) -> Array:
        """Orthonormal directions (d, 2) in which the density does not change."""
        ...

    @property
    def centers(self) -> Array:
        """Points (c, 2) about which the field is built [m]; none if it is the same everywhere."""
        ...

    def states(self, part: Part, pose: ArrayLike) -> Array:
        """Return load, potential and Jacobian by rows, (..., 13), in one go."""
        ...

    def turning_bound(self, part: Part, center: ArrayLike | None, reach: float) -> float:
        """Return a bound on the second derivative of the potential under turns about a point [J].

        For parts whose centre of mass is at most `reach` [m] from the point; with None under
        turns about the centre of mass itself, wherever it is. Infinite if unknown.
        """
        ...


class FieldSum:
    """The sum of fields: loads, derivatives and potentials add up.

    Written ``field + other``.

    Parameters
    ----------
    *fields : DensityField, RadialField, FieldSum, or any field with the same methods
        The terms.

    Examples
    --------
    >>> from limitsurf.actuators.density_field import DensityField
    >>> from limitsurf.actuators.radial_density import RadialField
    >>> field = RadialField(2.0) + DensityField.uniform(0.0, 1.0)
    >>> square = Part([(0, 0), (2, 0), (2, 2), (0, 2)])
    >>> field.load(square, (0.0, 0.0, 0.0)).round(12) + 0.0
    array([4., 0., 0.])
    """

    def __init__(self, *fields: ConvexField) -> None:
        terms: list[ConvexField] = []
        for field in fields:
            if not isinstance(field, ConvexField):
                raise InputError("fields", "hold one without loads and potentials", value=field)
            terms += field.fields if isinstance(field, FieldSum) else [field]
        if not terms:
            raise InputError("fields", "are none", remedy="give one")
        self._fields = tuple(terms)

    @property
    def fields(self) -> tuple[ConvexField, ...]:
        """The terms; none is a sum itself."""
        return self._fields

    @property
    def has_potential(self) -> bool:
        """Whether every term has a potential."""
        return all(field.has_potential for field in self._fields)

    @property
    def convex(self) -> bool:
        """Whether every term is known to be convex."""
        return all(field.convex for field in self._fields)

    @property
    def flat(self) -> Array:
        """Directions in which no term changes: those that every term's span contains."""
        across = [np.eye(2) - field.flat.T @ field.flat for field in self._fields]
        _, size, ways = np.linalg.svd(np.vstack(across))
        return np.asarray(ways[size < 1e-9])

    @property
    def centers(self) -> Array:
        """The centres of all terms."""
        return np.vstack([field.centers for field in self._fields])

    def turning_bound(self, part: Part, center: ArrayLike | None, reach: float) -> float:
        """Return the sum of the bounds of the terms; see `ConvexField`."""
        return float(sum(field.turning_bound(part, center, reach) for field in self._fields))

    def states(self, part: Part, pose: ArrayLike) -> Array:
        """Return load, potential and Jacobian by rows, (..., 13), in one go."""
        return np.asarray(sum(field.states(part, pose) for field in self._fields))

    def load(self, part: Part, pose: ArrayLike) -> Array:
        """Return loads (..., 3) on a part at poses (..., 3), about its centre of mass [N, N m]."""
        return np.asarray(sum(field.load(part, pose) for field in self._fields))

    def jacobian(self, part: Part, pose: ArrayLike) -> Array:
        """Return the derivatives (..., 3, 3) of `load` with respect to the poses."""
        return np.asarray(sum(field.jacobian(part, pose) for field in self._fields))

    def potential(self, part: Part, pose: ArrayLike) -> Array:
        """Return the potential (...) of a part at poses (..., 3) [J].

        Raises
        ------
        InputError
            A term has none.
        """
        return np.asarray(sum(field.potential(part, pose) for field in self._fields))

    def scaled(self, factor: float) -> FieldSum:
        """Return the field times a number; every term must offer `scaled`."""
        return FieldSum(*(field.scaled(factor) for field in self._fields))  # type: ignore[attr-defined]

    def __call__(self, points: ArrayLike) -> Array:
        """Return densities (..., 2) at points (..., 2); every term must be callable."""
        return np.asarray(sum(field(points) for field in self._fields))  # type: ignore[operator]

    def __add__(self, other: ConvexField) -> FieldSum:
        """Return the sum with another field."""
        return FieldSum(self, other)

    def __repr__(self) -> str:
        """Return the terms."""
        return "FieldSum(" + ", ".join(map(repr, self._fields)) + ")"
