r"""Loads as functions of time: Chebyshev series on pieces of the time axis.

On a piece :math:`[t_0, t_1]`, with :math:`s = (2t - t_0 - t_1)/(t_1 - t_0)`, each component is
:math:`F = \sum_k c_k T_k(s)`, summed with its derivative by Clenshaw's recurrence

.. math:: b_k = c_k + 2 s b_{k+1} - b_{k+2}, \qquad F = c_0 + s b_1 - b_2

(C. W. Clenshaw, *A note on the summation of Chebyshev series*, Math. Comp. 9, 1955). `boxes` holds
the ranges of the Bernstein coefficients of a piece, between which the load stays.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.vectors import Vector

__all__ = ["CONSTANT", "NONE", "VARIES", "Load", "load_at", "piece_of", "turned"]

NONE, CONSTANT, VARIES = 0, 1, 2


class Load(NamedTuple):
    """Ends (P + 1,) of the pieces, series (P, 3, K), Bernstein coefficients (P, 3, K), kind."""

    ends: Floats
    series: Floats
    bernstein: Floats
    kind: int


@compiled
def piece_of(ends: Floats, t: float) -> int:
    """Return the piece that a time lies in; the first or last one for times outside."""
    low, high = 0, ends.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if t < ends[middle]:
            high = middle
        else:
            low = middle
    return low


@compiled
def _clenshaw(c: Floats, s: float) -> tuple[float, float]:
    """Return value and derivative of a Chebyshev series at s."""
    b1 = b2 = d1 = d2 = 0.0
    for k in range(c.shape[0] - 1, 0, -1):
        d1, d2 = 2.0 * (b1 + s * d1) - d2, d1
        b1, b2 = c[k] + 2.0 * s * b1 - b2, b1
    return c[0] + s * b1 - b2, b1 + s * d1 - d2


@compiled
def load_at(load: Load, t: float) -> tuple[Vector, Vector]:
    """Return the load at a time, and its rate."""
    if load.kind == NONE:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    c = load.series
    if load.kind == CONSTANT:
        return (c[0, 0, 0], c[0, 1, 0], c[0, 2, 0]), (0.0, 0.0, 0.0)
    i = piece_of(load.ends, t)
    half = 0.5 * (load.ends[i + 1] - load.ends[i])
    s = (t - load.ends[i]) / half - 1.0
    fx, dx = _clenshaw(c[i, 0], s)
    fy, dy = _clenshaw(c[i, 1], s)
    m, dm = _clenshaw(c[i, 2], s)
    return (fx, fy, m), (dx / half, dy / half, dm / half)


@compiled
def turned(v: Vector, angle: float) -> Vector:
    """Return a load or twist seen in axes turned by an angle."""
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * v[0] + sin * v[1], cos * v[1] - sin * v[0], v[2]
