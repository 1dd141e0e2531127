r"""Sums over contacts in less than linear time, with a bound on their error.

The sums are those of the dual of ``contact_sum``: the support function :math:`h = \sum m_i |u_i|`,
its gradient :math:`g = \sum m_i G_i u_i/|u_i|` and Hessian. A cell of the quadtree whose radius is
small beside its distance from the centre of rotation is summed by the series of `moment_series`
if the tail is small enough; others are opened; contacts of open leaves are summed one by one. All
orders are summed, even where fewer would do: it takes no longer, and the bounds are smaller. Cells
are as small as they are near: their number grows with log N.

**Tail.** A cell of mass M and radius r, with :math:`\theta = |w| r / |u_0|` and
:math:`A_n = \sum m (|d|/r)^n` (a moment, for even n), has after order n the tails

.. math::
    |\delta \textstyle\sum m\,e| \le 2 |c_{n+1}| \frac{\theta^{n+1}}{1-\theta} A_{n+1}, \qquad
    |\delta \textstyle\sum m\,d \times e| \le 2 |c_n| \frac{r\,\theta^n}{1-\theta} A_{n+1},
    \qquad e = u/|u|.

**Rounding.** Velocities carry an error of a few units in the last place of
:math:`|v_x| + |v_y| + |w||z|`, which turns the force of a contact by twice its share of |u|. A
moment of order n carries :math:`\alpha + \beta n` units of :math:`2^n M`, since
:math:`|x|, |y| \le r` bound the terms of :math:`(x + iy)^n`. Summed over the majorant
:math:`2 (1-t)^{-1/2} - 1` at :math:`t = 2\theta`, and over n times its terms:
:math:`\alpha (2 (1-t)^{-1/2} - 1) + \beta t (1-t)^{-3/2}`.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.cell_sums import add_cell, add_contacts
from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.moment_series import FORCE_TAIL, SPEED_TAIL, row_start
from limitsurf.kernels.moment_tree_build import MomentTree

__all__ = ["tree_sums"]

_EPS = float(np.finfo(np.float64).eps)

_FAR = 0.45  # no cell with a larger theta is tried; the bound on rounding needs 2 theta < 1
_SPREAD_ROUNDING = 1e-8  # alpha + beta n times 2^(n/2), at most
_LIGHT = 1.0 / 64.0  # cells lighter than this share of all contacts are allowed its tail


@compiled
def _scaled(v: Floats, reach: float) -> tuple[Floats, float]:
    """Return the twist over a power of two that brings it to size 1, and that power, 0 for rest."""
    size = max(abs(v[0]), abs(v[1]), abs(v[2]) * reach)
    if size == 0.0:
        return v, 0.0
    _, exponent = math.frexp(size)
    scaled = np.empty(3)
    for k in range(3):
        scaled[k] = math.ldexp(v[k], -exponent)
    return scaled, math.ldexp(1.0, exponent)


@compiled
def _blur(twist: Floats, reach: float) -> float:
    """Return twice the rounding error of velocities within a distance of the origin."""
    return float(4.0 * _EPS * (abs(twist[0]) + abs(twist[1]) + abs(twist[2]) * reach))


@compiled
def _spread(moments: Floats, c: int, order: int) -> float:
    """Return a bound on ``sum m (|d|/r)^n``, n > order: the last even moment, and its rounding."""
    even = order - order % 2
    place = row_start(even) + even // 2
    return float(moments[c, 0, place] + _SPREAD_ROUNDING * moments[c, 0, 0])


@compiled
def _sum_cell(
    moments: Floats,
    balls: Floats,
    c: int,
    twist: Floats,
    order: int,
    rounding: tuple[float, float],
    allowed: float,
    powers: Floats,
    sums: Floats,
    errors: Floats,
) -> bool:
    """Add a cell by its series, and its errors, if a tail is within `allowed` per mass."""
    x, y, radius, mass, w = balls[c, 0], balls[c, 1], balls[c, 2], moments[c, 0, 0], twist[2]
    ux, uy = twist[0] - w * y, twist[1] + w * x
    speed, far = math.sqrt(ux * ux + uy * uy), math.sqrt(x * x + y * y)
    blur = _blur(twist, far + radius)
    if not (abs(w) * radius < _FAR * speed and blur < 0.01 * speed):
        return False
    theta = abs(w) * radius / speed * (1.0 + 2.0 * blur / speed)
    arm = math.sqrt(1.0 + (far + radius) * (far + radius))
    rest = _spread(moments, c, order) / (1.0 - theta)
    for _ in range(order):
        rest *= theta
    force, torque = FORCE_TAIL[order + 1] * theta * rest, FORCE_TAIL[order] * radius * rest
    if max(force, torque / arm) > allowed:
        return False
    add_cell(moments, balls, c, order, ux, uy, theta, -1.0 if w < 0.0 else 1.0, powers, sums)
    torque += far * force
    flat = 1.0 / (1.0 - 2.0 * theta)
    root = math.sqrt(flat)
    alpha, beta = rounding
    plain = alpha * (2.0 * root - 1.0) + beta * 2.0 * theta * flat * root
    turning = 2.0 * (plain + beta * (2.0 * root - 1.0))
    turned = arm * (plain + blur / (speed * (1.0 - theta))) + radius * turning
    errors[0] += math.sqrt(force * force + torque * torque) + mass * turned
    errors[1] += SPEED_TAIL[order + 1] * theta * speed * rest
    errors[1] += mass * (blur + speed * (plain + theta * turning))
    errors[2] += mass * arm
    errors[3] += mass * speed
    return True


@compiled
def _sum_leaf(
    tree: MomentTree, c: int, skip: int, twist: Floats, sums: Floats, errors: Floats
) -> None:
    """Add the contacts of a leaf one by one, and their errors, without contact `skip`."""
    start, end = tree.cells[c, 0], tree.cells[c, 1]
    far = math.hypot(tree.balls[c, 0], tree.balls[c, 1]) + tree.balls[c, 2]
    arm, blur = math.sqrt(1.0 + far * far), _blur(twist, far)
    x, y, m = tree.x, tree.y, tree.m
    middle = skip if start <= skip < end else end
    mass, turned = add_contacts(
        x[start:middle], y[start:middle], m[start:middle], twist, blur, sums
    )
    if middle < end:
        middle += 1
        more, turned_too = add_contacts(
            x[middle:end], y[middle:end], m[middle:end], twist, blur, sums
        )
        mass, turned = mass + more, turned + turned_too
    rounding = _EPS * (end - start + 8)
    errors[0] += arm * (turned + rounding * mass)
    speed = abs(twist[0]) + abs(twist[1]) + abs(twist[2]) * far
    errors[1] += mass * (blur + rounding * speed)
    errors[2] += mass * arm
    errors[3] += mass * speed


@compiled
def tree_sums(
    tree: MomentTree, v: Floats, skip: int, tol: float, sums: Floats
) -> tuple[float, float]:
    r"""Fill `sums` with support function, gradient and Hessian; return bounds on their error.

    Parameters
    ----------
    tree : MomentTree
        The contacts.
    v : (3,) float
        Twist :math:`(v_x, v_y, w)`; contacts move with ``u = (v_x - w y, v_y + w x)``.
    skip : int
        A contact to leave out, by its place in `tree.x`; -1 for none.
    tol : float
        Tail allowed in the load of a cell, per unit of mass and of ``sqrt(1 + r^2)``; light cells
        are allowed that of a 64th of all mass. With 0 contacts are summed one by one.
    sums : (11,) float
        Receives h, g (3), the Hessian as xx, xy, yy, xw, yw, ww, and ``sum m/|u|``. Contacts at
        the centre of rotation add nothing.

    Returns
    -------
    gradient_error : float
        Bound on the Euclidean norm of the error of g, rounding included. A contact that rounding
        puts at the centre of rotation may push in any direction: its mass counts in full, unless
        it is left out.
    value_error : float
        Bound on the error of h.
    """
    sums[:] = 0.0
    cells, balls, moments = tree.cells, tree.balls, tree.moments
    order, rounding = tree.order, tree.rounding
    if cells.shape[0] == 0:
        return 0.0, 0.0
    reach = math.hypot(balls[0, 0], balls[0, 1]) + balls[0, 2]
    twist, scale = _scaled(v, reach)
    if scale == 0.0:
        return 0.0, 0.0
    powers = np.empty((2, moments.shape[2]))
    errors = np.zeros(4)  # of g and h, and the masses that the rounding of the total goes with
    total = moments[0, 0, 0]
    visits = c = 0
    while c < cells.shape[0]:
        here = cells[c, 0] <= skip < cells[c, 1]
        allowed = tol * max(moments[c, 0, 0], _LIGHT * total)
        if here or not _sum_cell(
            moments, balls, c, twist, order, rounding, allowed, powers, sums, errors
        ):
            if cells[c, 2] > c + 1:
                c += 1
                continue
            _sum_leaf(tree, c, skip, twist, sums, errors)
        visits += 1
        c = cells[c, 2]
    sums[0] *= scale
    sums[4:] /= scale
    adding = _EPS * (visits + 4)
    return errors[0] + adding * errors[2], scale * (errors[1] + adding * errors[3])
