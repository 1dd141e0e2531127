"""Patches of pressure, turned into contacts by quadrature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.patch_quadrature import Nodes, hertz_nodes, polygon_nodes
from limitsurf.errors import InputError
from limitsurf.geometry.outlines import as_polygon
from limitsurf.sets.arguments import as_array

__all__ = ["PatchError", "PressurePatch"]

Array = NDArray[np.float64]
Pressure = Callable[[Array], ArrayLike]


@dataclass(frozen=True)
class PatchError:
    """How far contacts may be from the patch that they stand for.

    Both are differences of the dissipated power ``h_L(-v)`` [N], for twists v at which the fastest
    point of the patch has speed 1.

    Attributes
    ----------
    estimate : float
        Largest difference from a coarser rule, over rotations about points in and around the patch,
        where the integrand ``|u|`` has its kink, and translations.
    bound : float
        Proven bound: the load of each cell moved to the cell's contacts. Infinite for sampled
        pressures, of which no more is known than samples.
    """

    estimate: float
    bound: float


class PressurePatch:
    r"""Coulomb friction under a pressure p over an area: ``h_L(-v) = integral mu p |u| dA``.

    Made by `uniform`, `linear`, `hertz` or `sampled`. Coordinates are from the part's reference
    point [m], pressures in [Pa].

    Examples
    --------
    The spin torque of a Hertz contact of radius a is ``3 pi/16 a mu N``:

    >>> patch = PressurePatch.hertz([0.0, 0.0], 1e-3, 2.0, mu=0.5)
    >>> contacts, error = patch.contact_set(1e-4)
    >>> torque = contacts.limit_surface().support([0.0, 0.0, 1.0])
    >>> abs(torque / (3 * np.pi / 16 * 1e-3) - 1.0) < 1e-3
    np.True_
    """

    def __init__(
        self, mu: float, normal_force: float, outline: shapely.Geometry, make: _Make, exact: bool
    ) -> None:
        for name, value in (("mu", mu), ("normal_force", normal_force)):
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(name, "must be at least 0", value=value)
        self.mu, self.normal_force, self.outline = float(mu), float(normal_force), outline
        self._make, self._exact = make, exact

    @classmethod
    def uniform(
        cls, outline: ArrayLike | shapely.Geometry, normal_force: float, mu: float
    ) -> PressurePatch:
        """Return a patch of equal pressure; total force and first moments are exact to rounding."""
        polygon = as_polygon(outline)
        pressure = normal_force / shapely.area(polygon)
        return cls(
            mu, normal_force, polygon, _over(polygon, lambda r: 0.0 * r[:, 0] + pressure), True
        )

    @classmethod
    def linear(
        cls,
        outline: ArrayLike | shapely.Geometry,
        normal_force: float,
        mu: float,
        center_of_pressure: ArrayLike,
    ) -> PressurePatch:
        r"""Return a patch whose pressure is linear in (x, y), with a given centre [m].

        ``p = N/A (1 + (c - r0) . S^-1 (r - r0))``, r0 the centroid, S the second moments of area
        over A: a rigid part on an elastic layer. Total force and first moments are exact to
        rounding.

        Raises
        ------
        InputError
            The centre lies outside the core of the outline: part of the patch would pull.
        """
        polygon = as_polygon(outline)
        center = as_array("center_of_pressure", center_of_pressure, 2)
        nodes = _centred(polygon, np.inf)
        area = nodes.weight.sum()
        r0 = nodes.weight @ nodes.position / area
        arms = nodes.position - r0
        slope = np.linalg.solve((nodes.weight * arms.T) @ arms / area, center - r0)

        def pressure(r: Array) -> Array:
            return np.asarray(normal_force / area * (1.0 + (r - r0) @ slope))

        lowest = (1.0 + (shapely.get_coordinates(polygon) - r0) @ slope).min()
        if lowest < -1e-12:
            raise InputError(
                "center_of_pressure",
                "lies outside the core of the outline: part of the patch would pull",
                value=tuple(center.tolist()),
                remedy="move it inwards, or cut off the part without contact",
            )
        kept = _over(polygon, lambda r: np.maximum(pressure(r), 0.0))
        return cls(mu, normal_force, polygon, kept, True)

    @classmethod
    def hertz(
        cls, center: ArrayLike, radius: float, normal_force: float, mu: float
    ) -> PressurePatch:
        """Return a disk with ``p = 3 N / (2 pi a^2) sqrt(1 - (r/a)^2)``: a ball on a plane."""
        middle = as_array("center", center, 2)
        if not (np.isfinite(radius) and radius > 0.0):
            raise InputError("radius", "must be positive", value=radius)

        def make(size: float, coarse: bool) -> Nodes:
            nodes = hertz_nodes(radius, size, coarse=coarse)
            return Nodes(nodes.position + middle, nodes.weight * normal_force, nodes.size)

        # a polygon around the disk: its corners are a little farther out
        disk = shapely.Point(middle).buffer(radius / np.cos(np.pi / 64), quad_segs=16)
        return cls(mu, normal_force, disk, make, True)

    @classmethod
    def sampled(
        cls,
        outline: ArrayLike | shapely.Geometry,
        pressure: Pressure,
        mu: float,
        normal_force: float | None = None,
    ) -> PressurePatch:
        """Return a patch with a pressure of your own.

        Parameters
        ----------
        outline : (n, 2) float or shapely geometry
            Where there is contact [m].
        pressure : callable
            Pressures (k,) >= 0 at points (k, 2).
        mu : float
            Coefficient of friction.
        normal_force : float, optional
            Total load [N], to which pressures are scaled; their own by default.
        """
        polygon = as_polygon(outline)
        own = _over(polygon, lambda r: _checked(pressure(r), len(r)))
        total = float(own(_extent(polygon) / 16.0, False).weight.sum())
        if normal_force is None:
            return cls(mu, total, polygon, own, False)
        if total <= 0.0:
            raise InputError("pressure", "vanishes", remedy="leave out normal_force, or check it")

        def scaled(size: float, coarse: bool) -> Nodes:
            nodes = own(size, coarse)
            weight = nodes.weight * (normal_force / nodes.weight.sum())
            return Nodes(nodes.position, weight, nodes.size)

        return cls(mu, normal_force, polygon, scaled, False)

    def contact_set(self, size: float | None = None) -> tuple[ContactSet, PatchError]:
        """Return contacts that stand for the patch, and the error.

        Parameters
        ----------
        size : float, optional
            Largest side of the triangles, or width of the rings, that the patch is cut into [m]; a
            tenth of its extent by default.
        """
        extent = _extent(self.outline)
        size = 0.1 * extent if size is None else size
        if not (np.isfinite(size) and size > 0.0):
            raise InputError("size", "must be positive", value=size)
        fine, coarse = self._make(size, False), self._make(size, True)
        corners = shapely.get_coordinates(self.outline)
        powers = [_powers(nodes, corners) for nodes in (fine, coarse)]
        moved = 2.0 / extent * float(fine.weight @ fine.size)  # a turn is no faster than 2/extent
        error = PatchError(
            self.mu * float(np.abs(powers[0] - powers[1]).max()),
            self.mu * moved if self._exact else np.inf,
        )
        return ContactSet(fine.position, self.mu * fine.weight), error

    def __repr__(self) -> str:
        """Return load, friction and extent."""
        extent = _extent(self.outline)
        return f"PressurePatch({self.normal_force:.4g} N, mu {self.mu:g}, {extent:.3g} m across)"


_Make = Callable[[float, bool], Nodes]


def _over(polygon: shapely.Geometry, pressure: Callable[[Array], Array]) -> _Make:
    def make(size: float, coarse: bool) -> Nodes:
        nodes = _centred(polygon, size, coarse=coarse)
        return Nodes(nodes.position, nodes.weight * pressure(nodes.position), nodes.size)

    return make


def _centred(polygon: shapely.Geometry, size: float, *, coarse: bool = False) -> Nodes:
    """Return nodes found about a corner of the polygon: areas far from the origin lose digits."""
    corner = np.array(shapely.bounds(polygon)[:2])
    near = shapely.transform(polygon, lambda points: points - corner)
    nodes = polygon_nodes(near, size, coarse=coarse)
    return Nodes(nodes.position + corner, nodes.weight, nodes.size)


def _extent(polygon: shapely.Geometry) -> float:
    """Return the larger side of the bounding box, no more than the diameter."""
    left, bottom, right, top = shapely.bounds(polygon)
    return float(max(right - left, top - bottom))


def _checked(pressure: ArrayLike, count: int) -> Array:
    values = as_array("pressure", pressure, count)
    if (values < 0.0).any():
        raise InputError(
            "pressure", "is negative", value=float(values.min()), remedy="contacts do not pull"
        )
    return values


def _powers(nodes: Nodes, corners: Array) -> Array:
    """Return ``sum N |u|`` at twists whose fastest corner has speed 1."""
    left, right = corners.min(axis=0), corners.max(axis=0)
    grid = np.linspace(-0.3, 1.3, 7)
    centers = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2) * (right - left) + left
    turns = [
        nodes.weight @ np.hypot(*(nodes.position - c).T) / np.hypot(*(corners - c).T).max()
        for c in centers
    ]
    return np.array([*turns, nodes.weight.sum()])
