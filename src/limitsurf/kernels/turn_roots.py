r"""All sign changes of U' in half a turn, each in a cell of directions that holds no other.

Branch and bound. A cell of half width h about theta holds no root if ``|U'(theta)| > h max |U''|``,
and at most one if U'' keeps its sign; `look` encloses U''. Other cells are halved, until U' is
rounding in all of the cell.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.median_cell import LEAST, whole_turn
from limitsurf.kernels.median_view import View, halves, look, median_in

__all__ = ["CLEAR", "FLAT", "MONOTONE", "ROOT", "slope_signs"]

CLEAR, ROOT, MONOTONE, FLAT = 0, 1, 2, 3  # kinds of cells


@compiled
def slope_signs(edges: Floats, radius: float, floor: float) -> tuple[Floats, int]:
    """Return cells that cover half a turn in order, and how many were looked at.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges, area 1, centroid at the origin.
    radius : float
        Largest distance of a vertex from the centroid.
    floor : float
        ``|U'|`` up to this is rounding.

    Returns
    -------
    rows : (m, 6) float
        ``left, right, kind, sign of U'' or of U', root, U' there``. CLEAR: U' has one sign; ROOT:
        one simple sign change; MONOTONE: at most one, U' is rounding at an end; FLAT: U' is
        rounding, or the cell is too narrow to tell.
    looked : int
    """
    kept, stack = whole_turn(edges, radius)
    rows = np.empty((64, 6))
    used = 0
    looked = 0
    while len(stack) > 0:
        cell = stack.pop()
        view = look(edges, radius, kept, cell)
        looked += 1
        steepest = view.half * max(-view.low, view.high)
        root, residual = view.theta, view.slope
        if abs(view.slope) > steepest + floor:
            kind, sign = CLEAR, np.sign(view.slope)
        elif abs(view.slope) + steepest <= floor or view.half < LEAST:
            kind, sign = FLAT, 0.0
        elif view.low > 0.0 or view.high < 0.0:
            kind, sign, root, residual = _monotone(edges, kept, view, floor)
        else:
            right, left = halves(view)
            stack.append(right)
            stack.append(left)
            continue
        if used > 0 and kind == CLEAR and rows[used - 1, 2] == CLEAR and rows[used - 1, 3] == sign:
            rows[used - 1, 1] = cell.right
            continue
        if used == rows.shape[0]:
            rows = np.concatenate((rows, np.empty_like(rows)))
        rows[used, 0] = cell.left
        rows[used, 1] = cell.right
        rows[used, 2] = kind
        rows[used, 3] = sign
        rows[used, 4] = root
        rows[used, 5] = residual
        used += 1
    return rows[:used], looked


@compiled
def _monotone(
    edges: Floats, kept: Ints, view: View, floor: float
) -> tuple[int, float, float, float]:
    """Return kind, sign, root and residual of a cell in which U' rises or falls throughout."""
    before = median_in(edges, kept, view, view.left)[2]
    after = median_in(edges, kept, view, view.right)[2]
    if min(abs(before), abs(after)) <= floor:
        return MONOTONE, np.sign(view.low), view.theta, view.slope
    if (before > 0.0) == (after > 0.0):
        return CLEAR, np.sign(before), view.theta, view.slope
    root, residual = _polish(edges, kept, view, np.sign(after))
    return ROOT, np.sign(after), root, residual


@compiled
def _polish(edges: Floats, kept: Ints, view: View, rising: float) -> tuple[float, float]:
    """Return the root of U' in a cell and U' there: Newton steps kept inside a bracket."""
    left, right = view.left, view.right
    theta, slope, curvature = view.theta, view.slope, 2.0 * view.second - view.energy
    best, least = theta, abs(slope)
    for _ in range(100):
        if slope == 0.0:
            return theta, slope
        if (slope > 0.0) == (rising > 0.0):
            right = theta
        else:
            left = theta
        step = theta - slope / curvature
        if not left < step < right:
            step = 0.5 * (left + right)
        if abs(step - theta) <= 4e-16 or step in (left, right):
            break
        theta = step
        _, energy, slope, second, _, _ = median_in(edges, kept, view, theta)
        curvature = 2.0 * second - energy
        if abs(slope) < least:
            best, least = theta, abs(slope)
    return best, least
