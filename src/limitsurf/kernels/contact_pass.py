r"""One pass over N contacts: support function, gradient and Hessian at a twist.

A contact at :math:`r = (x, y)` with friction radius m, on a part of twist
:math:`v = (v_x, v_y, \omega)`, moves with :math:`u = G^T v = (v_x - \omega y, v_y + \omega x)`.
With :math:`s = \sqrt{|u|^2 + \epsilon^2}` and :math:`e = u/s` a pass sums

.. math::

    h = \sum m s, \quad g = \sum m\, G e, \quad
    H = \sum G\, \tfrac m s (I - e e^T)\, G^T, \quad k = \sum \tfrac m s .

Elliptic contacts have the set :math:`\{m S f : |f| \le 1\}`, S symmetric, instead of a disk: u
becomes :math:`S u` and G becomes :math:`G S`.

Contacts slower than :math:`\tau` are left out and counted; `exact_sums` takes the slowest of them,
the *kink*, out of the sums and adds the others one by one. Sums are made in blocks, whose results
are added in order: the rounding grows with the root of N, and any number of threads gives the same.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import NamedTuple

import numpy as np
from numba import objmode

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.moment_tree import tree_sums
from limitsurf.kernels.moment_tree_build import MomentTree
from limitsurf.kernels.nearest_contact import nearest_contact
from limitsurf.kernels.symmetric3 import Symmetric
from limitsurf.kernels.vectors import Vector

__all__ = [
    "BLOCK",
    "SUMS",
    "Contacts",
    "Kink",
    "Tree",
    "always_curved",
    "contact_columns",
    "contact_velocity",
    "exact_sums",
    "gradient",
    "hessian",
    "kink_of",
    "new_table",
    "smoothed_sums",
    "stretch_of",
    "sum_error",
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
def new_table(n: int) -> Floats:
    """Return room for the sums of all blocks of n contacts, and a last row for the total."""
    return np.zeros((-(-n // BLOCK) + 1, SUMS))


@compiled
def gradient(table: Floats) -> Vector:
    """Return g of the total."""
    total = table[table.shape[0] - 1]
    return total[1], total[2], total[3]


@compiled
def hessian(table: Floats) -> Symmetric:
    """Return H of the total."""
    t = table[table.shape[0] - 1]
    return t[4], t[5], t[6], t[7], t[8], t[9]


@compiled
def sum_error(n: int) -> float:
    """Return the rounding of a sum over n contacts, relative to the sum of magnitudes."""
    return 0.5 * _EPS * (min(n, BLOCK) + n / BLOCK + 16.0)


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
def _sum_block(
    contacts: Contacts, q: int, v: Vector, eps2: float, tau2: float, curved: bool, sums: Floats
) -> None:
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
def _sum_blocks(
    contacts: Contacts,
    v: Vector,
    eps2: float,
    tau2: float,
    curved: bool,
    table: Floats,
    first: int,
    last: int,
) -> None:
    """Fill the rows of blocks first to last."""
    for q in range(first, last):
        _sum_block(contacts, q, v, eps2, tau2, curved, table[q])


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return threads that stay: starting them takes as long as a tenth of a pass."""
    return ThreadPoolExecutor(threads)


def _sum_side_by_side(
    data: Floats, at: tuple[float, float, float, float, float, bool], table: Floats, threads: int
) -> None:
    """Fill the rows of all blocks, a range for each thread."""
    blocks = table.shape[0] - 1
    ends = [k * blocks // threads for k in range(threads + 1)]
    vx, vy, w, eps2, tau2, curved = at
    same = Contacts(data, 1, None), (vx, vy, w), eps2, tau2, curved, table
    pool = _pool(threads - 1)
    rest = [pool.submit(_sum_blocks, *same, *ends[k : k + 2]) for k in range(1, threads)]
    _sum_blocks(*same, 0, ends[1])
    for future in rest:
        future.result()


@compiled
def _sum_all(
    contacts: Contacts, v: Vector, eps2: float, tau2: float, curved: bool, table: Floats
) -> None:
    """Fill the table with the sums of all blocks, and its last row with the total."""
    blocks, threads = table.shape[0] - 1, contacts.threads
    if threads > 1 and blocks >= 4 * threads:
        data, at = contacts.data, (v[0], v[1], v[2], eps2, tau2, curved)
        with objmode():  # numba's own parallel loops break in cached callers
            _sum_side_by_side(data, at, table, threads)
    else:
        _sum_blocks(contacts, v, eps2, tau2, curved, table, 0, blocks)
    total = table[blocks]
    total[:] = 0.0
    for q in range(blocks):
        for k in range(SUMS):
            total[k] += table[q, k]


@compiled
def smoothed_sums(contacts: Contacts, v: Vector, eps: float, table: Floats) -> None:
    """Fill the last row of the table with the sums at eps > 0; no contact is left out."""
    _sum_all(contacts, v, eps * eps, 0.0, True, table)


@compiled
def exact_sums(
    contacts: Contacts, v: Vector, tau: float, blur: float, table: Floats
) -> tuple[Kink, float, float]:
    """Fill the last row of the table with the sums at eps = 0, without the kink.

    Return the kink, and bounds on the errors of the gradient and of h beside those of adding up.
    `blur` is the error allowed, per unit of friction, where the sums are not the last; with
    blur = 0 they may be, and direct ones leave out the Hessian.
    """
    return _exact_sums(contacts, contacts.tree, v, tau, blur, table)


@compiled
def _exact_sums(
    contacts: Contacts, tree: Tree | None, v: Vector, tau: float, blur: float, table: Floats
) -> tuple[Kink, float, float]:
    if tree is not None:  # decided when compiled
        tol = max(tree.tol, blur)
        return _sums_by_tree(contacts, tree.moments, v, tau, tol, table[table.shape[0] - 1])
    total = table[table.shape[0] - 1]
    _sum_all(contacts, v, 0.0, tau * tau, blur > 0.0, table)
    slow = _left_out(contacts, v, tau, table)
    while slow.shape[0] != total[11]:  # rounding at the threshold differs between the two loops
        tau *= 0.99
        _sum_all(contacts, v, 0.0, tau * tau, blur > 0.0, table)
        slow = _left_out(contacts, v, tau, table)
    return _without_kink(contacts, v, slow, total), 0.0, 0.0


@compiled
def _left_out(contacts: Contacts, v: Vector, tau: float, table: Floats) -> Ints:
    """Return the contacts slower than tau, looking only into blocks that left some out."""
    found = np.empty(int(table[table.shape[0] - 1, 11]) + 1, np.int32)
    count = 0
    for q in range(table.shape[0] - 1):
        if table[q, 11] == 0.0:
            continue
        for i in range(q * BLOCK, min((q + 1) * BLOCK, contacts.data.shape[1])):
            ux, uy = contact_velocity(contacts, i, v)
            if ux * ux + uy * uy < tau * tau:
                found[min(count, found.shape[0] - 1)] = i
                count += 1
    return found[: min(count, found.shape[0])]


@compiled
def _without_kink(contacts: Contacts, v: Vector, slow: Ints, total: Floats) -> Kink:
    """Add slow contacts to the total, but those at the place of the slowest, the kink."""
    data, kink, least = contacts.data, -1, np.inf
    for i in slow:
        ux, uy = contact_velocity(contacts, i, v)
        if data[2, i] > 0.0 and ux * ux + uy * uy < least:
            least, kink = ux * ux + uy * uy, i
    if kink < 0:  # none, or without friction
        return Kink(-1, 0.0, 0.0, 0.0, (1.0, 0.0, 1.0))
    mass, at_kink = 0.0, stretch_of(contacts, kink)
    for i in slow:
        same = data[0, i] == data[0, kink] and data[1, i] == data[1, kink]
        stretch = stretch_of(contacts, i)
        if same and stretch == at_kink:
            mass += data[2, i]
        else:
            add_contact(data[0, i], data[1, i], data[2, i], stretch, v, 0.0, total)
    return kink_of(contacts, kink, mass)


@compiled
def _sums_by_tree(
    contacts: Contacts, moments: MomentTree, v: Vector, tau: float, tol: float, total: Floats
) -> tuple[Kink, float, float]:
    """Fill the total by moments; the nearest contact is the kink if it is slower than tau."""
    kink = -1
    if tau > 0.0:
        kink, distance = nearest_contact(moments, -v[1] / v[2], v[0] / v[2])
        if distance * abs(v[2]) >= tau or not contacts.data[2, kink] > 0.0:
            kink = -1
    of_g, of_h = tree_sums(moments, np.array(v), kink, tol, total[:11])
    if kink < 0:
        return Kink(-1, 0.0, 0.0, 0.0, (1.0, 0.0, 1.0)), of_g, of_h
    return kink_of(contacts, kink, contacts.data[2, kink]), of_g, of_h


@compiled
def always_curved(tree: Tree | None) -> bool:
    """Return whether sums have a Hessian also where blur = 0."""
    return tree is not None


@compiled
def kink_of(contacts: Contacts, i: int, mass: float) -> Kink:
    """Return contact i as a kink of the given friction radius."""
    return Kink(i, mass, contacts.data[0, i], contacts.data[1, i], stretch_of(contacts, i))
