"""Outlines of convex and other flat sets as shapely geometries, thin ones included."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.sets.hulls import affine_hull

__all__ = ["hull_outline", "ring_outline"]

Array = NDArray[np.float64]


def ring_outline(ring: Array, rounding: float) -> shapely.Geometry:
    """Return the polygon of a ring (k, 2); a segment or point where it is no wider than rounding.

    An empty ring gives an empty polygon.
    """
    if len(ring) == 0:
        return shapely.Polygon()
    _, within, _ = affine_hull(ring)
    spread = [float(np.ptp(ring @ axis)) for axis in within]
    if len(within) == 2 and min(spread) > rounding:
        return shapely.make_valid(shapely.Polygon(ring))
    if max(spread, default=0.0) <= rounding:
        return shapely.Point(ring.mean(axis=0))
    along = ring @ within[int(np.argmax(spread))]
    return shapely.LineString(ring[[int(along.argmin()), int(along.argmax())]])


def hull_outline(points: Array, rounding: float) -> shapely.Geometry:
    """Return the convex hull of points (k, 2), counter-clockwise, as `ring_outline`."""
    hull = shapely.convex_hull(shapely.multipoints(points))
    if hull.geom_type != "Polygon" or shapely.is_empty(hull):
        return ring_outline(points, rounding)
    return ring_outline(shapely.get_coordinates(shapely.orient_polygons(hull))[:-1], rounding)
