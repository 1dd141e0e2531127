"""The quadtree of moments behind sub-linear sums over contacts (`moment_tree`): building it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.cell_moments import cell_balls, cell_moments
from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.moment_series import MAX_ORDER
from limitsurf.kernels.moment_sort import cell_ranges, sort_contacts

__all__ = ["MomentTree", "build_moment_tree"]

_EPS = float(np.finfo(np.float64).eps)


class MomentTree(NamedTuple):
    """Contacts sorted into the cells of a quadtree, and the moments of the cells.

    Attributes
    ----------
    x, y, m : (N,) float
        Contacts, sorted: contact i here is number ``permutation[i]`` of those given.
    permutation : (N,) int
        Where the sorted contacts come from.
    cells : (C, 3) int
        ``start, end, next``: the range of contacts, and the next cell that is not below.
    balls : (C, 3) float
        Centre and radius.
    moments : (C, 2, T) float
        Re and Im of the moments about the centre, in units of the radius (`moment_series`).
    order : int
        Highest order of the moments.
    rounding : (float, float)
        ``(alpha, beta)``: the rounding of a moment of order n is within ``alpha + beta n``, in
        units of its majorant (`moment_tree`).
    """

    x: Floats
    y: Floats
    m: Floats
    permutation: Ints
    cells: Ints
    balls: Floats
    moments: Floats
    order: int
    rounding: tuple[float, float]


@compiled
def build_moment_tree(
    x: Floats, y: Floats, m: Floats, order: int = 12, leaf: int = 256
) -> MomentTree:
    """Sort contacts into a quadtree and sum the moments of its cells.

    Time ``O(N order^2)`` beside sorting, memory linear in N.

    Parameters
    ----------
    x, y, m : (N,) float
        Finite positions, and weights >= 0.
    order : int
        Highest order of the moments, 2 to 24: more orders, fewer cells to visit.
    leaf : int
        Cells with more contacts are divided.
    """
    order = min(max(order, 2), MAX_ORDER)
    leaf = max(leaf, 1)
    keys, permutation = sort_contacts(x, y, leaf)
    cells, depth = cell_ranges(keys, leaf)
    sx, sy, sm = x[permutation], y[permutation], m[permutation]
    balls = cell_balls(sx, sy, cells)
    moments = cell_moments(sx, sy, sm, cells, balls, order, depth)
    largest = leaf
    for c in range(cells.shape[0]):
        if cells[c, 2] == c + 1:
            largest = max(largest, cells[c, 1] - cells[c, 0])
    # sums: chunks of 64 in a leaf, 4 children, the terms of a series
    alpha = _EPS * (42.0 + largest / 128.0 + 2.0 * depth + 0.5 * moments.shape[2])
    # factors: powers of d, of the shifts of `depth` levels, and of i w rad / u_0
    beta = _EPS * (8.0 + 4.0 * depth)
    return MomentTree(sx, sy, sm, permutation, cells, balls, moments, order, (alpha, beta))
