r"""Closest point of a polytope :math:`\{x : a_i\cdot x \le b_i\}` in space, from its facets.

Dual active-set method of Goldfarb and Idnani (1983), for three unknowns and the identity metric.
It starts at the point p itself and keeps, for a set W of at most three independent facets,

.. math:: x = p - \sum_{j \in W} u_j a_j, \qquad a_j \cdot x = b_j, \quad u_j \ge 0 .

The most violated facet q joins W. With :math:`a_q = z + \sum_j r_j a_j`, z along all facets of W,
a step t changes

.. math:: x \to x - t z, \qquad u_j \to u_j - t r_j, \qquad u_q \to u_q + t .

:math:`t = (a_q\cdot x - b_q)/|z|^2` reaches facet q; a facet whose :math:`u_j` reaches zero before
leaves W. If z = 0 and all :math:`r_j \le 0`, then :math:`a_q + \sum_j |r_j| a_j = 0` while
:math:`b_q + \sum_j |r_j| b_j < 0`: the polytope is empty (Farkas).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.facet_scan import most_violated
from limitsurf.kernels.polytope_bounds import facet_bound
from limitsurf.kernels.vectors import Vector, along, cross, dot, row, transposed

__all__ = [
    "INFEASIBLE",
    "NOT_CONVERGED",
    "SOLVED",
    "Working",
    "closest_by_facets",
    "closest_on_facets",
    "new_working_set",
]

SOLVED, NOT_CONVERGED, INFEASIBLE = 0, 1, 2

_EPS = float(np.finfo(np.float64).eps)
_MAX_ITERATIONS = 500
_TOLERANCE = 4 * _EPS  # rounding of a.x - b, relative to |x| + |b|
_PARALLEL = 1e-28  # |z|^2 of unit normals that depend on each other up to rounding


class Working(NamedTuple):
    """Room for the set W: which facets, their multipliers, normals and offsets."""

    facets: Ints
    u: Floats
    normals: Floats
    offsets: Floats


@compiled
def new_working_set() -> Working:
    """Return room for three facets."""
    return Working(np.empty(3, np.int32), np.empty(3), np.empty((3, 3)), np.empty(3))


@compiled
def _cross_units(a: Vector, b: Vector) -> Vector:
    """Return the vector product of unit vectors, exact too where they are nearly parallel."""
    return cross(along(a, -1.0 if dot(a, b) > 0.0 else 1.0, b), b)


@compiled
def _split(normals: Floats, k: int, n: Vector) -> tuple[Vector, Vector]:
    """Return ``(z, r)`` with ``n = z + sum_j r_j a_j``, z normal to the first k normals a_j."""
    if k == 0:
        return n, (0.0, 0.0, 0.0)
    a = row(normals, 0)
    if k == 1:
        return cross(a, _cross_units(n, a)), (dot(n, a), 0.0, 0.0)
    b = row(normals, 1)
    c = _cross_units(a, b)
    volume = dot(c, c)
    if k == 2:
        t = dot(n, c) / volume
        r = dot(n, cross(b, c)) / volume, dot(n, cross(c, a)) / volume, 0.0
        return (t * c[0], t * c[1], t * c[2]), r
    d = row(normals, 2)
    volume = dot(c, d)
    r = dot(n, _cross_units(b, d)) / volume, dot(n, _cross_units(d, a)) / volume, dot(n, c) / volume
    return (0.0, 0.0, 0.0), r


@compiled
def _restored(x: Vector, normals: Floats, offsets: Floats, k: int) -> Vector:
    """Return x moved back onto the planes of the first k facets: the rounding of long steps."""
    a = row(normals, 0)
    ra = offsets[0] - dot(a, x)
    if k == 1:
        return along(x, ra, a)
    b = row(normals, 1)
    rb = offsets[1] - dot(b, x)
    c = _cross_units(a, b)
    if k == 2:
        volume = dot(c, c)
        return along(along(x, ra / volume, cross(b, c)), rb / volume, cross(c, a))
    d = row(normals, 2)
    volume = dot(c, d)
    x = along(along(x, ra / volume, _cross_units(b, d)), rb / volume, _cross_units(d, a))
    return along(x, (offsets[2] - dot(d, x)) / volume, c)


@compiled
def _first_to_leave(u: Floats, r: Vector, k: int) -> tuple[int, float]:
    """Return the facet whose multiplier reaches zero first, and at which step; -1 if none does."""
    leaving, step = -1, np.inf
    for j in range(k):
        if r[j] > 0.0 and u[j] < step * r[j]:
            leaving, step = j, u[j] / r[j]
    return leaving, step


@compiled
def _put(work: Working, j: int, q: int, u: float, normal: Vector, offset: float) -> None:
    work.facets[j], work.u[j], work.offsets[j] = q, u, offset
    work.normals[j, 0], work.normals[j, 1], work.normals[j, 2] = normal


@compiled
def _add_facet(
    x: Vector, k: int, work: Working, q: int, normal: Vector, offset: float
) -> tuple[Vector, int, int]:
    """Step until facet q holds; return x, the number of facets in W, and a status."""
    uq = 0.0
    while True:
        violation = dot(normal, x) - offset
        z, r = _split(work.normals, k, normal)
        length2 = dot(z, z)
        leaving, step = _first_to_leave(work.u, r, k)
        reaches = length2 > _PARALLEL and violation <= step * length2
        if not reaches and leaving < 0:
            noise = _TOLERANCE * (1.0 + abs(r[0]) + abs(r[1]) + abs(r[2])) * _size(x, offset)
            return x, k, INFEASIBLE if violation > noise else SOLVED
        if reaches:
            step = max(violation, 0.0) / length2
        x = along(x, -step, z)
        uq += step
        for j in range(k):
            work.u[j] = max(work.u[j] - step * r[j], 0.0)
        if reaches:
            _put(work, k, q, uq, normal, offset)
            return _restored(x, work.normals, work.offsets, k + 1), k + 1, SOLVED
        k -= 1
        _put(work, leaving, work.facets[k], work.u[k], row(work.normals, k), work.offsets[k])


@compiled
def _size(x: Vector, offset: float) -> float:
    return abs(x[0]) + abs(x[1]) + abs(x[2]) + abs(offset)


@compiled
def closest_by_facets(
    p: Vector, columns: Floats, b: Floats, work: Working
) -> tuple[Vector, int, int, int]:
    """Return x, the number of facets in W (which is left in `work`), iterations and status."""
    x, k = p, 0
    for iteration in range(_MAX_ITERATIONS):
        q, violation = most_violated(columns, b, x, 0.0)
        if q < 0 or violation <= _TOLERANCE * _size(x, b[q]):
            return x, k, iteration, SOLVED
        for j in range(k):
            if work.facets[j] == q:  # no better vertex in this arithmetic
                return x, k, iteration, SOLVED
        normal = columns[0, q], columns[1, q], columns[2, q]
        x, k, status = _add_facet(x, k, work, q, normal, b[q])
        if status != SOLVED:
            return x, k, iteration + 1, status
    return x, k, _MAX_ITERATIONS, NOT_CONVERGED


@compiled
def closest_on_facets(
    points: Floats, A: Floats, b: Floats
) -> tuple[Floats, Ints, Floats, Ints, Ints, Floats]:
    """Return ``(closest, active, multipliers, iterations, status, bound)`` for each of the points.

    Parameters
    ----------
    points : (k, 3) float
        Points to project.
    A, b : (m, 3) float, (m,) float
        Facets ``A x <= b``; the rows of A are unit vectors.

    Returns
    -------
    closest : (k, 3) float
        Closest points; a point of the polytope is returned as it is.
    active : (k, 3) int32
        Facets that hold the closest point, then -1.
    multipliers : (k, 3) float
        Their multipliers >= 0: ``point - closest = sum_j multipliers_j A[active_j]``.
    iterations : (k,) int32
        Facets added on the way.
    status : (k,) int32
        `SOLVED`, `NOT_CONVERGED` or `INFEASIBLE` (the polytope is empty).
    bound : (k,) float
        Certified errors of the closest points, see `facet_bound`.
    """
    n = points.shape[0]
    columns = transposed(A)
    closest = np.empty((n, 3))
    active = np.full((n, 3), -1, np.int32)
    multipliers = np.zeros((n, 3))
    iterations = np.empty(n, np.int32)
    status = np.empty(n, np.int32)
    bound = np.empty(n)
    largest = np.abs(b).max() if b.shape[0] > 0 else 0.0
    work = new_working_set()
    for i in range(n):
        x, k, iterations[i], status[i] = closest_by_facets(row(points, i), columns, b, work)
        closest[i, 0], closest[i, 1], closest[i, 2] = x
        for j in range(k):
            active[i, j], multipliers[i, j] = work.facets[j], work.u[j]
        bound[i] = facet_bound(row(points, i), x, A, columns, b, largest, active[i], multipliers[i])
    return closest, active, multipliers, iterations, status, bound
