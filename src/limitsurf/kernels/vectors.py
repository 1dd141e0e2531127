"""Vectors of three numbers as tuples: registers, not arrays, in compiled kernels."""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["Vector", "along", "cross", "dot", "length", "row", "scaled", "transposed"]

Vector = tuple[float, float, float]


@compiled
def row(a: Floats, i: int) -> Vector:
    """Return row i."""
    return a[i, 0], a[i, 1], a[i, 2]


@compiled
def transposed(a: Floats) -> Floats:
    """Return the coordinates of the rows one after the other, (3, m)."""
    columns = np.empty((3, a.shape[0]))
    for i in range(a.shape[0]):
        columns[0, i], columns[1, i], columns[2, i] = a[i, 0], a[i, 1], a[i, 2]
    return columns


@compiled
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled
def along(a: Vector, t: float, b: Vector) -> Vector:
    """Return ``a + t b``."""
    return a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]


@compiled
def scaled(t: float, a: Vector) -> Vector:
    """Return ``t a``."""
    return t * a[0], t * a[1], t * a[2]


@compiled
def length(x: float, y: float) -> float:
    """Return ``|(x, y)|`` of numbers of ordinary size (`math.hypot` guards against overflow)."""
    return math.sqrt(x * x + y * y)
