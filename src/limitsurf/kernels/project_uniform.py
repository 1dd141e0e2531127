r"""Closest load of uniform friction under a polygon, by Newton's method in two dimensions.

The support function h is smooth but for v = 0, and positively homogeneous. Two problems in the
direction of the twist alone are left, both without kinks:

*hold*: :math:`\min h(v)` subject to :math:`p \cdot v = 1`. The gradient there is the point of the
limit surface L on the ray of the load p; p is in L iff the minimum is at least 1. The search stops
where :math:`h(v) < p \cdot v`, which proves that p is outside.

*slide*: with coordinates in which :math:`W = I`, :math:`\min \lambda(w) = h(w) - p \cdot w` over
unit w. The minimum is minus the distance of p from L, and the twist of the closest-point problem
:math:`\tfrac12 |v|^2 - p \cdot v + h(v)` is :math:`v = -\lambda w`. Where :math:`\lambda < 0`, the
Hessian on the sphere, that of h minus :math:`\lambda`, is positive definite.

**Certificates.** Sliding: :math:`F = \nabla h(w)` lies in L and leaves no Fenchel gap, so that
:math:`|F - F^*| \le |p - F - v|` (see `contact_problem`). Holding: L holds 0 and F, and so
:math:`s F, 0 \le s \le 1`: the distance of p from L is at most :math:`|p - s F|`. What rounding
does to F is added.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_problem import Rows, times_rows
from limitsurf.kernels.symmetric3 import Symmetric, form, times
from limitsurf.kernels.uniform_friction import NOISE, Room, UniformPatch, new_room, power_sums
from limitsurf.kernels.vectors import Vector, along, cross, dot, row, scaled

__all__ = [
    "ANSWER",
    "BOUND",
    "COUNT",
    "FAILED",
    "INSIDE",
    "LOOSE",
    "OUTSIDE",
    "STATUS",
    "TWIST",
    "project_uniform",
    "project_uniform_many",
]

_EPS = float(np.finfo(np.float64).eps)
_STEPS = 50
_LOOSE = 1e-6  # of the scale: a search that stops farther from its answer has failed

OUTSIDE, INSIDE, FAILED, LOOSE = 0, 1, 2, 3
# places of load, twist, bound, iterations and status in an answer
BOUND, COUNT, STATUS, ANSWER = 6, 7, 8, 9
TWIST = 3


@compiled
def _back(C: Rows, w: Vector) -> Vector:
    """Return ``C' w``: the twist of a vector of the coordinates in which W = I."""
    return along(along(scaled(w[0], C[0]), w[1], C[1]), w[2], C[2])


@compiled
def _unit(w: Vector) -> Vector:
    return scaled(1.0 / math.sqrt(dot(w, w)), w)


@compiled
def _normals(w: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors normal to w and to each other."""
    x, y, z = abs(w[0]), abs(w[1]), abs(w[2])
    axis = (0.0, 0.0, 1.0)
    if x <= y and x <= z:
        axis = (1.0, 0.0, 0.0)
    elif y <= z:
        axis = (0.0, 1.0, 0.0)
    first = _unit(cross(w, axis))
    return first, _unit(cross(w, first))


@compiled
def _newton(
    H: Symmetric, shift: float, C: Rows, one: Vector, two: Vector, g1: float, g2: float
) -> tuple[float, float]:
    """Return the step ``-(B' C H C' B + shift)^-1 g`` along two directions."""
    a, b = _back(C, one), _back(C, two)
    h11, h22 = form(H, a) + shift, form(H, b) + shift
    h12 = dot(a, times(H, b))
    det = h11 * h22 - h12 * h12
    if not det > 1e-14 * h11 * h22:  # rounding: no curvature left along one direction
        h11, h22, h12 = h11 + h22, h11 + h22, 0.0
        det = h11 * h22
    return (h12 * g2 - h22 * g1) / det, (h12 * g1 - h11 * g2) / det


@compiled
def _state(
    patch: UniformPatch, C: Rows, w: Vector, room: Room
) -> tuple[float, Vector, Symmetric, float]:
    """Return h, the gradient in the coordinates, the Hessian in the twist, and the rounding."""
    force, moment = power_sums(patch, _back(C, w), room)
    sums = room.sums
    g = times_rows(C, (sums[1], sums[2], sums[3]))
    H = (sums[4], sums[5], sums[6], sums[7], sums[8], sums[9])
    square = 0.0
    for r in C:
        square += ((abs(r[0]) + abs(r[1])) * force + abs(r[2]) * moment) ** 2
    return sums[0], g, H, math.sqrt(square)


@compiled
def _hold(
    patch: UniformPatch, C: Rows, y: Vector, w: Vector, target: float, room: Room
) -> tuple[bool, float, Vector, int]:
    """Return whether y is held, up to which distance, the last direction, and the iterations."""
    one, two = _normals(y)
    bound = math.inf
    h, g, H, rounding = _state(patch, C, w, room)
    for count in range(1, _STEPS):
        if h < dot(y, w):
            return False, bound, w, count
        share = min(dot(y, g) / dot(g, g), 1.0)
        left = along(y, -share, g)
        bound = min(bound, math.sqrt(dot(left, left)) + rounding)
        if bound <= max(target, 2.0 * rounding):
            return True, bound, w, count
        g1, g2 = dot(g, one), dot(g, two)
        d1, d2 = _newton(H, 0.0, C, one, two, g1, g2)
        slope, t = g1 * d1 + g2 * d2, 1.0
        while True:
            there = along(along(w, t * d1, one), t * d2, two)
            value, g, H, rounding = _state(patch, C, there, room)
            if value <= h + 1e-4 * t * slope + room.sums[NOISE] or t < 1e-10:
                break
            t *= 0.5
        w, h = there, value
        if t < 1e-10:
            return True, bound, w, count
    return True, bound, w, _STEPS


@compiled
def _slide(
    patch: UniformPatch, C: Rows, y: Vector, w: Vector, target: float, room: Room
) -> tuple[float, float, Vector, int]:
    """Return the bound, lambda and the unit vector w of the closest point, and iterations."""
    w = _unit(w)
    h, g, H, rounding = _state(patch, C, w, room)
    low = h - dot(y, w)
    best, lowest, at = math.inf, low, w
    for count in range(1, _STEPS):
        left = along(along(g, -1.0, y), -low, w)
        bound = math.sqrt(dot(left, left)) + rounding
        if bound < best:
            best, lowest, at = bound, low, w
        if bound <= max(target, 2.0 * rounding):
            return best, lowest, at, count
        one, two = _normals(w)
        g1, g2 = dot(left, one), dot(left, two)
        d1, d2 = _newton(H, max(-low, 0.0), C, one, two, g1, g2)
        slope, t = g1 * d1 + g2 * d2, 1.0
        while True:
            there = _unit(along(along(w, t * d1, one), t * d2, two))
            h, g, H, rounding = _state(patch, C, there, room)
            value, noise = h - dot(y, there), 2.0 * room.sums[NOISE]
            if value <= low + 1e-4 * t * slope + noise - 8.0 * _EPS * value or t < 1e-10:
                break
            t *= 0.5
        w, low = there, value
        if t < 1e-10:
            break
    return best, lowest, at, _STEPS


@compiled
def project_uniform(
    patch: UniformPatch, p: Vector, C: Rows, tol: float, room: Room, answer: Floats
) -> None:
    """Fill an answer: the closest load, minus its twist, bound, iterations and status.

    Parameters
    ----------
    patch : UniformPatch
        The polygon, in circumradii; its friction has unit traction.
    p, C : vector, rows
        The load, and the upper root of the metric, ``W = C' C``.
    tol : float
        Bound to reach, relative to the sizes of L and p.
    room, answer : Room, (9,) float
        Where to work, and the answer.
    """
    y = times_rows(C, p)
    size = 0.0
    for r in C:
        size += (r[0] * r[0] + r[1] * r[1]) * patch.area**2
        size += r[2] * r[2] * patch.polar * patch.area
    scale = math.sqrt(size) + math.sqrt(dot(y, y))
    target = max(tol, 16.0 * _EPS) * scale
    for k in range(3):
        answer[k], answer[TWIST + k] = p[k], 0.0
    answer[BOUND], answer[COUNT], answer[STATUS] = math.sqrt(dot(y, y)), 0.0, INSIDE
    if answer[BOUND] <= target:
        return
    # the direction in which an ellipsoid of the same moments would be left along the ray of p
    guess = (p[0] / patch.area, p[1] / patch.area, p[2] / patch.polar)
    D = (cross(C[1], C[2]), cross(C[2], C[0]), cross(C[0], C[1]))
    w = times_rows(D, guess)
    w = _unit(scaled(1.0 if dot(w, y) > 0.0 else -1.0, w))
    held, bound, w, count = _hold(patch, C, y, w, target, room)
    if not held:
        bound, low, w, more = _slide(patch, C, y, w, target, room)
        count += more
        power_sums(patch, _back(C, w), room)
        twist = _back(C, scaled(-low, w))
        for k in range(3):
            answer[k], answer[TWIST + k] = room.sums[1 + k], twist[k]
        answer[STATUS] = OUTSIDE
    answer[BOUND], answer[COUNT] = bound, count
    if bound > _LOOSE * scale:
        answer[STATUS] = FAILED
    elif bound > target and not held:
        answer[STATUS] = LOOSE


@compiled
def project_uniform_many(
    patch: UniformPatch, points: Floats, C: Floats, tol: float, answers: Floats
) -> None:
    """Fill answers (k, 9) to loads (k, 3)."""
    room, rows = new_room(), (row(C, 0), row(C, 1), row(C, 2))
    for k in range(points.shape[0]):
        project_uniform(patch, row(points, k), rows, tol, room, answers[k])
