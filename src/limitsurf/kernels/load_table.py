r"""Loads as functions of time: Chebyshev series on pieces of the time axis.

On a piece :math:`[t_0, t_1]`, with :math:`s = (2t - t_0 - t_1)/(t_1 - t_0)`, each component is
:math:`F = \sum_k c_k T_k(s)`, summed with its derivative by Clenshaw's recurrence

.. math:: b_k = c_k + 2 s b_{k+1} - b_{k+2}, \qquad F = c_0 + s b_1 - b_2

(C. W. Clenshaw, *A note on the summation of Chebyshev series*, Math. Comp. 9, 1955). The load on a
piece also stays in the convex hull of its Bernstein coefficients.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.vectors import Vector

__all__ = ["CONSTANT", "NONE", "VARIES", "Load", "load_at", "piece_of", "turned"]

NONE, CONSTANT, VARIES = 0, 1, 2


class Load(NamedTuple):
    """A row for each piece: begin, end, three series of K terms, three times K Bernstein's.

    One array, for kernels count the references to each array that they are handed.
    """

    pieces: Floats
    terms: int
    kind: int


@compiled
def piece_of(load: Load, t: float) -> int:
    """Return the piece that a time lies in; the first or last one for times outside."""
    pieces = load.pieces
    low, high = 0, pieces.shape[0]
    while high - low > 1:
        middle = (low + high) // 2
        if t < pieces[middle, 0]:
            high = middle
        else:
            low = middle
    return low


@compiled
def _clenshaw(pieces: Floats, i: int, begin: int, n: int, s: float) -> tuple[float, float]:
    """Return value and derivative at s of the series that begins in a column of row i."""
    b1 = b2 = d1 = d2 = 0.0
    for k in range(begin + n - 1, begin, -1):
        d1, d2 = 2.0 * (b1 + s * d1) - d2, d1
        b1, b2 = pieces[i, k] + 2.0 * s * b1 - b2, b1
    return pieces[i, begin] + s * b1 - b2, b1 + s * d1 - d2


@compiled
def load_at(load: Load, t: float) -> tuple[Vector, Vector]:
    """Return the load at a time, and its rate."""
    p = load.pieces
    if load.kind != VARIES:
        return (p[0, 2], p[0, 3], p[0, 4]), (0.0, 0.0, 0.0)
    i, n = piece_of(load, t), load.terms
    half = 0.5 * (p[i, 1] - p[i, 0])
    s = (t - p[i, 0]) / half - 1.0
    fx, dx = _clenshaw(p, i, 2, n, s)
    fy, dy = _clenshaw(p, i, 2 + n, n, s)
    m, dm = _clenshaw(p, i, 2 + 2 * n, n, s)
    return (fx, fy, m), (dx / half, dy / half, dm / half)


@compiled
def turned(v: Vector, angle: float) -> Vector:
    """Return a load or twist seen in axes turned by an angle."""
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * v[0] + sin * v[1], cos * v[1] - sin * v[0], v[2]
