r"""A list of tips of an array under a part, and the sums over them that a step needs.

Tips are listed with positions about an *anchor*, a point that stays while the part moves a short
way, so that nothing is written but the tips that change. The sums over all tips are kept as well:
of the shares s, of s r, s |r|^2, and the load of the pushes s d.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled, inlined
from limitsurf.kernels.lattice import Lattice
from limitsurf.kernels.symmetric3 import Symmetric

__all__ = [
    "AGE",
    "BORDER",
    "COUNT",
    "PUSH_M",
    "PUSH_X",
    "PUSH_Y",
    "SHARE",
    "Tips",
    "add_tip",
    "add_up",
    "make_room",
    "moments_of",
    "new_tips",
    "remove_tip",
    "set_share",
    "share_of",
    "tip_data",
]

COUNT, ROOM, BORDER, AGE = 0, 1, 2, 3
SHARE, SHARE_X, SHARE_Y, SHARE_R2, PUSH_X, PUSH_Y, PUSH_M = 0, 1, 2, 3, 4, 5, 6

_NOWHERE = 1e3  # where free places of the list lie, in reaches: never near a centre of rotation


class Tips(NamedTuple):
    """A list of tips: rows, columns, and in `buffer` x, y and share of the first `ROOM` places.

    `slot` finds a site in the list, -1 if it is not; `border` are sites ``row, column, outside``
    of partial share; `sums` and `numbers` are named above.
    """

    rows: Ints
    columns: Ints
    slot: Ints
    border: Ints
    buffer: Floats
    anchor: Floats
    sums: Floats
    numbers: Ints
    reach: float


@compiled
def new_tips(lattice: Lattice, reach: float) -> Tips:
    """Return an empty list for a part of circumradius `reach`."""
    n = lattice.active.size
    return Tips(
        np.empty(n, np.int32),
        np.empty(n, np.int32),
        np.full(lattice.active.shape, -1, np.int32),
        np.empty((n, 3), np.int32),
        np.empty(3 * n),
        np.full(2, np.inf),
        np.zeros(7),
        np.zeros(4, np.int32),
        reach,
    )


@inlined
def tip_data(tips: Tips) -> Floats:
    """Return x, y about the anchor and share, (3, room); free places have share 0, far away."""
    room = tips.numbers[ROOM]
    return tips.buffer[: 3 * room].reshape(3, room)


@inlined
def share_of(tips: Tips, k: int) -> float:
    """Return the share of the tip in place k."""
    share: float = tips.buffer[2 * tips.numbers[ROOM] + k]
    return share


@inlined
def _place(tips: Tips, k: int, x: float, y: float, share: float) -> None:
    """Write a place of the list, without the view of `tip_data`, which takes longer than this."""
    data, room = tips.buffer, tips.numbers[ROOM]
    data[k], data[room + k], data[2 * room + k] = x, y, share


@compiled
def moments_of(tips: Tips) -> Symmetric:
    """Return ``sum s G G'``, as `second_moments` does."""
    s = tips.sums
    return s[SHARE], 0.0, s[SHARE], -s[SHARE_Y], s[SHARE_X], s[SHARE_R2]


@compiled
def make_room(tips: Tips, needed: int) -> None:
    """Make room for `needed` tips and some more; the places of tips stay."""
    room = min(needed + needed // 64 + 8, tips.rows.shape[0])
    count = tips.numbers[COUNT]
    before = tip_data(tips)[:, :count].copy()
    tips.numbers[ROOM] = room
    data = tip_data(tips)
    data[:, :count] = before
    data[:2, count:] = _NOWHERE * tips.reach
    data[2, count:] = 0.0


@inlined
def _weigh(lattice: Lattice, tips: Tips, r: int, c: int, share: float) -> tuple[float, float]:
    """Add a tip to the sums, with a share that may be negative; return where it is."""
    x = lattice.origin_x + lattice.pitch * c - tips.anchor[0]
    y = lattice.origin_y + lattice.pitch * r - tips.anchor[1]
    fx, fy = share * lattice.directions[r, c, 0], share * lattice.directions[r, c, 1]
    s = tips.sums
    s[SHARE] += share
    s[SHARE_X] += share * x
    s[SHARE_Y] += share * y
    s[SHARE_R2] += share * (x * x + y * y)
    s[PUSH_X] += fx
    s[PUSH_Y] += fy
    s[PUSH_M] += x * fy - y * fx
    return x, y


@compiled
def add_up(lattice: Lattice, tips: Tips) -> None:
    """Add up the sums anew."""
    tips.sums[:] = 0.0
    tips.numbers[AGE] = 0
    share = tip_data(tips)[2]
    for k in range(tips.numbers[COUNT]):
        _weigh(lattice, tips, tips.rows[k], tips.columns[k], share[k])


@inlined
def add_tip(lattice: Lattice, tips: Tips, r: int, c: int, share: float) -> None:
    """Add the tip at a site."""
    k = tips.numbers[COUNT]
    if k == tips.numbers[ROOM]:
        make_room(tips, k + 1)
    x, y = _weigh(lattice, tips, r, c, share)
    _place(tips, k, x, y, share)
    tips.rows[k], tips.columns[k] = r, c
    tips.slot[r, c] = k
    tips.numbers[COUNT] = k + 1


@inlined
def remove_tip(lattice: Lattice, tips: Tips, r: int, c: int) -> None:
    """Remove a tip; the last of the list takes its place."""
    k, last = tips.slot[r, c], tips.numbers[COUNT] - 1
    _weigh(lattice, tips, r, c, -share_of(tips, k))
    data, room = tips.buffer, tips.numbers[ROOM]
    _place(tips, k, data[last], data[room + last], data[2 * room + last])
    tips.rows[k], tips.columns[k] = tips.rows[last], tips.columns[last]
    tips.slot[tips.rows[k], tips.columns[k]] = k
    tips.slot[r, c] = -1
    _place(tips, last, _NOWHERE * tips.reach, _NOWHERE * tips.reach, 0.0)
    tips.numbers[COUNT] = last


@inlined
def set_share(lattice: Lattice, tips: Tips, k: int, share: float) -> None:
    """Change the share of the tip in place k."""
    _weigh(lattice, tips, tips.rows[k], tips.columns[k], share - share_of(tips, k))
    tips.buffer[2 * tips.numbers[ROOM] + k] = share
