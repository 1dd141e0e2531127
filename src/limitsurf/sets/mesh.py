"""Surface meshes of convex sets in three dimensions, to look at them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.sets.hulls import affine_hull, convex_hull

__all__ = ["hull_mesh", "sphere_directions"]

Array = NDArray[np.float64]


def sphere_directions(count: int) -> Array:
    """Return `count` unit vectors spread evenly over the sphere, by the golden angle."""
    k = np.arange(count)
    z = 1.0 - (2 * k + 1) / count
    angle = k * np.pi * (3.0 - np.sqrt(5.0))
    r = np.sqrt(1.0 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def hull_mesh(points: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices (k, 3) and triangles (t, 3), outwards, of the convex hull of points.

    A flat hull is a polygon seen from both sides; a segment or a point has no triangles.
    """
    hull = convex_hull(points)
    vertices = points[hull.vertices]
    if hull.rank == 3:
        number = np.full(len(points), -1)
        number[hull.vertices] = np.arange(len(vertices))
        return vertices, number[hull.triangles]
    if hull.rank < 2:
        return vertices, np.empty((0, 3), dtype=np.int64)
    origin, within, _ = affine_hull(vertices)
    local = (vertices - origin) @ within.T
    ring = np.argsort(np.arctan2(local[:, 1], local[:, 0]))
    fan = np.column_stack([np.full(len(ring) - 2, ring[0]), ring[1:-1], ring[2:]])
    return vertices, np.vstack([fan, fan[:, ::-1]])
