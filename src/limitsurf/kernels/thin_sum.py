r"""Minkowski sums of bodies that are flat, or nearly so.

A surface whose facets support a body to within :math:`\delta` is right to within about
:math:`\delta / r` sizes, with r the ratio of least to greatest width. On a thin body facets that
hold to rounding can thus miss a part of its rim. So sums that are flat to within ``FLAT`` are added
in their plane; thin ones are stretched to be as thick as they are wide, and then the hull of all
vertex sums is found. Sums of vertices are exact up to rounding; stretching them does not change
which of them are extreme.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.spatial import ConvexHull

from limitsurf.kernels.compile import Floats, Ints
from limitsurf.kernels.hull_polytope import hull_polytope, solid_hull
from limitsurf.kernels.normal_fan import Polytope, rounding

__all__ = ["FLAT", "flat_sum", "hull_of_sums", "widths"]

#: Least width, relative to the greatest, below which a sum is flat. A tenth of the error that sums
#: are good for, so that some may follow each other.
FLAT: Final = 1e-10


def widths(p: Polytope, q: Polytope) -> tuple[Floats, Floats]:
    """Return orthonormal axes, one a row, and the widths of P + Q along them; the least comes last.

    These are axes of inertia of the vertices: the least of the widths is the least of all up to a
    factor that depends on how many vertices there are.
    """
    arms = [body.vertices - body.vertices.mean(axis=0) for body in (p, q)]
    axes = np.linalg.svd(np.vstack(arms), full_matrices=False)[2]
    axes[2] *= np.sign(np.linalg.det(axes))  # a mirror image would be inside out
    return axes, sum(np.ptp(a @ axes.T, axis=0) for a in arms)


def _ring(points: Floats) -> Ints:
    """Return the corners of the hull of points in the plane, counter-clockwise."""
    if len(points) < 3:
        return np.arange(len(points), dtype=np.int32)
    middle = points - points.mean(axis=0)
    _, spread, axes = np.linalg.svd(middle, full_matrices=False)
    if spread[1] <= 1e-14 * spread[0]:
        along = middle @ axes[0]
        return np.array([along.argmin(), along.argmax()], np.int32)
    return np.asarray(ConvexHull(points).vertices, np.int32)


def flat_sum(p: Polytope, q: Polytope, axes: Floats) -> Polytope:
    """Return the sum of polytopes that lie in parallel planes, with normal ``axes[2]``.

    The edges of both outlines, in the order of their directions, are the outline of the sum.
    """
    rings, angles = [], []
    for body in (p, q):
        flat = body.vertices @ axes[:2].T
        ring = _ring(flat)
        ring = np.roll(ring, -np.lexsort((flat[ring, 0], flat[ring, 1]))[0])  # from the lowest
        edge = np.roll(flat[ring], -1, axis=0) - flat[ring]
        rings.append(ring)
        angles.append(np.arctan2(edge[:, 1], edge[:, 0]) % (2 * np.pi))
    turn = np.argsort(np.concatenate(angles), kind="stable") < len(angles[0])
    i, j = np.cumsum(turn) % len(rings[0]), np.cumsum(~turn) % len(rings[1])
    points = p.vertices[rings[0][i]] + q.vertices[rings[1][j]]
    middle = points.mean(axis=0)
    return hull_polytope(middle + (points - middle) @ axes[:2].T @ axes[:2])


def hull_of_sums(p: Polytope, q: Polytope, axes: Floats, extents: Floats) -> Polytope:
    """Return the hull of all vertex sums, found in coordinates in which all widths are equal."""
    sums = (p.vertices[:, None] + q.vertices).reshape(-1, 3)
    middle = sums.mean(axis=0)
    points = (sums - middle) @ axes.T / extents
    vertices, offsets, indices, normals, twins = solid_hull(points, rounding(points))
    normals = normals / extents @ axes
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Polytope(middle + vertices * extents @ axes, offsets, indices, normals, twins)
