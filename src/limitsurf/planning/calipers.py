"""Two parallel jaws about a convex hull: which vertices they touch in each direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.geometry.part import Part

__all__ = ["Calipers"]

Array = NDArray[np.float64]

_JUST_BEFORE = 1e-14  # rad; the rounding of a direction that is reduced


@dataclass(frozen=True, eq=False)
class Calipers:
    """A convex hull, counter-clockwise, from the edge of least direction on.

    Attributes
    ----------
    vertices : (n, 2) float
        Vertex i is where edge i begins; from the part's centroid [m].
    directions : (n,) float
        Directions of the edges, ascending in [0, 2 pi) [rad].
    """

    vertices: Array
    directions: Array

    @classmethod
    def around(cls, part: Part) -> Calipers:
        """Return the hull of a part; O(n log n) for n vertices."""
        ring = shapely.get_exterior_ring(shapely.convex_hull(shapely.MultiPoint(part.edges[:, :2])))
        vertices = shapely.get_coordinates(ring)[:-1]
        if not shapely.is_ccw(ring):
            vertices = vertices[::-1]
        edges = np.roll(vertices, -1, axis=0) - vertices
        directions = np.mod(np.arctan2(edges[:, 1], edges[:, 0]), 2 * np.pi)
        order = np.argsort(directions, kind="stable")
        return cls(vertices[order], directions[order])

    def touched(self, theta: Array) -> tuple[Array, Array]:
        """Return the vertices (..., 2) that jaws along theta touch, to its left and to its right.

        Where an edge lies flush, the vertex that is touched just before, at a smaller theta: the
        jaw to the right touches the vertex between the edges before and after direction theta.
        """
        reduced = np.mod(theta - _JUST_BEFORE, 2 * np.pi)
        opposite = np.mod(reduced + np.pi, 2 * np.pi)
        left, right = (
            self.vertices[np.searchsorted(self.directions, x, side="left") % len(self.vertices)]
            for x in (opposite, reduced)
        )
        return left, right
