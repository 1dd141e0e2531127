"""Symmetric 3 x 3 matrices as six numbers ``xx, xy, yy, xw, yw, ww``: registers, not arrays."""

from __future__ import annotations

import math

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.vectors import Vector, along, dot

__all__ = ["Symmetric", "factored", "form", "plus", "plus_outer", "solve", "solved", "times"]

Symmetric = tuple[float, float, float, float, float, float]


@compiled
def times(S: Symmetric, v: Vector) -> Vector:
    """Return ``S v``."""
    return (
        S[0] * v[0] + S[1] * v[1] + S[3] * v[2],
        S[1] * v[0] + S[2] * v[1] + S[4] * v[2],
        S[3] * v[0] + S[4] * v[1] + S[5] * v[2],
    )


@compiled
def form(S: Symmetric, v: Vector) -> float:
    """Return ``v' S v``."""
    return dot(v, times(S, v))


@compiled
def plus(S: Symmetric, t: float, R: Symmetric) -> Symmetric:
    """Return ``S + t R``."""
    return (
        S[0] + t * R[0],
        S[1] + t * R[1],
        S[2] + t * R[2],
        S[3] + t * R[3],
        S[4] + t * R[4],
        S[5] + t * R[5],
    )


@compiled
def plus_outer(S: Symmetric, t: float, a: Vector) -> Symmetric:
    """Return ``S + t a a'``."""
    return (
        S[0] + t * a[0] * a[0],
        S[1] + t * a[0] * a[1],
        S[2] + t * a[1] * a[1],
        S[3] + t * a[0] * a[2],
        S[4] + t * a[1] * a[2],
        S[5] + t * a[2] * a[2],
    )


@compiled
def factored(S: Symmetric) -> tuple[bool, Symmetric]:
    """Return whether S is positive definite, and its Cholesky factor, the diagonal inverted."""
    p0 = S[0]
    if not p0 > 0.0:
        return False, S
    d0 = 1.0 / math.sqrt(p0)
    l10, l20 = S[1] * d0, S[3] * d0
    p1 = S[2] - l10 * l10
    if not p1 > 0.0:
        return False, S
    d1 = 1.0 / math.sqrt(p1)
    l21 = (S[4] - l20 * l10) * d1
    p2 = S[5] - l20 * l20 - l21 * l21
    if not p2 > 0.0:
        return False, S
    return True, (d0, l10, d1, l20, l21, 1.0 / math.sqrt(p2))


@compiled
def _back(L: Symmetric, b: Vector) -> Vector:
    z0 = b[0] * L[0]
    z1 = (b[1] - L[1] * z0) * L[2]
    x2 = (b[2] - L[3] * z0 - L[4] * z1) * L[5] * L[5]
    x1 = (z1 - L[4] * x2) * L[2]
    return (z0 - L[1] * x1 - L[3] * x2) * L[0], x1, x2


@compiled
def solve(S: Symmetric, L: Symmetric, b: Vector) -> Vector:
    """Return x with ``S x = b`` from the factor of S, refined once."""
    x = _back(L, b)
    return along(x, 1.0, _back(L, along(b, -1.0, times(S, x))))


@compiled
def solved(S: Symmetric, b: Vector) -> tuple[bool, Vector]:
    """Return whether S is positive definite, and x with ``S x = b``."""
    ok, L = factored(S)
    return ok, solve(S, L, b) if ok else b
