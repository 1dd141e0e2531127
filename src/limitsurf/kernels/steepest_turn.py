r"""The largest ``|U'/U|`` over all directions, by branch and bound.

With :math:`q = U'/U`, :math:`q' = U''/U - q^2`; `look` encloses U'' and with it q' over a cell of
directions. Cells in which ``|q| + h max |q'|`` stays below a value already met are dropped.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.median_cell import LEAST, whole_turn
from limitsurf.kernels.median_view import View, halves, look

__all__ = ["steepest_turn"]

_RELATIVE, _ABSOLUTE = 1e-12, 1e-14  # of the answer: rounding


@compiled
def steepest_turn(edges: Floats, radius: float) -> tuple[float, float]:
    """Return the largest ``|U'/U|`` and the direction in which it is met.

    Edges are directed, of area 1 about the centroid; `radius` is the largest distance of a vertex.
    """
    kept, stack = whole_turn(edges, radius)
    best, where = 0.0, 0.0
    while len(stack) > 0:
        view = look(edges, radius, kept, stack.pop())
        ratio = view.slope / view.energy
        if abs(ratio) > best:
            best, where = abs(ratio), view.theta
        if view.half < LEAST or _bound(view) <= best * (1.0 + _RELATIVE) + _ABSOLUTE:
            continue
        right, left = halves(view)
        rate = (2.0 * view.second - view.energy) / view.energy - ratio * ratio
        if rate * ratio > 0.0:  # |q| rises: the right half raises `best` sooner
            left, right = right, left
        stack.append(right)
        stack.append(left)
    return best, where


@compiled
def _bound(view: View) -> float:
    h = view.half
    slope = abs(view.slope)
    steep = h * max(-view.low, view.high)  # U' changes by at most this
    least, most = view.energy - h * (slope + steep), view.energy + h * (slope + steep)
    if least <= 0.0:
        return np.inf
    large, small = (slope + steep) / least, max(slope - steep, 0.0) / most
    low = view.low / (least if view.low < 0.0 else most) - large * large
    high = view.high / (least if view.high > 0.0 else most) - small * small
    return min(large, slope / view.energy + h * max(-low, high))
