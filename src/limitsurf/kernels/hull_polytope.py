"""Convex hull of points as a polytope with merged facets (Qhull finds the triangles)."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from limitsurf.errors import InputError
from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.flat_polytope import flat_polytope
from limitsurf.kernels.merge_faces import Mesh, merge_faces
from limitsurf.kernels.normal_fan import (
    ANGLE,
    Polytope,
    facet_normals,
    pair_twins,
    rounding,
)

__all__ = ["hull_polytope"]


@compiled
def _coplanar_runs(
    vertices: Floats, corners: Ints, normals: Floats, twins: Ints, order: Ints, level: float
) -> Ints:
    """Label triangles: those around a large one whose corners are level with it get its number."""
    n = corners.shape[0]
    label = np.full(n, -1, np.int32)
    stack = np.empty(n, np.int32)
    for seed in order:
        if label[seed] >= 0:
            continue
        label[seed], stack[0], depth = seed, seed, 1
        base = vertices[corners[seed, 0]]
        while depth > 0:
            depth -= 1
            t = stack[depth]
            for k in range(3):
                u = twins[3 * t + k] // 3
                highest = 0.0
                for j in range(3):
                    height = np.sum((vertices[corners[u, j]] - base) * normals[seed])
                    highest = max(highest, abs(height))
                if label[u] < 0 and highest <= level:
                    label[u], stack[depth] = seed, u
                    depth += 1
    return label


def hull_polytope(points: Floats) -> Polytope:
    """Return the convex hull of points; flat if they lie in a plane, on a line or coincide.

    Parameters
    ----------
    points : (n, 3) float
        Any points; those inside are left out.
    """
    points = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
    if len(points) == 0 or not np.isfinite(points).all():
        raise InputError("points", "must be one or more finite points")
    noise = rounding(points)
    arms = points - points[0]
    _, spread, axes = np.linalg.svd(arms, full_matrices=False)
    rank = int(np.sum(spread > np.sqrt(len(points)) * (noise + ANGLE * spread[0])))
    if rank == 0:
        return flat_polytope(points[:1])
    if rank == 1:
        along = arms @ axes[0]
        return flat_polytope(points[[int(np.argmin(along)), int(np.argmax(along))]])
    if rank == 2:
        return flat_polytope(points[ConvexHull(arms @ axes[:2].T).vertices])
    return _solid_hull(points, noise)


def _solid_hull(points: Floats, noise: float) -> Polytope:
    hull = ConvexHull(points)
    corners = hull.simplices.astype(np.int32)
    a, b, c = (points[corners[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    corners[inward] = corners[inward][:, ::-1]
    indices = corners.ravel()
    offsets = np.arange(0, len(indices) + 1, 3, dtype=np.int32)
    twins = pair_twins(offsets, indices)
    normals = facet_normals(points, offsets, indices)
    order = np.argsort(-np.linalg.norm(np.cross(b - a, c - a), axis=1)).astype(np.int32)
    h = np.arange(len(indices), dtype=np.int32)
    t = h // 3
    mesh = Mesh(t, 3 * t + (h + 1) % 3, 3 * t + (h + 2) % 3, twins)
    level = ANGLE * float(np.ptp(points, axis=0).max()) + noise
    for factor in (1.0, 30.0, 1000.0):  # more only where facets are nearly coplanar
        label = _coplanar_runs(points, corners, normals, twins, order, factor * level)
        vertices, offsets, turns, _, pairs, sound = merge_faces(
            mesh, indices, points, label, ANGLE, noise
        )
        if sound:
            return Polytope(
                vertices, offsets, turns, facet_normals(vertices, offsets, turns), pairs
            )
    raise InputError("points", "nearly lie in a plane; their hull has no clear facets")
