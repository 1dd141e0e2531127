"""N planar contacts on a part, and their limit surface."""

from __future__ import annotations

from functools import cached_property
from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.coulomb import polygonal_contact
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array
from limitsurf.sets.contact_sum import ContactSum
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.minkowski_sum import MinkowskiSum
from limitsurf.sets.projection import Projection
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["ContactSet"]

Array = NDArray[np.float64]


class ContactSet:
    r"""N contacts: contact i can push with ``offset_i + radius_i E_i f``, ``|f| <= 1``.

    Parameters
    ----------
    position : (N, 2) float
        Contacts, from the part's reference point [m].
    radius : (N,) float, or one number
        Friction radii ``mu N`` >= 0 [N]; zero for a contact that only pushes.
    offset : (N, 2) float, optional
        Mean pushes of active contacts [N].
    ellipse : (N, 2, 2) float, optional
        Matrices E_i of anisotropic contacts; the identity is a disk.
    sides : int, optional
        Regular polygons of that many sides, inscribed in the disks, instead of disks.

    Notes
    -----
    N = 0 is a part without contacts: its limit surface is the point 0.

    Examples
    --------
    A bar on two contacts, turned by hand:

    >>> bar = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.5)
    >>> bar.limit_surface().support([0.0, 0.0, 1.0])
    array(1.)
    >>> bar.project([0.0, 0.0, 3.0]).point.round(12)
    array([0., 0., 1.])
    """

    def __init__(
        self,
        position: ArrayLike,
        radius: ArrayLike,
        offset: ArrayLike | None = None,
        *,
        ellipse: ArrayLike | None = None,
        sides: int | None = None,
    ) -> None:
        self._position = as_array("position", position, None, 2)
        n = len(self._position)
        self._offset = None if offset is None else as_array("offset", offset, n, 2)
        self._ellipse = None if ellipse is None else as_array("ellipse", ellipse, n, 2, 2)
        if sides is not None and ellipse is not None:
            raise InputError("sides", "are for disks", remedy="leave out ellipse or sides")
        if sides is not None and (not isinstance(sides, Integral) or sides < 3):
            raise InputError("sides", "must be a whole number from 3 on", value=sides)
        self._sides = sides
        stretch = None if self._ellipse is None else _stretches(self._ellipse)
        radii = np.full(n, radius) if np.ndim(radius) == 0 else radius
        self._sum = ContactSum(self._position, radii, self.offset_load, stretch)

    @property
    def position(self) -> Array:
        """Contacts (N, 2) [m]."""
        return self._position

    @property
    def radius(self) -> Array:
        """Friction radii (N,) [N]."""
        return self._sum.radius

    @property
    def offset(self) -> Array:
        """Mean pushes (N, 2) [N]."""
        return np.zeros_like(self._position) if self._offset is None else self._offset

    @property
    def active(self) -> bool:
        """Whether offsets were given."""
        return self._offset is not None

    @property
    def ellipse(self) -> Array | None:
        """Matrices E_i (N, 2, 2), None for disks."""
        return self._ellipse

    @property
    def sides(self) -> int | None:
        """Sides of the polygons, None for disks and ellipses."""
        return self._sides

    def __len__(self) -> int:
        """Return N."""
        return len(self._position)

    @cached_property
    def offset_load(self) -> Array:
        """Load (3,) of the mean pushes [N, N, N m]."""
        if self._offset is None:
            return np.zeros(3)
        (x, y), (fx, fy) = self._position.T, self._offset.T
        return np.array([fx.sum(), fy.sum(), x @ fy - y @ fx])

    @cached_property
    def _surface(self) -> ConvexSet:
        if self._sides is None:
            return self._sum
        polygons = [
            polygonal_contact(r, m, self._sides)[0]
            for r, m in zip(self._position, self.radius, strict=True)
        ]
        return MinkowskiSum(VPolytope(self.offset_load[None]), *polygons)

    def limit_surface(self) -> ConvexSet:
        """Return the set of loads that the contacts can exert on the part (Lemma 10)."""
        return self._surface

    def project(
        self,
        p: ArrayLike,
        metric: ArrayLike | None = None,
        start: ArrayLike | Projection | None = None,
        *,
        tol: float | None = None,
        threads: int = 1,
        throw: bool = True,
    ) -> Projection:
        """Return the loads of the limit surface closest to p, with twists and certified errors.

        See `ContactSum.project`. The answer's ``contact_forces()`` are those of the contacts on the
        part, pushes included: their loads add up to the point. Polygons know neither start nor
        forces.
        """
        surface = self._surface
        if not isinstance(surface, ContactSum):
            return surface.project(p, metric, throw=throw)
        found = surface.project(p, metric, start, tol=tol, threads=threads, throw=throw)
        return found if self._offset is None else found.with_pushes(self._offset)

    def seen_from(self, r: ArrayLike) -> ContactSet:
        """Return the same contacts from another reference point, at r from the old one [m]."""
        shifted = self._position - as_array("r", r, 2)
        return ContactSet(
            shifted, self.radius, self._offset, ellipse=self._ellipse, sides=self._sides
        )

    def __repr__(self) -> str:
        """Return the number of contacts and their shape."""
        shape = "disks" if self._ellipse is None else "ellipses"
        shape = shape if self._sides is None else f"{self._sides}-gons"
        active = "" if self._offset is None else ", active"
        return f"ContactSet({len(self)} contacts, {shape}{active})"


def _stretches(ellipse: Array) -> Array:
    """Return entries ``xx, xy, yy`` of the symmetric roots of ``E E'``: the same ellipses."""
    U, s, _ = np.linalg.svd(ellipse)
    S = (U * s[:, None, :]) @ U.transpose(0, 2, 1)
    return np.column_stack([S[:, 0, 0], S[:, 0, 1], S[:, 1, 1]])
