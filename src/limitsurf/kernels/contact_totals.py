"""The sums of `contact_pass` over all contacts: in blocks, side by side, with the kink left out.

The results of the blocks are added in order: the rounding grows with the root of N, and any number
of threads gives the same. Contacts slower than a threshold are left out and counted; the slowest of
them, the *kink*, stays out, and the others are added one by one.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numba import objmode

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.contact_pass import (
    BLOCK,
    SUMS,
    Contacts,
    Kink,
    Tree,
    add_contact,
    contact_velocity,
    kink_of,
    stretch_of,
    sum_block,
)
from limitsurf.kernels.moment_tree import tree_sums
from limitsurf.kernels.moment_tree_build import MomentTree
from limitsurf.kernels.nearest_contact import nearest_contact
from limitsurf.kernels.symmetric3 import Symmetric
from limitsurf.kernels.vectors import Vector

__all__ = [
    "always_curved",
    "exact_sums",
    "gradient",
    "hessian",
    "new_table",
    "smoothed_sums",
    "sum_error",
]

_EPS = float(np.finfo(np.float64).eps)


@compiled
def new_table(n: int) -> Floats:
    """Return room for the sums of all blocks of n contacts, and a last row for the total."""
    return np.zeros((-(-n // BLOCK) + 1, SUMS))


@compiled
def sum_error(n: int) -> float:
    """Return the rounding of a sum over n contacts, relative to the sum of magnitudes."""
    return 0.5 * _EPS * (min(n, BLOCK) + n / BLOCK + 16.0)


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
        sum_block(contacts, q, v, eps2, tau2, curved, table[q])


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
    if total[11] == 0.0:
        return Kink(-1, 0.0, 0.0, 0.0, (1.0, 0.0, 1.0)), 0.0, 0.0
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
