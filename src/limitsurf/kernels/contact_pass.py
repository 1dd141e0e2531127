r"""One pass over a block of contacts: support function, gradient and Hessian at a twist.

A contact at :math:`r = (x, y)` with friction radius m, on a part of twist
:math:`v = (v_x, v_y, \omega)`, moves with :math:`u = G^T v = (v_x - \omega y, v_y + \omega x)`.
With :math:`s = \sqrt{|u|^2 + \epsilon^2}` and :math:`e = u/s` a pass sums

.. math::

    h = \sum m s, \quad g = \sum m\, G e, \quad
    H = \sum G\, \tfrac m s (I - e e^T)\, G^T, \quad k = \sum \tfrac m s .

Elliptic contacts have the set :math:`\{m S f : |f| \le 1\}`, S symmetric, instead of a disk: u
becomes :math:`S u` and G becomes :math:`G S`.

Contacts slower than :math:`\tau` are left out and counted; `contact_totals` adds them, but the
kink.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.moment_tree_build import MomentTree
from limitsurf.kernels.vectors import Vector

__all__ = [
    "BLOCK",
    "SUMS",
    "Contacts",
    "Kink",
    "Tree",
    "add_contact",
    "contact_columns",
    "contact_velocity",
    "kink_of",
    "stretch_of",
    "sum_block",
]

BLOCK = 1024
SUMS = 12  # h, g (3), H (6), k, contacts left out
_EPS = float(np.finfo(np.float64).eps)


class Tree(NamedTuple):
    """The moments of contacts that lie in its order, and the tail allowed per unit of friction."""

    moments: MomentTree
    tol: float


class Contacts(NamedTuple):
    """Contacts about their centroid, as rows x, y, m, and for ellipses xx, xy, yy of S.

    `threads` is the number of threads for a pass. With a tree, `exact_sums` takes less than linear
    time.
    """

    data: Floats
    threads: int
    tree: Tree | None


class Kink(NamedTuple):
    """The contact nearest to the centre of rotation, -1 if none is near, and what it weighs.

    `mass` is the friction radius of all contacts at its place; `stretch` is theirs.
    """

    contact: int
    mass: float
    x: float
    y: float
    stretch: Vector


@compiled
def stretch_of(contacts: Contacts, i: int) -> Vector:
    """Return xx, xy, yy of S of contact i."""
    data = contacts.data
    if data.shape[0] == 3:
        return 1.0, 0.0, 1.0
    return data[3, i], data[4, i], data[5, i]


@compiled
def contact_velocity(contacts: Contacts, i: int, v: Vector) -> tuple[float, float]:
    """Return u of contact i, ``S u`` of an elliptic one."""
    data = contacts.data
    ux, uy = v[0] - v[2] * data[1, i], v[1] + v[2] * data[0, i]
    if data.shape[0] == 3:
        return ux, uy
    a, b, d = stretch_of(contacts, i)
    return a * ux + b * uy, b * ux + d * uy


@compiled
def contact_columns(contacts: Contacts, i: int) -> tuple[Vector, Vector]:
    """Return the columns of ``P = G S``, the loads of unit forces of contact i."""
    x, y = contacts.data[0, i], contacts.data[1, i]
    if contacts.data.shape[0] == 3:
        return (1.0, 0.0, -y), (0.0, 1.0, x)
    a, b, d = stretch_of(contacts, i)
    return (a, b, x * b - y * a), (b, d, x * d - y * b)


@compiled
def _sum_disks(
    x: Floats, y: Floats, m: Floats, v: Vector, eps2: float, tau2: float, sums: Floats
) -> None:
    """Fill the sums of one block of disks."""
    vx, vy, w = v
    h = k = gx = gy = gw = xx = xy = yy = xw = yw = ww = near = 0.0
    for i in range(x.shape[0]):
        px, py = x[i], y[i]
        ux, uy = vx - w * py, vy + w * px
        speed2 = ux * ux + uy * uy
        slow = speed2 < tau2
        s2 = speed2 + eps2 + (1.0 if slow else 0.0)
        inverse = 1.0 / math.sqrt(s2)
        mass = 0.0 if slow else m[i]
        near += 1.0 if slow else 0.0
        ex, ey = ux * inverse, uy * inverse
        ki = mass * inverse
        h += ki * s2
        k += ki
        fx, fy = mass * ex, mass * ey
        gx += fx
        gy += fy
        gw += px * fy - py * fx
        cxx, cxy, cyy = ki - fx * ex * inverse, -fx * ey * inverse, ki - fy * ey * inverse
        tx, ty = px * cxy - py * cxx, px * cyy - py * cxy
        xx += cxx
        xy += cxy
        yy += cyy
        xw += tx
        yw += ty
        ww += px * ty - py * tx
    sums[0], sums[1], sums[2], sums[3], sums[4], sums[5] = h, gx, gy, gw, xx, xy
    sums[6], sums[7], sums[8], sums[9], sums[10], sums[11] = yy, xw, yw, ww, k, near


@compiled
def _sum_forces(x: Floats, y: Floats, m: Floats, v: Vector, tau2: float, sums: Floats) -> None:
    """Fill the sums of one block of disks at eps = 0, but the Hessian."""
    vx, vy, w = v
    h = gx = gy = gw = near = 0.0
    for i in range(x.shape[0]):
        px, py = x[i], y[i]
        ux, uy = vx - w * py, vy + w * px
        speed2 = ux * ux + uy * uy
        slow = speed2 < tau2
        s2 = speed2 + (1.0 if slow else 0.0)
        k = (0.0 if slow else m[i]) / math.sqrt(s2)
        near += 1.0 if slow else 0.0
        fx, fy = k * ux, k * uy
        h += k * s2
        gx += fx
        gy += fy
        gw += px * fy - py * fx
    sums[:] = 0.0
    sums[0], sums[1], sums[2], sums[3], sums[11] = h, gx, gy, gw, near


@compiled
def _sum_ellipses(
    x: Floats,
    y: Floats,
    m: Floats,
    stretch: Floats,
    v: Vector,
    eps2: float,
    tau2: float,
    sums: Floats,
) -> None:
    """Fill the sums of one block of ellipses."""
    sums[:] = 0.0
    for i in range(x.shape[0]):
        ux, uy = v[0] - v[2] * y[i], v[1] + v[2] * x[i]
        a, b, d = stretch[0, i], stretch[1, i], stretch[2, i]
        speed2 = (a * ux + b * uy) ** 2 + (b * ux + d * uy) ** 2
        if speed2 < tau2:
            sums[11] += 1.0
        else:
            add_contact(x[i], y[i], m[i], (a, b, d), v, eps2, sums)


@compiled
def add_contact(
    x: float, y: float, m: float, stretch: Vector, v: Vector, eps2: float, sums: Floats
) -> None:
    """Add one contact to the sums; one that does not move counts for nothing if eps is zero."""
    a, b, d = stretch
    ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
    px, py = a * ux + b * uy, b * ux + d * uy
    s = math.sqrt(px * px + py * py + eps2)
    if s == 0.0:
        return
    ex, ey, k = px / s, py / s, m / s
    fx, fy = m * (a * ex + b * ey), m * (b * ex + d * ey)
    qx, qy = b * ex - a * ey, d * ex - b * ey  # S p, p = e turned by a right angle
    shift = k * eps2 / (s * s)  # I - ee' = pp' + (eps/s)^2 I
    cxx = k * qx * qx + shift * (a * a + b * b)
    cxy = k * qx * qy + shift * (a * b + b * d)
    cyy = k * qy * qy + shift * (b * b + d * d)
    tx, ty = x * cxy - y * cxx, x * cyy - y * cxy
    sums[0] += m * s
    sums[1] += fx
    sums[2] += fy
    sums[3] += x * fy - y * fx
    sums[4] += cxx
    sums[5] += cxy
    sums[6] += cyy
    sums[7] += tx
    sums[8] += ty
    sums[9] += x * ty - y * tx
    sums[10] += k


@compiled
def sum_block(
    contacts: Contacts, q: int, v: Vector, eps2: float, tau2: float, curved: bool, sums: Floats
) -> None:
    """Fill the sums of block q; disks leave out the Hessian unless they are to be `curved`."""
    data = contacts.data
    start, end = q * BLOCK, min((q + 1) * BLOCK, data.shape[1])
    x, y, m = data[0, start:end], data[1, start:end], data[2, start:end]
    if data.shape[0] == 3 and curved:
        _sum_disks(x, y, m, v, eps2, tau2, sums)
    elif data.shape[0] == 3:
        _sum_forces(x, y, m, v, tau2, sums)
    else:
        _sum_ellipses(x, y, m, data[3:, start:end], v, eps2, tau2, sums)


@compiled
def kink_of(contacts: Contacts, i: int, mass: float) -> Kink:
    """Return contact i as a kink of the given friction radius."""
    return Kink(i, mass, contacts.data[0, i], contacts.data[1, i], stretch_of(contacts, i))
