r"""How a part turns that is pushed at one point, quasi-statically: a convex problem in one unknown.

The pushed point has velocity u. At the rate :math:`\omega`, contact i slips with
:math:`S_i (u + \omega d_i^\perp)`, d_i from the pushed point, and friction dissipates least of all:

.. math:: \omega = \arg\min f(\omega), \qquad
          f(\omega) = \sum_i m_i |c_i + \omega w_i| - \omega n, \quad
          c_i = S_i u, \; w_i = S_i d_i^\perp,

n being the moment of active pushes about the pushed point: the moment of all contacts about it
vanishes there (M. A. Peshkin, A. C. Sanderson, *The motion of a pushed, sliding workpiece*, IEEE J.
Robotics and Automation 4, 1988). f is convex, so its slope rises, and jumps where a contact is the
centre of rotation; bisection ends at two neighbouring floats, and weights of the two that make the
moment vanish give the forces, those of the centre of rotation included.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.vectors import length

__all__ = ["NODE", "push_balance", "push_path", "push_rate"]

_EPS = float(np.finfo(np.float64).eps)

#: Columns of a node: angle, rate, power, force and moment of friction, work and friction so far.
NODE = 8


@compiled
def _slope(levers: Floats, n: float, ux: float, uy: float, omega: float) -> float:
    """Return the slope of f, between its limits at a kink."""
    total = -n
    for i in range(levers.shape[1]):
        wx, wy, m = levers[0, i], levers[1, i], levers[2, i]
        vx = levers[3, i] * ux + levers[4, i] * uy + omega * wx
        vy = levers[4, i] * ux + levers[5, i] * uy + omega * wy
        speed = length(vx, vy)
        if speed > 0.0:
            total += m * (vx * wx + vy * wy) / speed
    return total


@compiled
def _scales(levers: Floats, n: float, ux: float, uy: float) -> tuple[float, float]:
    """Return a rate of the right size to start from, and the rounding of a slope."""
    rate = 0.0
    size = abs(n)
    for i in range(levers.shape[1]):
        wx, wy, m = levers[0, i], levers[1, i], levers[2, i]
        cx = levers[3, i] * ux + levers[4, i] * uy
        cy = levers[4, i] * ux + levers[5, i] * uy
        size += m * length(wx, wy)
        if m * (wx * wx + wy * wy) > 0.0:
            rate = max(rate, length(cx, cy) / length(wx, wy))
    return rate, 8.0 * _EPS * size


@compiled
def push_rate(levers: Floats, n: float, ux: float, uy: float) -> tuple[float, float]:
    """Return neighbouring rates between which the slope of f changes its sign.

    The first is the nearer to 0, the second is the rate: the least, where many are minimal. Equal
    if f is flat there; infinite if f has no minimum.

    Parameters
    ----------
    levers : (6, N) float
        Rows ``w_x, w_y``, friction radii m, entries ``xx, xy, yy`` of S.
    n : float
        Moment of the active pushes about the pushed point.
    ux, uy : float
        Velocity of the pushed point, in the axes of the levers.
    """
    rate, noise = _scales(levers, n, ux, uy)
    start = _slope(levers, n, ux, uy, 0.0)
    if abs(start) <= noise or (ux == 0.0 and uy == 0.0):
        return 0.0, 0.0
    side = -math.copysign(1.0, start)
    near, far = 0.0, rate
    while side * _slope(levers, n, ux, uy, side * far) < -noise:
        if math.isinf(far) or far == 0.0:
            return side * math.inf, side * math.inf
        near, far = far, 2.0 * far
    while True:
        middle = 0.5 * (near + far)
        if middle <= near or middle >= far:
            return side * near, side * far
        if side * _slope(levers, n, ux, uy, side * middle) < -noise:
            near = middle
        else:
            far = middle


@compiled
def _friction(
    levers: Floats, ux: float, uy: float, omega: float
) -> tuple[float, float, float, float]:
    """Return power, force and moment about the pushed point of friction at a rate."""
    power = fx = fy = moment = 0.0
    for i in range(levers.shape[1]):
        wx, wy, m = levers[0, i], levers[1, i], levers[2, i]
        a, b, d = levers[3, i], levers[4, i], levers[5, i]
        vx, vy = a * ux + b * uy + omega * wx, b * ux + d * uy + omega * wy
        speed = length(vx, vy)
        power += m * speed
        if speed > 0.0:
            ex, ey = m * vx / speed, m * vy / speed
            fx -= a * ex + b * ey
            fy -= b * ex + d * ey
            moment -= ex * wx + ey * wy
    return power, fx, fy, moment


@compiled
def push_balance(
    levers: Floats, n: float, ux: float, uy: float
) -> tuple[float, float, float, float, float]:
    """Return rate, power, force and moment of friction, which is -n but for rounding."""
    near, omega = push_rate(levers, n, ux, uy)
    power, fx, fy, moment = _friction(levers, ux, uy, omega)
    if near != omega:
        _, gx, gy, other = _friction(levers, ux, uy, near)
        if moment != other:
            t = min(1.0, max(0.0, (moment + n) / (moment - other)))
            fx, fy = fx + t * (gx - fx), fy + t * (gy - fy)
            moment += t * (other - moment)
    return omega, power, fx, fy, moment


@compiled
def push_path(
    levers: Floats, n: float, path: Floats, theta: float, steps: int, nodes: Floats
) -> float:
    """Turn a part along the path of its pushed point; return the largest gap of the certificates.

    Runge-Kutta steps of order four for ``theta' = omega``, with u in body axes, in which the
    levers stay. The gap ``power - (-F.u + omega n) >= 0`` bounds the error of the power from
    above and that of the force along u: F is a load of the limit surface, and ``-F.u + omega n``
    is no larger than the least power.

    Parameters
    ----------
    path : (k, 2) float
        Places of the pushed point, world axes.
    theta : float
        Angle of the body at the start.
    steps : int
        Steps on each segment of the path.
    nodes : (k, 8) float
        Output at the places: angle, rate, power, force (body axes) and moment of friction, work of
        pusher and active pushes, and friction, both since the start. Rates and powers are those of
        the segment that begins there (the last: that ends there), which takes the time 1.
    """
    work = friction = worst = 0.0
    h = 1.0 / steps
    for k in range(len(path)):
        last = k == len(path) - 1
        begin = max(0, k - 1) if last else k
        dx, dy = 0.0, 0.0
        if len(path) > 1:
            dx, dy = path[begin + 1, 0] - path[begin, 0], path[begin + 1, 1] - path[begin, 1]
        c, s = math.cos(theta), math.sin(theta)
        found = push_balance(levers, n, c * dx + s * dy, c * dy - s * dx)
        nodes[k, 0] = theta
        nodes[k, 1], nodes[k, 2], nodes[k, 3], nodes[k, 4], nodes[k, 5] = found
        nodes[k, 6], nodes[k, 7] = work, friction
        for _ in range(0 if last else steps):
            turned = rate = 0.0
            for stage in range(4):
                reach = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
                angle = theta + reach * rate
                c, s = math.cos(angle), math.sin(angle)
                ux, uy = c * dx + s * dy, c * dy - s * dx
                rate, power, fx, fy, _ = push_balance(levers, n, ux, uy)
                weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
                done = rate * n - fx * ux - fy * uy
                turned += weight * rate
                work += weight * done
                friction += weight * power
                worst = max(worst, (power - done) / length(dx, dy) if power > done else 0.0)
            theta += turned
    return worst
