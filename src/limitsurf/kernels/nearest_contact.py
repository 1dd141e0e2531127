"""The contact nearest to a point, such as the centre of rotation, found through the quadtree."""

from __future__ import annotations

import math

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.moment_tree_build import MomentTree

__all__ = ["nearest_contact"]


@compiled
def _nearest_of_leaf(tree: MomentTree, c: int, px: float, py: float) -> tuple[int, float]:
    best, square = -1, math.inf
    for i in range(tree.cells[c, 0], tree.cells[c, 1]):
        dx, dy = tree.x[i] - px, tree.y[i] - py
        if dx * dx + dy * dy < square:
            best, square = i, dx * dx + dy * dy
    return best, math.sqrt(square)


@compiled
def nearest_contact(tree: MomentTree, px: float, py: float) -> tuple[int, float]:
    """Return the place in `tree.x` of the contact nearest to a point, and its distance.

    One walk down to the nearest leaf gives a first distance, which leaves few cells to be opened.
    Without contacts, or if no distance is finite, the place is -1.
    """
    cells, balls = tree.cells, tree.balls
    best, distance = -1, math.inf
    c = 0
    while c < cells.shape[0] and best < 0:
        if cells[c, 2] == c + 1:
            best, distance = _nearest_of_leaf(tree, c, px, py)
            break
        child, nearest, closest = c + 1, c + 1, math.inf
        while child < cells[c, 2]:
            gap = math.hypot(balls[child, 0] - px, balls[child, 1] - py)
            if gap < closest:
                nearest, closest = child, gap
            child = cells[child, 2]
        c = nearest
    c = 0
    while c < cells.shape[0]:
        gap = math.hypot(balls[c, 0] - px, balls[c, 1] - py) - balls[c, 2]
        if gap < distance:
            if cells[c, 2] > c + 1:
                c += 1
                continue
            i, d = _nearest_of_leaf(tree, c, px, py)
            if d < distance:
                best, distance = i, d
        c = cells[c, 2]
    return best, distance
