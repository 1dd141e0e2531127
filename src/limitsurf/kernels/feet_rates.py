r"""Equations of motion of a part that slides on contacts fixed to it, in its own axes.

With the twist :math:`v = (a, b, \omega)` in body axes, M = diag(m, m, J) and the friction
:math:`g(v) = \sum m_i G_i S_i e_i` of the contacts that slide (``contact_pass``),

.. math:: Q = R(\theta)^T F(t) + P - D v - g(v), \qquad
          \dot v = M^{-1} Q + (\omega b, -\omega a, 0), \qquad \dot\theta = \omega ,

P the load of the pushes. While a contact at :math:`r` sticks, the part turns about it, with
:math:`v = \omega p`, :math:`p = (y, -x, 1)`, and

.. math:: \dot v = p\, (p \cdot Q) / (J + m |r|^2) .

Friction and its Hessian H are all that depends on the contacts, so that both cases have one form:
:math:`\dot v = B Q` with B the inverse mass or :math:`p p^T / (J + m |r|^2)`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.load_table import CONSTANT, NONE, Load, load_at, turned
from limitsurf.kernels.symmetric3 import Symmetric
from limitsurf.kernels.vectors import Vector, along, dot

__all__ = [
    "FREE",
    "Feet",
    "Freedom",
    "Rate",
    "acceleration",
    "curvature",
    "friction",
    "new_feet",
    "rate",
    "total_load",
    "turning_about",
]

_STILL2 = 1e-280  # squares of speeds that are zero: such contacts have no direction
_ZERO = (0.0, 0.0, 0.0)


class Feet(NamedTuple):
    """A part and its contacts from the centre of mass, in body axes.

    `data` has rows x, y, m of contacts that slide, and for ellipses xx, xy, yy of S; `push` is the
    load of their offsets; `drag` has two equal entries and one for rotation; `arm` is the largest
    factor by which the metric's norm of a force at a contact exceeds that at the centre.
    """

    data: Floats
    push: Vector
    mass: float
    inertia: float
    drag: Vector
    arm: float


class Freedom(NamedTuple):
    """How the part may move: freely, or about contact `pivot` at (x, y)."""

    pivot: int
    x: float
    y: float


FREE = Freedom(-1, 0.0, 0.0)


class Rate(NamedTuple):
    """Rate of the twist, loads F and g, and the rates of F by time and by the angle."""

    v: Vector
    load: Vector
    friction: Vector
    by_time: Vector
    by_angle: Vector


@compiled
def new_feet(places: Floats, body: Floats) -> Feet:
    """Return feet: `body` has mass, inertia, drag (3), and the load of the pushes (3)."""
    far2 = 0.0
    for i in range(places.shape[1]):
        far2 = max(far2, places[0, i] ** 2 + places[1, i] ** 2)
    return Feet(
        places.copy(),
        (body[5], body[6], body[7]),
        body[0],
        body[1],
        (body[2], body[3], body[4]),
        math.sqrt(1.0 + far2 * body[0] / body[1]),
    )


@compiled
def friction(data: Floats, v: Vector) -> Vector:
    """Return g; contacts that do not move count for nothing."""
    gx = gy = gw = 0.0
    elliptic = data.shape[0] > 3
    for i in range(data.shape[1]):
        x, y = data[0, i], data[1, i]
        ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
        if elliptic:
            a, b, d = data[3, i], data[4, i], data[5, i]
            ux, uy = a * ux + b * uy, b * ux + d * uy
        speed2 = ux * ux + uy * uy
        still = speed2 < _STILL2
        k = (0.0 if still else data[2, i]) / math.sqrt(speed2 + (1.0 if still else 0.0))
        fx, fy = k * ux, k * uy
        if elliptic:
            a, b, d = data[3, i], data[4, i], data[5, i]
            fx, fy = a * fx + b * fy, b * fx + d * fy
        gx += fx
        gy += fy
        gw += x * fy - y * fx
    return gx, gy, gw


@compiled
def curvature(data: Floats, v: Vector) -> Symmetric:
    """Return H: ``sum m/s (G q)(G q)'``, q the direction S e turned by a right angle."""
    xx = xy = yy = xw = yw = ww = 0.0
    for i in range(data.shape[1]):
        x, y, a, b, d = data[0, i], data[1, i], 1.0, 0.0, 1.0
        ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
        if data.shape[0] > 3:
            a, b, d = data[3, i], data[4, i], data[5, i]
            ux, uy = a * ux + b * uy, b * ux + d * uy
        speed2 = ux * ux + uy * uy
        if speed2 >= _STILL2:
            k = data[2, i] / (speed2 * math.sqrt(speed2))
            qx, qy = b * ux - a * uy, d * ux - b * uy
            qw = x * qy - y * qx
            xx += k * qx * qx
            xy += k * qx * qy
            yy += k * qy * qy
            xw += k * qx * qw
            yw += k * qy * qw
            ww += k * qw * qw
    return xx, xy, yy, xw, yw, ww


@compiled
def turning_about(freedom: Freedom) -> Vector:
    """Return the twist p of angular velocity 1 about the pivot."""
    return freedom.y, -freedom.x, 1.0


@compiled
def acceleration(feet: Feet, freedom: Freedom, Q: Vector, v: Vector) -> Vector:
    """Return the rate of the twist in body axes under a load."""
    if freedom.pivot < 0:
        m = feet.mass
        return Q[0] / m + v[2] * v[1], Q[1] / m - v[2] * v[0], Q[2] / feet.inertia
    p = turning_about(freedom)
    inertia = feet.inertia + feet.mass * (freedom.x * freedom.x + freedom.y * freedom.y)
    turn = dot(p, Q) / inertia
    return turn * p[0], turn * p[1], turn


@compiled
def body_load(feet: Feet, load: Load, t: float, theta: float) -> tuple[Vector, Vector, Vector]:
    """Return load and pushes in body axes, and the rates by time and by the angle."""
    if load.kind == NONE:
        return feet.push, _ZERO, _ZERO
    F, dF = load_at(load, t)
    F = turned(F, theta)
    by_angle = F[1], -F[0], 0.0
    if load.kind == CONSTANT:
        return along(F, 1.0, feet.push), _ZERO, by_angle
    return along(F, 1.0, feet.push), turned(dF, theta), by_angle


@compiled
def total_load(feet: Feet, F: Vector, g: Vector, v: Vector) -> Vector:
    """Return Q."""
    d = feet.drag
    return F[0] - g[0] - d[0] * v[0], F[1] - g[1] - d[1] * v[1], F[2] - g[2] - d[2] * v[2]


@compiled
def rate(feet: Feet, freedom: Freedom, load: Load, t: float, v: Vector, theta: float) -> Rate:
    """Return the rates at a state."""
    F, by_time, by_angle = body_load(feet, load, t, theta)
    g = friction(feet.data, v)
    Q = total_load(feet, F, g, v)
    return Rate(acceleration(feet, freedom, Q, v), F, g, by_time, by_angle)
