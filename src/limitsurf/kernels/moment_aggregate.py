r"""A few contacts in place of many: those of a cut through the quadtree, at their mass centroids.

Distance is convex, so by Jensen's inequality
:math:`\sum m_i |u(z_i)| \ge (\sum m_i)\, |u(\bar z)|` for every twist: the support function of the
aggregated contacts lies below that of all, and their sum lies inside. A load that they hold is
held.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.moment_tree_build import MomentTree

__all__ = ["aggregate"]


@compiled
def _cut(tree: MomentTree, count: int) -> Ints:
    """Return at most `count` cells that hold every contact once, those of much spread divided."""
    cells, balls, moments = tree.cells, tree.balls, tree.moments
    cut = np.zeros(max(count, 1), np.int32)
    size = 1
    threshold = moments[0, 0, 3] * balls[0, 2] ** 2  # sum m |d|^2
    for _ in range(100):
        threshold *= 0.25
        i = 0
        while i < size:
            c = cut[i]
            children = 0
            child = c + 1
            while child < cells[c, 2]:
                children += 1
                child = cells[child, 2]
            small = moments[c, 0, 3] * balls[c, 2] ** 2 <= threshold
            if children == 0 or small or size + children - 1 > cut.shape[0]:
                i += 1
                continue
            cut[i] = c + 1
            child = cells[c + 1, 2]
            while child < cells[c, 2]:
                cut[size] = child
                size += 1
                child = cells[child, 2]
    return cut[:size]


@compiled
def aggregate(tree: MomentTree, count: int) -> tuple[Floats, Floats, Floats]:
    """Return positions and weights of at most `count` contacts whose sum lies inside that of all.

    Cells with much spread are divided first. Leaves are divided into runs of contacts if there
    are fewer leaves than contacts asked for. Mass and first moments are those of all contacts.
    """
    n = tree.x.shape[0]
    if n == 0:
        return np.empty(0), np.empty(0), np.empty(0)
    cells, balls, moments = tree.cells, tree.balls, tree.moments
    cut = _cut(tree, count)
    pieces = max(count, 1) // cut.shape[0]
    x, y, m = np.empty(max(count, 1)), np.empty(max(count, 1)), np.empty(max(count, 1))
    size = 0
    for c in cut:
        start, end = cells[c, 0], cells[c, 1]
        if cells[c, 2] > c + 1 or pieces == 1:
            mass = moments[c, 0, 0]
            if mass > 0.0:
                m[size] = mass
                x[size] = balls[c, 0] + balls[c, 2] * moments[c, 0, 1] / mass
                y[size] = balls[c, 1] + balls[c, 2] * moments[c, 1, 1] / mass
                size += 1
            continue
        runs = min(pieces, end - start)
        for k in range(runs):
            first = start + (end - start) * k // runs
            last = start + (end - start) * (k + 1) // runs
            mass = tree.m[first:last].sum()
            if mass > 0.0:
                mx = my = 0.0
                for i in range(first, last):
                    mx += tree.m[i] * (tree.x[i] - balls[c, 0])
                    my += tree.m[i] * (tree.y[i] - balls[c, 1])
                m[size] = mass
                x[size], y[size] = balls[c, 0] + mx / mass, balls[c, 1] + my / mass
                size += 1
    return x[:size], y[:size], m[:size]
