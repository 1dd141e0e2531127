r"""Directions in which the median passes through a vertex.

The height :math:`g_v = n \cdot v - z` of a vertex over the median has the derivative
:math:`s_m - u \cdot v`: in a cell of directions in which the middle of the chords stays on one side
of a vertex, the median passes it at most once, and the signs at the ends decide. A vertex that
stays within rounding of the line, while the median pivots about it, keeps the side it had.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.median_cell import START, median_at, whole_turn
from limitsurf.kernels.median_view import View, halves, look, median_in

__all__ = ["median_events"]

_NARROW = 1e-6  # half width [rad] of a cell in which a touched vertex leaves the line by < 1e-12
_PIVOT = 1e-4  # the same where the line rests on a vertex in the middle of the cell
_TOGETHER = 4  # vertices near the line that are looked at one by one
_ON_LINE = 1e-13  # height, relative to the radius, that is rounding


@compiled
def median_events(edges: Floats, radius: float) -> tuple[Floats, Ints, Floats]:
    """Return directions of events, their vertices, and the sides of all vertices before the first.

    Vertex i is where edge i starts; its side is 1 left of the median, -1 right of it, for the
    direction `START`; events lie between `START` and `START` + pi, in no order.
    """
    n = edges.shape[0]
    kept, stack = whole_turn(edges, radius)
    z = median_at(edges, kept, stack[-1].known, START, 0.0, -radius, radius)
    before = np.empty(n)
    for i in range(n):
        before[i] = 1.0 if _height(edges, i, START, z) > 0.0 else -1.0
    side = before.copy()
    theta = np.empty(64)
    vertex = np.empty(64, dtype=np.int32)
    used = 0
    while len(stack) > 0:
        view = look(edges, radius, kept, stack.pop())
        near, doubtful = _near(edges, kept, view, _ON_LINE * radius)
        if near == 0:
            continue
        if view.half > _NARROW and (doubtful or near > _TOGETHER):
            right, left = halves(view)
            stack.append(right)
            stack.append(left)
            continue
        z = median_in(edges, kept, view, view.right)[0]
        for i in kept[view.known.first : view.known.first + view.known.number]:
            height = _height(edges, i, view.right, z)
            if abs(height) > _ON_LINE * radius and height * side[i] < 0.0:
                if used == theta.shape[0]:
                    theta = np.concatenate((theta, np.empty_like(theta)))
                    vertex = np.concatenate((vertex, np.empty_like(vertex)))
                theta[used] = _passing(edges, kept, view, i, side[i])
                vertex[used] = i
                used += 1
                side[i] = -side[i]
    return theta[:used], vertex[:used], before


@compiled
def _height(edges: Floats, i: int, theta: float, z: float) -> float:
    height: float = np.cos(theta) * edges[i, 1] - np.sin(theta) * edges[i, 0] - z
    return height


@compiled
def _near(edges: Floats, kept: Ints, view: View, rounding: float) -> tuple[int, bool]:
    """Return how many vertices the median may meet, and if one of them more than once."""
    near, doubtful = 0, False
    cos, sin = np.cos(view.theta), np.sin(view.theta)
    for i in kept[view.known.first : view.known.first + view.known.number]:
        height = abs(_height(edges, i, view.theta, view.z))
        if height <= view.strip:
            near += 1
            lever = abs(cos * edges[i, 0] + sin * edges[i, 1] - view.middle)
            rests = height <= rounding and lever <= 10 * rounding and view.half <= _PIVOT
            doubtful |= lever <= view.drift and not rests
    return near, doubtful


@compiled
def _passing(edges: Floats, kept: Ints, view: View, i: int, side: float) -> float:
    """Return where the median passes vertex i: Newton steps kept inside a bracket."""
    left, right = view.left, view.right
    theta = view.theta
    for _ in range(100):
        z, _, _, _, _, middle = median_in(edges, kept, view, theta)
        height = _height(edges, i, theta, z)
        if height * side > 0.0:
            left = theta
        else:
            right = theta
        lever = middle - np.cos(theta) * edges[i, 0] - np.sin(theta) * edges[i, 1]
        step = theta - height / lever if lever != 0.0 else left
        if not left < step < right:
            step = 0.5 * (left + right)
        if abs(step - theta) <= 1e-15 or step in (left, right):
            return step
        theta = step
    return theta
