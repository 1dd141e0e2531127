"""Closest point of a simplex of up to four vertices: the minor cycle of Wolfe (1976).

The point moves towards the closest point of the simplex' affine hull; where the way leaves the
simplex, a vertex is dropped. Decisions are signs of terms linear in p, never differences of
distances, which resolve a point only to the square root of the rounding.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.vectors import Vector, along, cross, dot, row

__all__ = ["closest_of_simplex", "polish", "shortest_way", "simplex_point", "simplex_residual"]

Weights = tuple[float, float, float, float]

_EPS = float(np.finfo(np.float64).eps)
_FLAT = 16.0 * _EPS**2  # squared sine of an angle that is zero up to rounding


@compiled
def _swap(s: Ints, w: Floats, i: int, j: int) -> None:
    s[i], s[j] = s[j], s[i]
    w[i], w[j] = w[j], w[i]


@compiled
def _order_triangle(V: Floats, s: Ints, w: Floats) -> None:
    """Put the vertex opposite to the longest edge first, its nearer neighbour second.

    The two shorter edges span the plane of a thin triangle without cancellation.
    """
    a, b, c = row(V, s[0]), row(V, s[1]), row(V, s[2])
    ab, bc, ca = along(b, -1.0, a), along(c, -1.0, b), along(a, -1.0, c)
    ab2, bc2, ca2 = dot(ab, ab), dot(bc, bc), dot(ca, ca)
    if ca2 > bc2 and ca2 >= ab2:
        _swap(s, w, 0, 1)
        bc2, ca2 = ca2, bc2
    elif ab2 > bc2:
        _swap(s, w, 0, 2)
        bc2, ab2 = ab2, bc2
    if ca2 < ab2:
        _swap(s, w, 1, 2)


@compiled
def _coefficients(V: Floats, s: Ints, k: int, d: Vector) -> tuple[bool, Vector]:
    """Return whether k vertices are independent, and c with ``d - sum_i c_i (v_i - v_0)`` least."""
    a = row(V, s[0])
    e1 = along(row(V, s[1]), -1.0, a)
    length2 = dot(e1, e1)
    if k == 2:
        return length2 > 0.0, (dot(e1, d) / length2, 0.0, 0.0)
    e2 = along(row(V, s[2]), -1.0, a)
    if k == 3:
        f = along(e2, -dot(e1, e2) / length2, e1)
        f2 = dot(f, f)
        t = dot(f, d) / f2
        c = dot(e1, along(d, -t, e2)) / length2, t, 0.0
        return length2 > 0.0 and f2 > _FLAT * dot(e2, e2), c
    e3 = along(row(V, s[3]), -1.0, a)
    n = cross(e1, e2)
    volume = dot(n, e3)
    c = dot(cross(e2, e3), d) / volume, dot(cross(e3, e1), d) / volume, dot(n, d) / volume
    return volume != 0.0, c


@compiled
def _target(V: Floats, s: Ints, w: Floats, k: int, p: Vector) -> tuple[bool, Weights]:
    """Return whether k vertices are independent, and the weights of the point closest to p.

    The point is that of the affine hull; the vertices may change places.
    """
    if k == 1:
        return True, (1.0, 0.0, 0.0, 0.0)
    if k == 3:
        _order_triangle(V, s, w)
    sound, c = _coefficients(V, s, k, along(p, -1.0, row(V, s[0])))
    return sound, (1.0 - c[0] - c[1] - c[2], c[0], c[1], c[2])


@compiled
def _drop_empty(s: Ints, w: Floats, k: int) -> int:
    """Drop the vertices without weight; return how many are left."""
    kept = 0
    for i in range(k):
        if w[i] > 0.0:
            s[kept], w[kept] = s[i], w[i]
            kept += 1
    return kept


@compiled
def closest_of_simplex(V: Floats, s: Ints, w: Floats, k: int, p: Vector) -> int:
    """Move the weights towards the point of the simplex closest to p; return vertices left."""
    while True:
        independent, target = _target(V, s, w, k, p)
        if not independent:
            return _drop_empty(s, w, k)
        share, leaving = 1.0, -1
        for i in range(k):
            if target[i] <= 0.0 and w[i] <= share * (w[i] - target[i]):
                share, leaving = (w[i] / (w[i] - target[i]) if w[i] > 0.0 else 0.0), i
        for i in range(k):
            w[i] = target[i] if leaving < 0 else w[i] + share * (target[i] - w[i])
        if leaving < 0:
            return k
        w[leaving] = 0.0
        k = _drop_empty(s, w, k)


@compiled
def simplex_point(V: Floats, s: Ints, w: Floats, k: int) -> Vector:
    """Return ``sum_i w_i v_i``."""
    a = row(V, s[0])
    x = a
    for i in range(1, k):
        x = along(x, w[i], along(row(V, s[i]), -1.0, a))
    return x


@compiled
def simplex_residual(V: Floats, s: Ints, k: int, x: Vector, p: Vector) -> Vector:
    """Return ``x - p`` without its rounding along the face: close to the hull it would decide."""
    y = along(x, -1.0, p)
    if k == 1:
        return y
    a = row(V, s[0])
    e1 = along(row(V, s[1]), -1.0, a)
    length2 = dot(e1, e1)
    if k == 2:
        return along(y, -dot(y, e1) / length2, e1)
    e2 = along(row(V, s[2]), -1.0, a)
    n = cross(e1, e2)
    n2 = dot(n, n)
    if n2 <= _FLAT * length2 * dot(e2, e2):
        return y
    t = dot(y, n) / n2
    return t * n[0], t * n[1], t * n[2]


@compiled
def shortest_way(V: Floats, s: Ints, k: int, v: Vector) -> Vector:
    """Return ``v_i - v`` for the nearest v_i: seen along y they are as far from v as x is."""
    way = along(row(V, s[0]), -1.0, v)
    for i in range(1, k):
        other = along(row(V, s[i]), -1.0, v)
        if dot(other, other) < dot(way, way):
            way = other
    return way


@compiled
def polish(V: Floats, s: Ints, w: Floats, k: int, p: Vector) -> Vector:
    """Remove what is left of ``p - x`` along the face; return x."""
    x = simplex_point(V, s, w, k)
    if k < 2 or k > 3:
        return x
    if k == 3:
        _order_triangle(V, s, w)
    sound, c = _coefficients(V, s, k, along(p, -1.0, x))
    if sound:
        total = 0.0
        for i in range(1, k):
            w[i] = max(w[i] + c[i - 1], 0.0)
            total += w[i]
        w[0] = max(1.0 - total, 0.0)
    return simplex_point(V, s, w, k)
