"""Points, segments and flat polygons as polytopes."""

from __future__ import annotations

import numpy as np

from limitsurf.errors import InputError
from limitsurf.kernels.compile import Floats
from limitsurf.kernels.normal_fan import ANGLE, Polytope, facet_normals, rounding

__all__ = ["flat_polytope"]


def flat_polytope(corners: Floats) -> Polytope:
    """Return a point (one corner), a segment (two) or a flat convex polygon as a polytope.

    Parameters
    ----------
    corners : (k, 3) float
        Corners in order; those on a straight line with their neighbours are left out.
    """
    corners = np.ascontiguousarray(corners, dtype=float).reshape(-1, 3)
    if len(corners) == 0 or not np.isfinite(corners).all():
        raise InputError("corners", "must be one or more finite points")
    if len(corners) > 2:
        corners = _convex_corners(corners)
    m = len(corners)
    ring = np.arange(m, dtype=np.int32)
    if m == 1:
        none = np.empty(0, np.int32)
        return Polytope(corners, np.zeros(1, np.int32), none, np.empty((0, 3)), none)
    twins = np.concatenate([m + (m - 2 - ring) % m, (m - 2 - ring) % m]).astype(np.int32)
    offsets = np.array([0, m, 2 * m], np.int32)
    indices = np.concatenate([ring, ring[::-1]])
    if m == 2:
        normal = _across(corners[1] - corners[0])
    else:
        normal = facet_normals(corners, offsets[:2], ring)[0]
    return Polytope(corners, offsets, indices, np.array([normal, -normal]), twins)


def _across(direction: Floats) -> Floats:
    """Return a unit vector across a direction, at no special angle to the axes."""
    if not direction.any():
        raise InputError("corners", "the ends of a segment coincide", remedy="give one point")
    odd = (
        np.array([0.36, 0.48, 0.8]) if abs(direction[0]) < abs(direction[2]) else [0.8, 0.48, 0.36]
    )
    normal = np.cross(direction / np.abs(direction).max(), odd)
    return np.asarray(normal / np.linalg.norm(normal))


def _convex_corners(corners: Floats) -> Floats:
    """Return the corners at which a convex polygon turns; both ends if it is a segment."""
    noise = rounding(corners)
    size = float(np.ptp(corners, axis=0).max())
    before, after = corners - np.roll(corners, 1, 0), np.roll(corners, -1, 0) - corners
    area = np.cross(corners - corners[0], after).sum(axis=0)
    if np.linalg.norm(area) <= size * (ANGLE * size + noise):
        direction = corners[np.argmax(np.linalg.norm(corners - corners[0], axis=1))] - corners[0]
        along = corners @ direction
        return corners[[int(np.argmin(along)), int(np.argmax(along))]]
    normal = area / np.linalg.norm(area)
    if np.abs((corners - corners[0]) @ normal).max() > 1e-9 * size + noise:
        raise InputError("corners", "do not lie in a plane")
    turn = np.cross(before, after) @ normal
    rounds = np.arctan2(turn, np.einsum("ij,ij->i", before, after)).sum() / (2 * np.pi)
    a, b = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    slack = ANGLE * a * b + noise * (a + b)
    if np.any(turn < -slack) or rounds > 1.5:
        raise InputError("corners", "are not those of a convex polygon in order")
    return np.ascontiguousarray(corners[turn > slack])
