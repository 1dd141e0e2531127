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

__all__ = ["hull_polytope", "outward_triangles", "solid_hull"]


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


@compiled
def _orient(corners: Ints, neighbors: Ints, seed: int) -> None:
    """Turn triangles so that those on either side of an edge run along it in opposite directions.

    `seed` keeps its sense. The normal of a sliver, which rounding may have turned over, has no say.
    """
    known = np.zeros(corners.shape[0], np.bool_)
    stack = np.empty(corners.shape[0], np.int32)
    known[seed], stack[0], depth = True, seed, 1
    while depth > 0:
        depth -= 1
        t = stack[depth]
        for k in range(3):
            u = neighbors[t, k]  # across the edge from corner k + 1 to corner k + 2
            if known[u]:
                continue
            for j in range(3):
                if corners[u, j] == corners[t, (k + 1) % 3]:
                    if corners[u, (j + 1) % 3] == corners[t, (k + 2) % 3]:
                        corners[u, 0], corners[u, 1] = corners[u, 1], corners[u, 0]
                        neighbors[u, 0], neighbors[u, 1] = neighbors[u, 1], neighbors[u, 0]
                    break
            known[u], stack[depth] = True, u
            depth += 1


def _outer_normals(vertices: Floats, offsets: Ints, turns: Ints, planes: Floats) -> Floats:
    """Return the normals of facets; of Qhull's for slivers, whose own area is rounding.

    Where the two differ, the one in whose direction the facet is the highest part of the hull.
    """
    normals = facet_normals(vertices, offsets, turns)
    for i in np.flatnonzero(~(np.abs(normals - planes).max(axis=1) < 1e-11)):
        corners = turns[offsets[i] : offsets[i + 1]]
        heights = vertices @ np.array([normals[i], planes[i]]).T
        excess = heights.max(axis=0) - heights[corners].min(axis=0)
        if not excess[0] <= excess[1]:
            normals[i] = planes[i]
    return normals


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
    return solid_hull(points, noise)


def outward_triangles(points: Floats, hull: ConvexHull) -> tuple[Ints, Ints]:
    """Return the triangles (t, 3) of Qhull's hull of points in space, outwards.

    The second array numbers them by falling area.
    """
    corners = hull.simplices.astype(np.int32)
    a, b, c = (points[corners[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    order = np.argsort(-np.linalg.norm(areas, axis=1)).astype(np.int32)
    neighbors = hull.neighbors.astype(np.int32)
    if areas[order[0]] @ hull.equations[order[0], :3] < 0:
        corners[order[0], :2], neighbors[order[0], :2] = (
            corners[order[0], 1::-1].copy(),
            neighbors[order[0], 1::-1].copy(),
        )
    _orient(corners, neighbors, int(order[0]))
    return corners, order


def solid_hull(points: Floats, noise: float) -> Polytope:
    """Return the hull of points that do not lie in a plane; heights up to `noise` are rounding."""
    hull = ConvexHull(points)
    corners, order = outward_triangles(points, hull)
    indices = corners.ravel()
    offsets = np.arange(0, len(indices) + 1, 3, dtype=np.int32)
    twins = pair_twins(offsets, indices)
    normals = facet_normals(points, offsets, indices)
    h = np.arange(len(indices), dtype=np.int32)
    t = h // 3
    mesh = Mesh(t, 3 * t + (h + 1) % 3, 3 * t + (h + 2) % 3, twins)
    level = ANGLE * float(np.ptp(points, axis=0).max()) + noise
    for factor in (1.0, 30.0, 1000.0, 0.0):  # more only where facets are nearly coplanar
        label = _coplanar_runs(points, corners, normals, twins, order, factor * level)
        vertices, offsets, turns, labels, pairs, sound = merge_faces(
            mesh, indices, points, label, ANGLE, noise
        )
        if sound:
            outer = _outer_normals(vertices, offsets, turns, hull.equations[labels, :3])
            return Polytope(vertices, offsets, turns, outer, pairs)
    raise InputError("points", "nearly lie in a plane; their hull has no clear facets")
