"""A part: a flat rigid body given by its outline and areal density."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.geometry.outline_files import read_part_file
from limitsurf.geometry.outlines import area_centroid, as_polygon, directed_edges
from limitsurf.geometry.rotation_symmetry import rotation_order
from limitsurf.sets.arguments import as_array
from limitsurf.units import parse_quantity

__all__ = ["Part"]

Array = NDArray[np.float64]


class Part:
    """A flat, rigid part of uniform areal density. Immutable.

    Its reference point is the centre of mass, which for uniform density is the centroid.

    Parameters
    ----------
    outline : (n, 2) float, or shapely Polygon or MultiPolygon
        The outline in metres; rings may close themselves or not, in either direction. Holes and
        several rigidly connected pieces are allowed.
    areal_density : float or str, optional
        Mass per area [kg/m^2], or a text such as ``"80 g/m^2"``. Motion needs it, planning does
        not.
    name : str, optional
        For reports.

    Raises
    ------
    InputError
        An outline that is empty, crosses itself, has no area or no finite coordinates; an areal
        density that is not positive.

    Examples
    --------
    >>> part = Part([(0, 0), (2e-3, 0), (2e-3, 1e-3), (0, 1e-3)], "80 g/m^2")
    >>> part
    Part(4 vertices, 2 x 1 mm, 80 g/m^2)
    """

    def __init__(
        self,
        outline: ArrayLike | shapely.Geometry,
        areal_density: float | str | None = None,
        *,
        name: str = "part",
    ) -> None:
        self._polygon = as_polygon(outline)
        self._areal_density = _read_density(areal_density)
        self._name = name

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        unit: str | None = None,
        areal_density: float | str | None = None,
        *,
        pieces: bool = False,
    ) -> Part:
        """Read a part from a drawing or a model file.

        Parameters
        ----------
        path : str or Path
            SVG (its y axis points down and is turned over), WKT, GeoJSON, a part model in TOML, or
            the name of a shipped part model.
        unit : str, optional
            Length of one coordinate unit, such as ``"mm"``; required for WKT and GeoJSON, and
            for an SVG without physical size.
        areal_density : float or str, optional
            Mass per area; overrides that of a model file.
        pieces : bool
            Allow a drawing of several pieces, which count as rigidly connected.

        Raises
        ------
        ModelError
            The file cannot be read, does not hold an outline, or holds several pieces; says which
            field.
        """
        outline = read_part_file(path, unit, pieces=pieces)
        density = outline.areal_density if areal_density is None else areal_density
        return cls(outline.polygon, density, name=outline.name)

    @property
    def polygon(self) -> shapely.Geometry:
        """The outline as given, holes and pieces included [m]."""
        return self._polygon

    @property
    def areal_density(self) -> float | None:
        """Mass per area [kg/m^2], None if not given."""
        return self._areal_density

    @property
    def name(self) -> str:
        """Name for reports."""
        return self._name

    @cached_property
    def area(self) -> float:
        """Area [m^2]."""
        return float(shapely.area(self._polygon))

    @cached_property
    def centroid(self) -> tuple[float, float]:
        """Centroid (x, y) in the coordinates of the outline [m]."""
        corner = np.array(shapely.bounds(self._polygon)[:2])
        near = shapely.transform(self._polygon, lambda points: points - corner)
        x, y = shapely.get_coordinates(shapely.centroid(near))[0] + corner
        return float(x), float(y)

    @cached_property
    def edges(self) -> Array:
        """Directed edges (E, 4) ``x0, y0, x1, y1`` about the centroid, the part on their left."""
        edges = directed_edges(self._polygon, self.centroid)
        off = area_centroid(edges)
        if np.abs(off).max() < 1e-15 * np.abs(edges).max():
            return edges
        about_centroid = edges - np.tile(off, 2)  # far from the origin `centroid` lacks digits
        about_centroid.setflags(write=False)
        return about_centroid

    @cached_property
    def unit_edges(self) -> Array:
        """`edges` scaled to area 1."""
        scaled: Array = self.edges / self.area**0.5
        scaled.setflags(write=False)
        return scaled

    @cached_property
    def polar_moment(self) -> float:
        """Polar second moment of area about the centroid, ``integral r^2 dA`` [m^4]."""
        x0, y0, x1, y1 = self.edges.T
        cross = x0 * y1 - x1 * y0
        return float(
            np.sum(cross * (x0 * x0 + x0 * x1 + x1 * x1 + y0 * y0 + y0 * y1 + y1 * y1)) / 12
        )

    @cached_property
    def circumradius(self) -> float:
        """Largest distance of an outline point from the centroid [m]."""
        return float(np.hypot(self.edges[:, 0], self.edges[:, 1]).max())

    @property
    def mass(self) -> float:
        """Mass [kg]; raises if there is no areal density."""
        if self._areal_density is None:
            raise InputError(
                "areal_density", "the part has none", remedy="give it, such as '80 g/m^2'"
            )
        return self._areal_density * self.area

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centre of mass [kg m^2]."""
        return self.mass * self.polar_moment / self.area

    @cached_property
    def symmetry_order(self) -> int:
        """Largest r such that a turn by 2 pi / r about the centroid changes nothing."""
        return rotation_order(self.unit_edges)

    def at(self, pose: ArrayLike) -> shapely.Geometry:
        """Return the outline with the centre of mass at a pose ``(x, y, theta)`` [m, m, rad]."""
        x, y, theta = as_array("pose", pose, 3)
        turn = np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])
        centroid = np.asarray(self.centroid)
        return shapely.transform(
            self._polygon, lambda points: (points - centroid) @ turn + np.array([x, y])
        )

    def __repr__(self) -> str:
        """Return the size in millimetres and the density."""
        left, bottom, right, top = 1e3 * np.array(shapely.bounds(self._polygon))
        size = f"{right - left:.4g} x {top - bottom:.4g} mm"
        density = "" if self.areal_density is None else f", {1e3 * self.areal_density:.4g} g/m^2"
        return f"Part({len(self.edges)} vertices, {size}{density})"


def _read_density(areal_density: float | str | None) -> float | None:
    if areal_density is None:
        return None
    density = parse_quantity(areal_density, "kg/m^2", name="areal_density")
    if density <= 0.0:
        raise InputError(
            "areal_density", "must be positive", value=areal_density, remedy="such as '80 g/m^2'"
        )
    return density
