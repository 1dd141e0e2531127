"""Convex hulls of points and intersections of half-spaces, flat ones included, by Qhull."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from limitsurf.kernels.hull_polytope import outward_triangles

__all__ = ["Hull", "affine_hull", "chebyshev_center", "convex_hull", "is_bounded", "vertices_of"]

Array = NDArray[np.float64]

_FLAT = 1e-12  # extents below this, relative to the largest, are flat


@dataclass(frozen=True, eq=False)
class Hull:
    """Convex hull of points.

    Attributes
    ----------
    vertices : (k,) int
        Indices of the extreme points.
    normals, offsets : (m, n) and (m,) float
        Half-spaces ``normals x <= offsets``; a flat hull has pairs of opposite ones.
    triangles : (t, 3) int
        Indices of surface triangles, outwards; only for solids in three dimensions.
    rank : int
        Dimension of the hull itself.
    """

    vertices: NDArray[np.int64]
    normals: Array
    offsets: Array
    triangles: NDArray[np.int64]
    rank: int


def affine_hull(points: Array) -> tuple[Array, Array, Array]:
    """Return origin, orthonormal directions (r, n) within, and (n - r, n) across the hull."""
    origin = points.mean(axis=0)
    few = len(points) < points.shape[1]  # else the thin Vt is square already
    _, s, Vt = np.linalg.svd(points - origin, full_matrices=few)
    rounding = 4 * np.finfo(np.float64).eps * np.abs(points).max(initial=0.0)
    noise = max(_FLAT * np.abs(points - origin).max(initial=0.0), rounding)
    rank = min(int(np.sum(s > noise * np.sqrt(len(points)))), len(points) - 1)
    return origin, Vt[:rank], Vt[rank:]


def convex_hull(points: Array) -> Hull:
    """Return the convex hull of points (k, n), of any rank."""
    origin, within, across = affine_hull(points)
    local = (points - origin) @ within.T
    rank = len(within)
    no_triangles = np.empty((0, 3), dtype=np.int64)
    if rank == 0:
        vertices, equations = np.array([0]), np.empty((0, 1))
    elif rank == 1:
        vertices = np.array([int(local.argmin()), int(local.argmax())])
        equations = np.array([[1.0, -local.max()], [-1.0, local.min()]])
    else:
        hull = ConvexHull(local)
        vertices, equations = hull.vertices, hull.equations
    normals = equations[:, :rank] @ within
    offsets = -equations[:, rank] + normals @ origin
    flat_normals = np.vstack([across, -across])
    triangles = no_triangles
    if rank == points.shape[1] == 3:
        triangles = outward_triangles(local, hull)[0].astype(np.int64)
        if np.linalg.det(within) < 0.0:  # a reflection
            triangles = triangles[:, ::-1]
    return Hull(
        np.asarray(vertices, dtype=np.int64),
        np.vstack([normals, flat_normals]),
        np.concatenate([offsets, flat_normals @ origin]),
        triangles,
        rank,
    )


def chebyshev_center(A: Array, b: Array) -> tuple[Array, float] | None:
    """Return the centre and radius of the largest ball in ``A x <= b``; None if it is empty.

    The radius is infinite if there is no largest ball.
    """
    lengths = np.linalg.norm(A, axis=1)
    n = A.shape[1]
    result = linprog(
        np.append(np.zeros(n), -1.0),
        A_ub=np.column_stack([A, lengths]),
        b_ub=b,
        bounds=[(None, None)] * n + [(0.0, None)],
    )
    if result.status == 2:
        return None
    if result.status == 3:
        return np.zeros(n), np.inf
    return np.asarray(result.x[:n]), float(result.x[n])


def is_bounded(A: Array) -> bool:
    """Return whether ``A x <= b`` is bounded: the rows of A span the space positively."""
    m, n = A.shape
    if np.linalg.matrix_rank(A) < n:
        return False
    result = linprog(np.zeros(m), A_eq=A.T, b_eq=np.zeros(n), bounds=[(1.0, None)] * m)
    return bool(result.status == 0)


def vertices_of(A: Array, b: Array, center: Array, radius: float) -> Array:
    """Return the vertices of a bounded, non-empty ``A x <= b`` from its Chebyshev ball.

    A flat polytope is intersected within the constraints that hold with equality all over it.
    """
    lengths = np.linalg.norm(A, axis=1)
    size = max(float(np.abs(b / lengths).max()), float(np.abs(center).max()), 1e-300)
    if A.shape[1] == 1:
        x = b / A[:, 0]
        return np.array([[x[A[:, 0] < 0].max()], [x[A[:, 0] > 0].min()]])
    if radius > 1e-9 * size:
        found = HalfspaceIntersection(np.column_stack([A, -b]), center).intersections
        return np.asarray(found[np.isfinite(found).all(axis=1)])
    tight = np.array([_always_tight(A, b, i, 1e-9 * size * lengths[i]) for i in range(len(A))])
    _, s, Vt = np.linalg.svd(A[tight] / lengths[tight, None])
    within = Vt[int(np.sum(s > 1e-9)) :]
    if len(within) == 0:
        return center[None]
    inner, rest = A[~tight] @ within.T, b[~tight] - A[~tight] @ center
    ball = chebyshev_center(inner, rest)
    assert ball is not None
    return np.asarray(center + vertices_of(inner, rest, *ball) @ within)


def _always_tight(A: Array, b: Array, i: int, tolerance: float) -> bool:
    """Return whether ``A_i x = b_i`` all over the polytope."""
    result = linprog(A[i], A_ub=A, b_ub=b, bounds=[(None, None)] * A.shape[1])
    return bool(result.status == 0 and b[i] - result.fun <= tolerance)
