r"""Support points that are consistent: the convex body nearest to measured loads.

Loads F_i measured while a part moved along v_i are support points of a convex set if none lies
beyond another's supporting plane. The nearest points that do solve a quadratic program,

.. math:: \min \sum_i w_i |x_i - F_i|^2 \quad \text{so that} \quad v_i \cdot (x_j - x_i) \le 0

(R. J. Gardner, M. Kiderlen, *A new algorithm for 3D reconstruction from support functions*, 2009,
with points in place of support values). Of passive contacts -F_i and -v_i are pairs too. Of the
n^2 conditions few bind: those that are violated are added until none is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from limitsurf.errors import SolveFailed

__all__ = ["consistent_points", "violations"]

Array = NDArray[np.float64]

_ROUNDS, _AT_ONCE = 200, 4  # rounds of new conditions, and of each point in each
_ALLOWED = 1e-6  # what may be left, relative to the loads


def violations(points: Array, motions: Array, symmetric: bool) -> tuple[Array, Array]:
    """Return how far -x_j, if symmetric, and x_j stick out beyond x_i along v_i, (n, n) each."""
    heights = motions @ points.T
    own = np.diag(heights)[:, None]
    plus = heights - own
    minus = -heights - own if symmetric else np.full_like(heights, -np.inf)
    return minus, plus


def consistent_points(loads: Array, motions: Array, weight: Array, symmetric: bool) -> Array:
    """Return the points x (n, 3) nearest to `loads` that are support points along `motions`.

    Raises
    ------
    SolveFailed
        Clarabel stops early, or conditions stay violated.
    """
    n, size = len(loads), float(np.abs(loads).max())
    points = loads / size
    kept: set[tuple[int, int, int]] = set()
    for _ in range(_ROUNDS):
        new = _most_violated(points, motions, symmetric) - kept
        if not new:
            return np.asarray(points * size)
        kept |= new
        points = _nearest(loads / size, weight / weight.mean(), _rows(kept, motions, n))
    raise SolveFailed("fit: support points did not become consistent", best=points * size)


def _most_violated(points: Array, motions: Array, symmetric: bool) -> set[tuple[int, int, int]]:
    """Return, for each i and sign, the j that stick out most."""
    found = set()
    for sign, over in zip((-1, 1), violations(points, motions, symmetric), strict=True):
        worst = np.argsort(over, axis=1)[:, -_AT_ONCE:]
        i = np.repeat(np.arange(len(over)), worst.shape[1])
        j = worst.ravel()
        out = over[i, j] > _ALLOWED
        found |= {(int(a), int(b), sign) for a, b in zip(i[out], j[out], strict=True)}
    return found


def _rows(kept: set[tuple[int, int, int]], motions: Array, n: int) -> sparse.csc_matrix:
    """Return A with ``A x <= 0``, rows ``v_i . (sign x_j - x_i)``."""
    i, j, sign = np.array(sorted(kept)).T
    row = np.repeat(np.arange(len(i)), 3)
    axis = np.tile(np.arange(3), len(i))
    v = motions[i]
    shape = (len(i), 3 * n)
    own = sparse.csc_matrix((-v.ravel(), (row, 3 * np.repeat(i, 3) + axis)), shape)
    other = (sign[:, None] * v).ravel()
    return own + sparse.csc_matrix((other, (row, 3 * np.repeat(j, 3) + axis)), shape)


def _nearest(loads: Array, weight: Array, A: sparse.csc_matrix) -> Array:
    import cvxpy as cp

    x: Any = cp.Variable(loads.size)
    root = np.repeat(np.sqrt(weight), 3)
    distance = cp.sum_squares(cp.multiply(root, x - loads.ravel()))
    problem = cp.Problem(cp.Minimize(distance), [A @ x <= 0])
    problem.solve("CLARABEL", tol_gap_abs=1e-11, tol_gap_rel=1e-11, tol_feas=1e-11)
    if x.value is None or problem.status not in ("optimal", "optimal_inaccurate"):
        raise SolveFailed(f"fit: Clarabel ended with {problem.status}", best=loads)
    return np.asarray(x.value).reshape(-1, 3)
