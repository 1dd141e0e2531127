r"""Closest point of an ellipsoid of any rank: the Model Trust Region problem.

With the singular value decomposition :math:`A = U S V^T` and :math:`b = U^T (p - c)`, the closest
point of :math:`\{c + A u : |u| \le 1\}` is :math:`c + U S y`, where

.. math:: y_j = \frac{s_j b_j}{s_j^2 + \lambda}, \qquad \lambda \ge 0, \quad |y| \le 1,

and :math:`\lambda = 0` or :math:`|y| = 1`. The secular equation :math:`1/|y(\lambda)| = 1` is
nearly linear; Newton's method is kept inside a bracket (More and Sorensen, SIAM J. Sci. Stat.
Comput. 4, 1983). Forming :math:`A^T A` would square the condition number; with U and S given, flat
ellipsoids (rank below the dimension) need nothing special.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["closest_on_ellipsoid"]

_EPS = float(np.finfo(np.float64).eps)


@compiled
def _norm_and_slope(s: Floats, b: Floats, shift: float) -> tuple[float, float]:
    """Return ``|y|^2`` and ``sum y_j^2 / (s_j^2 + shift)``, minus half its derivative."""
    total = 0.0
    slope = 0.0
    for j in range(s.shape[0]):
        d = s[j] * s[j] + shift
        y = s[j] * b[j] / d
        total += y * y
        slope += y * y / d
    return total, slope


@compiled
def _secular_root(s: Floats, b: Floats) -> tuple[float, int]:
    """Return lambda > 0 with ``|y(lambda)| = 1``, given ``|y(0)| > 1``; and the iterations."""
    high = 0.0
    low = 0.0
    for j in range(s.shape[0]):
        high += s[j] * abs(b[j])  # |y| < |s b| / lambda
        low = max(low, s[j] * (abs(b[j]) - s[j]))  # |y_j| = 1
    shift = low
    for iteration in range(1, 100):  # three or four do; rounding may make the last ones waver
        total, slope = _norm_and_slope(s, b, shift)
        norm = math.sqrt(total)
        if abs(norm - 1.0) <= 2 * _EPS:
            return shift, iteration
        if norm > 1.0:
            low = max(low, shift)
        else:
            high = min(high, shift)
        step = shift + (norm - 1.0) * total / slope
        if not low <= step <= high:
            step = math.sqrt(low * high) if low > 0.0 else 0.5 * high
        if abs(step - shift) <= 4 * _EPS * step or high - low <= 4 * _EPS * high:
            return step, iteration
        shift = step
    return shift, 100


@compiled
def closest_on_ellipsoid(
    points: Floats,
    center: Floats,
    U: Floats,
    s: Floats,
    closest: Floats,
    bound: Floats,
    count: Ints,
) -> None:
    """Fill the closest points of ``{c + U S y : |y| <= 1}``, error bounds, and iterations.

    Parameters
    ----------
    points : (k, n) float
        Points p.
    center, U, s : (n,), (n, r), (r,) float
        Centre, orthonormal columns, singular values > 0.
    closest : (k, n) float
        Receives the closest points.
    bound : (k,) float
        Receives certified errors. For unit y and lambda >= 0 the vector g with
        ``U'g = lambda y / s`` is exactly an outer normal at ``c + U S y``; the error is at most
        ``|p - x - g|``. Only rounding is added.
    count : (k,) int32
        Receives the iterations; 0 means that p lies in the set or above its inside, -1 that the
        bound is no rounding error: the iteration did not converge.
    """
    n, r = U.shape
    b, unit = np.empty(r), 1.0
    if r > 0:
        unit = s.max()  # products of semi-axes overflow where they are large or small
    t = s / unit
    for k in range(points.shape[0]):
        inside, size = _coordinates(points[k], center, U, s, b)
        b /= unit
        shift = 0.0
        norm = 1.0
        count[k] = 0
        if inside > 1.0:
            shift, count[k] = _secular_root(t, b)
            norm = math.sqrt(_norm_and_slope(t, b, shift)[0])
        closest[k] = center
        residual = 0.0
        for j in range(r):
            y = t[j] * b[j] / (t[j] * t[j] + shift) / norm
            residual += (b[j] - t[j] * y - shift * y / t[j]) ** 2
            for i in range(n):
                closest[k, i] += U[i, j] * s[j] * y
        bound[k] = unit * math.sqrt(residual) + 4 * (n + r) * _EPS * size
        if bound[k] > 1e-9 * size:
            count[k] = -1


@compiled
def _coordinates(p: Floats, center: Floats, U: Floats, s: Floats, b: Floats) -> tuple[float, float]:
    """Fill ``b = U'(p - c)``; return ``|b/s|^2`` and the size of the problem."""
    inside = 0.0
    size = max(np.abs(p).max(), np.abs(center).max())
    for j in range(s.shape[0]):
        b[j] = 0.0
        for i in range(p.shape[0]):
            b[j] += U[i, j] * (p[i] - center[i])
        inside += (b[j] / s[j]) ** 2
        size = max(size, s[j])
    return inside, size
