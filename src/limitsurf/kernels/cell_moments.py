r"""Moments of the cells of a quadtree, from the leaves upwards.

Real moments :math:`\mu_{ij} = \sum m x^i y^j` are cheaper to sum and to shift than complex ones, so
these go up the tree, in coordinates relative to a cell's centre and in units of its radius
(:math:`|d| \le 1`: nothing overflows, and rounding stays below a few hundred units in the last
place of the cell's mass). Each cell keeps the complex moments that are sums of them.

Cells are visited backwards, so that the children of a cell are the last blocks on a stack.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.moment_series import MONOMIALS, row_start

__all__ = ["cell_balls", "cell_moments"]

_EPS = float(np.finfo(np.float64).eps)
_CHUNK = 64


@compiled
def cell_balls(x: Floats, y: Floats, cells: Ints) -> Floats:
    """Return (C, 3) the centre and radius of a ball that holds the contacts of a cell.

    The centre is that of the bounding box. Half the diagonal of the box bounds the radius, and so
    do the balls of the children; leaves are measured.
    """
    count = cells.shape[0]
    balls, boxes = np.empty((count, 3)), np.empty((count, 4))
    for c in range(count - 1, -1, -1):
        box = boxes[c]
        box[0], box[1], box[2], box[3] = np.inf, -np.inf, np.inf, -np.inf
        start, end, after = cells[c]
        if after == c + 1:
            for i in range(start, end):
                box[0], box[1] = min(box[0], x[i]), max(box[1], x[i])
                box[2], box[3] = min(box[2], y[i]), max(box[3], y[i])
        child = c + 1
        while child < after:
            other = boxes[child]
            box[0], box[1] = min(box[0], other[0]), max(box[1], other[1])
            box[2], box[3] = min(box[2], other[2]), max(box[3], other[3])
            child = cells[child, 2]
        px, py = 0.5 * box[0] + 0.5 * box[1], 0.5 * box[2] + 0.5 * box[3]
        radius = 0.0
        if after == c + 1:
            for i in range(start, end):
                radius = max(radius, math.hypot(x[i] - px, y[i] - py))
        child = c + 1
        while child < after:
            gap = math.hypot(balls[child, 0] - px, balls[child, 1] - py)
            radius = max(radius, gap + balls[child, 2])
            child = cells[child, 2]
        width, height = max(box[1] - px, px - box[0]), max(box[3] - py, py - box[2])
        radius = min(radius, math.hypot(width, height))
        balls[c, 0], balls[c, 1], balls[c, 2] = px, py, radius * (1.0 + 4.0 * _EPS)
    return balls


@compiled
def _add_contacts(
    x: Floats, y: Floats, m: Floats, ball: Floats, block: Floats, powers: Floats
) -> None:
    """Add up to 64 contacts to real moments, ``block[i, j] += sum m x^i y^j``."""
    size, n = block.shape[0], x.shape[0]
    unit = 1.0 / ball[2] if ball[2] > 0.0 else 0.0
    px, py = powers[0], powers[1]
    for t in range(n):
        px[0, t], py[0, t] = 1.0, m[t]
    if size > 1:
        for t in range(n):
            px[1, t], py[1, t] = (x[t] - ball[0]) * unit, (y[t] - ball[1]) * unit
    for i in range(2, size):
        for t in range(n):
            px[i, t] = px[i - 1, t] * px[1, t]
            py[i, t] = py[i - 1, t] * py[1, t]
    for i in range(1, size):
        for t in range(n):
            py[i, t] *= m[t]
    for i in range(size):
        for j in range(size - i):
            total = 0.0
            for t in range(n):
                total += px[i, t] * py[j, t]
            block[i, j] += total


@compiled
def _shift_block(block: Floats, ratio: float, dx: float, dy: float) -> None:
    """Turn moments of d into those of ``ratio d + (dx, dy)``, in place.

    ``sum m (d + a)^i`` for all i at once: i additions of a times the moment before, as in
    Horner's shift of a polynomial.
    """
    size = block.shape[0]
    scale = 1.0
    for n in range(1, size):
        scale *= ratio
        for j in range(n + 1):
            block[n - j, j] *= scale
    for first in range(1, size):
        for i in range(size - 1, first - 1, -1):
            for j in range(size - i):
                block[i, j] += dx * block[i - 1, j]
    for i in range(size):
        for first in range(1, size - i):
            for j in range(size - i - 1, first - 1, -1):
                block[i, j] += dy * block[i, j - 1]


@compiled
def _store(block: Floats, order: int, moments: Floats, eight: Floats) -> None:
    """Write the complex moments up to an order, sums of the real ones of the same order.

    Eight are summed at a time, more than an order below 16 has.
    """
    for n in range(order + 1):
        for first in range(0, n // 2 + 1, 8):
            to = row_start(n) + first
            for part in range(2):  # even powers of y make the real part, odd ones the imaginary
                for k in range(8):
                    eight[k] = 0.0
                for j in range(part, n + 1, 2):
                    moment = block[n - j, j]
                    for k in range(8):
                        eight[k] += MONOMIALS[n, j, first + k] * moment
                for k in range(min(n // 2 + 1 - first, 8)):
                    moments[part, to + k] = eight[k]


@compiled
def cell_moments(
    x: Floats, y: Floats, m: Floats, cells: Ints, balls: Floats, order: int, depth: int
) -> Floats:
    """Return (C, 2, T) Re and Im of ``sum m (d/rad)^k conj(d/rad)^l`` of every cell.

    Parameters
    ----------
    x, y, m : (N,) float
        Contacts in the order of the cells.
    cells, balls : (C, 3) int, (C, 3) float
        From `cell_ranges` and `cell_balls`.
    order : int
        Largest k + l.
    depth : int
        Levels of cells.
    """
    count = cells.shape[0]
    moments = np.empty((count, 2, row_start(order + 1)))
    stack = np.empty((3 * depth + 4, order + 1, order + 1))
    powers = np.empty((2, order + 1, _CHUNK))
    eight = np.empty(8)
    top = 0
    for c in range(count - 1, -1, -1):
        start, end, after = cells[c]
        block = stack[stack.shape[0] - 1]  # the last place is never reached by the stack
        block[:] = 0.0
        if after == c + 1:
            for i in range(start, end, _CHUNK):
                j = min(i + _CHUNK, end)
                _add_contacts(x[i:j], y[i:j], m[i:j], balls[c], block, powers)
        unit = 1.0 / balls[c, 2] if balls[c, 2] > 0.0 else 0.0
        child = c + 1
        while child < after:
            top -= 1
            dx, dy = balls[child, 0] - balls[c, 0], balls[child, 1] - balls[c, 1]
            _shift_block(stack[top], balls[child, 2] * unit, dx * unit, dy * unit)
            block += stack[top]
            child = cells[child, 2]
        _store(block, order, moments[c], eight)
        stack[top] = block
        top += 1
    return moments
