"""From what a user gives as an outline to a valid polygon and its directed edges."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.validation import explain_validity

from limitsurf.errors import InputError

__all__ = ["area_centroid", "as_polygon", "directed_edges", "ring_starts"]

_SMALLEST, _LARGEST = 1e-70, 1e70  # fourth powers are normal numbers


def as_polygon(outline: ArrayLike | shapely.Geometry, *, name: str = "outline") -> shapely.Geometry:
    """Return a valid Polygon or MultiPolygon, exteriors counter-clockwise, or raise.

    Parameters
    ----------
    outline : (n, 2) float, or shapely Polygon or MultiPolygon
        Vertices of one ring, or a geometry.
    name : str
        What to call it in an error.

    Raises
    ------
    InputError
        Empty, not finite, self-intersecting, zero area, or no polygon at all.
    """
    shape = outline if isinstance(outline, shapely.Geometry) else _ring(outline, name)
    if shape.geom_type not in ("Polygon", "MultiPolygon"):
        raise InputError(name, f"is a {shape.geom_type}, not a polygon", remedy="close the outline")
    if shapely.is_empty(shape):
        raise InputError(name, "is empty", remedy="give at least three vertices")
    if not np.isfinite(shapely.get_coordinates(shape)).all():
        raise InputError(name, "has coordinates that are not finite", remedy="remove NaN and inf")
    size = float(np.ptp(shapely.get_coordinates(shape), axis=0).max())
    if size != 0.0 and not _SMALLEST < size < _LARGEST:
        raise InputError(
            name,
            f"is {size:.2g} wide, beyond what moments can be computed of",
            remedy="scale the coordinates",
        )
    if shapely.area(shape) == 0.0:
        raise InputError(name, "has no area", remedy="give at least three vertices off a line")
    if not shapely.is_valid(shape):
        raise InputError(
            name, f"is no simple polygon: {explain_validity(shape)}", remedy="untangle it"
        )
    return shapely.orient_polygons(shapely.force_2d(shape))


def directed_edges(shape: shapely.Geometry, origin: tuple[float, float]) -> NDArray[np.float64]:
    """Return the edges (E, 4) of a polygon about `origin`, the inside on their left."""
    edges = []
    for polygon in shapely.get_parts(shape):
        for ring in shapely.get_rings(polygon):
            points = shapely.get_coordinates(ring) - np.asarray(origin)
            points = points[np.append(True, np.any(np.diff(points, axis=0) != 0.0, axis=1))]
            edges.append(np.hstack([points[:-1], points[1:]]))
    stacked = np.ascontiguousarray(np.vstack(edges))
    stacked.setflags(write=False)
    return stacked


def area_centroid(edges: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the centroid (2,) of what lies on the left of edges (E, 4)."""
    x0, y0, x1, y1 = edges.T
    cross = x0 * y1 - x1 * y0
    first = np.array([cross @ (x0 + x1), cross @ (y0 + y1)])
    return np.asarray(first / (3.0 * cross.sum()))


def ring_starts(edges: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return where rings begin among the edges (E, 4) that `directed_edges` returns."""
    first = np.append(True, np.any(edges[1:, :2] != edges[:-1, 2:], axis=1))
    return np.flatnonzero(first)


def _ring(vertices: ArrayLike, name: str) -> shapely.Polygon:
    try:
        if np.iscomplexobj(vertices):
            raise TypeError("complex numbers")
        points = np.asarray(vertices, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, "is no array of numbers", remedy="give (n, 2) vertices") from error
    if points.size == 0:
        raise InputError(name, "is empty", remedy="give at least three vertices")
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(name, f"has shape {points.shape}", remedy="give (n, 2) vertices")
    if not np.isfinite(points).all():
        raise InputError(name, "has coordinates that are not finite", remedy="remove NaN and inf")
    if len(points) < 3:
        raise InputError(name, "has fewer than three vertices", remedy="give at least three")
    return shapely.Polygon(points)
