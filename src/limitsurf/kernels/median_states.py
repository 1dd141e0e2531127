"""Medians and squeeze energies in many directions: the edges near each line are found by halving.

The slow twin, one sum over all edges a direction, is `limitsurf.kernels.median.squeeze_states`.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.median_cell import LEAST, median_at, state_in, whole_turn
from limitsurf.kernels.median_view import halves, look

__all__ = ["median_states"]

_FEW = 24  # edges: fewer are not worth a closer look


@compiled
def median_states(edges: Floats, radius: float, theta: Floats) -> Floats:
    """Return rows ``(z, U, U', J, chord length, s_m)`` at the medians of sorted directions.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges, area 1, centroid at the origin.
    radius : float
        Largest distance of a vertex from the centroid.
    theta : (m,) float
        Ascending, from `START` to less than `START` + pi.
    """
    out = np.empty((theta.shape[0], 6))
    kept, stack = whole_turn(edges, radius)
    limits = [np.searchsorted(theta, cell.left) for cell in stack]
    spans = [(limits[k], limits[k - 1] if k > 0 else theta.shape[0]) for k in range(len(stack))]
    while len(stack) > 0:
        cell = stack.pop()
        first, after = spans.pop()
        if first == after:
            continue
        same = theta[after - 1] - theta[first] <= LEAST
        if same or cell.known.number <= _FEW or cell.right - cell.left <= 2 * LEAST:
            for i in range(first, after):
                z = median_at(edges, kept, cell.known, theta[i], cell.z, cell.low, cell.high)
                out[i, 0] = z
                out[i, 1:] = state_in(edges, kept, cell.known, theta[i], z)
            continue
        view = look(edges, radius, kept, cell)
        middle = first + np.searchsorted(theta[first:after], view.theta)
        right, left = halves(view)
        stack.append(right)
        spans.append((middle, after))
        stack.append(left)
        spans.append((first, middle))
    return out
