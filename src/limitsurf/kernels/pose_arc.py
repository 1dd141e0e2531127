r"""A pose that moves along polynomials, and on which side of lines points are on the way.

A point of the plane against the edges of a part, :math:`b = R^T (p - c)`, or a corner of the part
against walls of the plane, :math:`w = c + R a`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import Floats, compiled

__all__ = [
    "Arc",
    "Bounds",
    "Line",
    "Side",
    "arc_bounds",
    "arc_pose",
    "line_of",
    "point_in_part",
    "side_of",
]


class Arc(NamedTuple):
    """A pose ``start + sum powers[m] tau^(m + 1)``, (3,) and (P, 3)."""

    start: Floats
    powers: Floats


class Bounds(NamedTuple):
    """Bounds on the derivatives of an arc: of the centre's path, and of the angle."""

    speed: float
    acceleration: float
    turn: float
    spin: float


class Line(NamedTuple):
    """Edge line: unit normal n to the left, a point a, and the edge's length."""

    nx: float
    ny: float
    ax: float
    ay: float
    length: float


class Side(NamedTuple):
    """Distance d to a line, place s along it, and their derivatives."""

    d: float
    s: float
    dd: float
    ds: float


@compiled
def arc_bounds(arc: Arc) -> Bounds:
    """Return bounds on the derivatives of an arc."""
    speed = acceleration = turn = spin = 0.0
    for m in range(arc.powers.shape[0]):
        k, part = m + 1, math.hypot(arc.powers[m, 0], arc.powers[m, 1])
        speed += k * part
        acceleration += k * m * part
        turn += k * abs(arc.powers[m, 2])
        spin += k * m * abs(arc.powers[m, 2])
    return Bounds(speed, acceleration, turn, spin)


@compiled
def _along_arc(arc: Arc, tau: float, k: int) -> tuple[float, float]:
    """Return coordinate k of the pose and its derivative."""
    value = slope = 0.0
    for m in range(arc.powers.shape[0] - 1, -1, -1):
        value = value * tau + arc.powers[m, k]
        slope = slope * tau + (m + 1) * arc.powers[m, k]
    return arc.start[k] + tau * value, slope


@compiled
def arc_pose(arc: Arc, tau: float) -> tuple[float, float, float]:
    """Return the pose at tau."""
    return _along_arc(arc, tau, 0)[0], _along_arc(arc, tau, 1)[0], _along_arc(arc, tau, 2)[0]


@compiled
def point_in_part(arc: Arc, tau: float, px: float, py: float) -> tuple[float, float, float, float]:
    """Return where a point of the plane is in the frame of the part, and how it moves there."""
    x, vx = _along_arc(arc, tau, 0)
    y, vy = _along_arc(arc, tau, 1)
    theta, omega = _along_arc(arc, tau, 2)
    cos, sin = math.cos(theta), math.sin(theta)
    rx, ry = px - x, py - y
    bx, by = cos * rx + sin * ry, cos * ry - sin * rx
    return bx, by, omega * by - cos * vx - sin * vy, sin * vx - cos * vy - omega * bx


@compiled
def _corner_in_plane(
    arc: Arc, tau: float, ax: float, ay: float
) -> tuple[float, float, float, float]:
    """Return where a point of the part is in the plane, and how it moves there."""
    x, vx = _along_arc(arc, tau, 0)
    y, vy = _along_arc(arc, tau, 1)
    theta, omega = _along_arc(arc, tau, 2)
    cos, sin = math.cos(theta), math.sin(theta)
    rx, ry = cos * ax - sin * ay, sin * ax + cos * ay
    return x + rx, y + ry, vx - omega * ry, vy + omega * rx


@compiled
def side_of(arc: Arc, tau: float, x: float, y: float, line: Line, fixed: bool) -> Side:
    """Return the side of a line of the part on which a point of the plane is, or of the walls."""
    if fixed:
        bx, by, ux, uy = point_in_part(arc, tau, x, y)
    else:
        bx, by, ux, uy = _corner_in_plane(arc, tau, x, y)
    bx, by = bx - line.ax, by - line.ay
    nx, ny = line.nx, line.ny
    return Side(nx * bx + ny * by, ny * bx - nx * by, nx * ux + ny * uy, ny * ux - nx * uy)


@compiled
def line_of(edge: Floats) -> Line:
    """Return the line of a directed edge."""
    dx, dy = edge[2] - edge[0], edge[3] - edge[1]
    length = math.hypot(dx, dy)
    return Line(-dy / length, dx / length, edge[0], edge[1], length)
