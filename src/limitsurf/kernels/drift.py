r"""The speed at which the mean friction of an oscillating tip vanishes: a weighted median.

Along the tip's direction the mean friction at slip-free speed p is, up to its sign,
:math:`g(p) = \operatorname{mean}\, N \operatorname{sign}(p - w)`, which rises with p: the drift is
the median of w weighted by N. Between two neighbouring samples in size g is a quadratic of p.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["drift_speeds"]

_ROUNDING = 4e-16


@compiled
def _balance(w: Floats, N: Floats, p: float, side: float) -> float:
    """Return K g(p), where the tip moves at p itself counted as slower (1) or faster (-1)."""
    total = 0.0
    K = w.shape[0]
    for k in range(K):
        j = k + 1 if k + 1 < K else 0
        a, b, area = w[k] - p, w[j] - p, 0.5 * (N[k] + N[j])
        if a == 0.0 and b == 0.0:
            total += side * area
        elif a >= 0.0 and b >= 0.0:
            total -= area
        elif a <= 0.0 and b <= 0.0:
            total += area
        else:
            s = a / (a - b)
            crossing = (1.0 - s) * N[k] + s * N[j]
            first, last = 0.5 * s * (N[k] + crossing), 0.5 * (1.0 - s) * (crossing + N[j])
            total += last - first if a > 0.0 else first - last
    return total


@compiled
def _lowest(w: Floats, N: Floats, slack: float) -> float:
    """Return the least p with ``K g(p+) >= -slack``."""
    knots = np.sort(w)
    low, high = -1, knots.shape[0] - 1  # g falls short at low, not at high
    while high - low > 1:
        middle = (low + high) // 2
        if _balance(w, N, knots[middle], 1.0) >= -slack:
            high = middle
        else:
            low = middle
    right = knots[high]
    end = _balance(w, N, right, -1.0) + slack
    if low < 0 or end < 0.0:
        return float(right)
    left = knots[low]
    start = _balance(w, N, left, 1.0) + slack
    half = _balance(w, N, 0.5 * (left + right), 1.0) + slack
    slope, bend = 4.0 * half - 3.0 * start - end, 2.0 * (start + end) - 4.0 * half
    root = math.sqrt(max(slope * slope - 4.0 * bend * start, 0.0))
    share = -2.0 * start / (slope + root) if slope + root > 0.0 else 1.0
    return float(left + min(max(share, 0.0), 1.0) * (right - left))


@compiled
def drift_speeds(w: Floats, N: Floats, out: Floats) -> None:
    """Fill the drift speeds of tips; of several, the slowest; 0 for tips that never touch.

    Parameters
    ----------
    w, N : (n, K) float
        Tip velocities and normal forces at the samples.
    out : (n,) float
        The answers.
    """
    for i in range(w.shape[0]):
        total = N[i].sum()
        out[i] = 0.0
        if total > 0.0:
            slack = _ROUNDING * total
            low, high = _lowest(w[i], N[i], slack), -_lowest(-w[i], N[i], slack)
            out[i] = min(max(0.0, min(low, high)), max(low, high))
