"""Contacts in the order of a quadtree: keys of interleaved bits, sorted as far as needed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["LEVELS", "cell_ranges", "sort_contacts"]

Keys = NDArray[np.int64]

#: Depth of the quadtree: contacts closer than 2^-30 of its side are not told apart.
LEVELS = 30

_FIRST_LEVELS, _NEXT_LEVELS = 6, 3


@compiled
def _spread(bits: int) -> int:
    """Put a zero between the lowest 30 bits."""
    bits = (bits | (bits << 16)) & 0x0000FFFF0000FFFF
    bits = (bits | (bits << 8)) & 0x00FF00FF00FF00FF
    bits = (bits | (bits << 4)) & 0x0F0F0F0F0F0F0F0F
    bits = (bits | (bits << 2)) & 0x3333333333333333
    return (bits | (bits << 1)) & 0x5555555555555555


@compiled
def _quadtree_keys(x: Floats, y: Floats) -> Keys:
    """Return keys whose leading 2 j bits name the cell of a contact at level j."""
    n = x.shape[0]
    keys = np.empty(n, np.int64)
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for i in range(n):
        left, right = min(left, x[i]), max(right, x[i])
        bottom, top = min(bottom, y[i]), max(top, y[i])
    side = max(right - left, top - bottom)
    last = (1 << LEVELS) - 1
    scale = last / side if side > 0.0 else 0.0
    if not scale < np.inf:  # so close together that they are one
        scale = 0.0
    for i in range(n):
        column, row = int((x[i] - left) * scale), int((y[i] - bottom) * scale)
        keys[i] = _spread(min(column, last)) | (_spread(min(row, last)) << 1)
    return keys


@compiled
def _counting_sort(
    keys: Keys,
    index: Ints,
    start: int,
    end: int,
    shift: int,
    levels: int,
    room: tuple[Keys, Ints, Ints],
) -> None:
    """Sort a range by the digit of 2 `levels` bits that begins at bit `shift`; stable."""
    other_keys, other_index, counts = room
    buckets = 1 << (2 * levels)
    counts[: buckets + 1] = 0
    for i in range(start, end):
        counts[((keys[i] >> shift) & (buckets - 1)) + 1] += 1
    for b in range(buckets):
        counts[b + 1] += counts[b]
    for i in range(start, end):
        digit = (keys[i] >> shift) & (buckets - 1)
        to = start + counts[digit]
        counts[digit] += 1
        other_keys[to], other_index[to] = keys[i], index[i]
    keys[start:end] = other_keys[start:end]
    index[start:end] = other_index[start:end]


@compiled
def sort_contacts(x: Floats, y: Floats, leaf: int) -> tuple[Keys, Ints]:
    """Return keys and permutation in an order in which every cell is a range.

    Only cells of more than `leaf` contacts are sorted further, most significant digits first:
    the usual cost is two passes, not one for every level.
    """
    n = x.shape[0]
    keys = _quadtree_keys(x, y)
    index = np.arange(n).astype(np.int32)
    counts = np.empty((1 << (2 * _FIRST_LEVELS)) + 1, np.int32)
    room = (np.empty(n, np.int64), np.empty(n, np.int32), counts)
    shift = 2 * (LEVELS - _FIRST_LEVELS)
    _counting_sort(keys, index, 0, n, shift, _FIRST_LEVELS, room)
    crowded = True
    while crowded and shift > 0:
        crowded = False
        start = 0
        while start < n:
            end = start + 1
            while end < n and keys[end] >> shift == keys[start] >> shift:
                end += 1
            if end - start > leaf:
                lower = shift - 2 * _NEXT_LEVELS
                _counting_sort(keys, index, start, end, lower, _NEXT_LEVELS, room)
                crowded = True
            start = end
        shift -= 2 * _NEXT_LEVELS
    return keys, index


@compiled
def _lower_bound(keys: Keys, start: int, end: int, shift: int, digits: int) -> int:
    """Return the first place of a sorted range whose leading digits are at least `digits`."""
    while start < end:
        middle = (start + end) // 2
        if keys[middle] >> shift < digits:
            start = middle + 1
        else:
            end = middle
    return start


@compiled
def cell_ranges(keys: Keys, leaf: int) -> tuple[Ints, int]:
    """Return the cells (C, 3) as ``start, end, next``, parents before children, and the depth.

    `next` is the first cell that is not below this one: walking ``c + 1`` goes down, ``next``
    passes by, and no stack is needed. A cell with all its contacts in one quarter is that quarter.
    """
    n = keys.shape[0]
    cells = np.empty((max(4 * (n // max(leaf, 1)), 16), 3), np.int32)
    stack = np.empty((3 * LEVELS + 4, 4), np.int64)  # start, end, level, depth
    stack[0] = 0, n, 0, 1
    top, count, deepest = 1, 0, 0
    while top > 0 and n > 0:
        top -= 1
        start, end, level, depth = stack[top]
        if count == cells.shape[0]:
            cells = np.concatenate((cells, np.empty_like(cells)))
        cells[count, 0], cells[count, 1] = start, end
        count += 1
        deepest = max(deepest, depth)
        if end - start <= leaf:
            continue
        shift = 2 * (LEVELS - 1 - level)
        while shift >= 0 and keys[start] >> shift == keys[end - 1] >> shift:
            shift -= 2
        if shift < 0:
            continue
        parent = (keys[start] >> (shift + 2)) << 2
        for quarter in range(3, -1, -1):
            first = _lower_bound(keys, start, end, shift, parent + quarter)
            if first < end:
                stack[top] = first, end, LEVELS - shift // 2, depth + 1
                top += 1
            end = first
    _link(cells, count)
    return cells[:count].copy(), deepest


@compiled
def _link(cells: Ints, count: int) -> None:
    """Set `next`: children come before it is needed if cells are visited backwards."""
    for c in range(count - 1, -1, -1):
        after = c + 1
        while after < count and cells[after, 0] < cells[c, 1]:
            after = cells[after, 2]
        cells[c, 2] = after
