r"""One Newton step past a kink: a quadratic model plus one contact, exactly.

.. math:: \min_d\; \tfrac12 d^T B d + b^T d + m\,|u + P^T d|, \qquad P = G S \in R^{3 \times 2}.

Optimality: :math:`B d = -(b + m P f)` with :math:`|f| \le 1`, and :math:`f = p/|p|` unless
:math:`p = u + P^T d = 0`. With :math:`K = m P^T B^{-1} P` and :math:`q = u - P^T B^{-1} b`,
:math:`p = q - K f`. So p = 0 if :math:`|K^{-1} q| \le 1`; else :math:`(\sigma I + K) f = q` with
:math:`|f| = 1` and :math:`\sigma = |p|`, a secular equation in the plane (More and
Sorensen, SIAM J. Sci. Stat. Comput. 4, 1983).
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.contact_pass import Kink
from limitsurf.kernels.symmetric3 import Symmetric, factored, solve
from limitsurf.kernels.vectors import Vector, along, dot, length, scaled

__all__ = [
    "FLAT",
    "Pair",
    "axes_of",
    "kink_columns",
    "kink_force_in_plane",
    "kink_step",
    "snapped",
    "step_of_solved",
]

Pair = tuple[float, float]

_EPS = float(np.finfo(np.float64).eps)
FLAT = 16.0 * _EPS


@compiled
def kink_columns(kink: Kink) -> tuple[Vector, Vector]:
    """Return the columns of ``P = G S``: loads of unit forces."""
    a, b, d = kink.stretch
    x, y = kink.x, kink.y
    return (a, b, x * b - y * a), (b, d, x * d - y * b)


@compiled
def axes_of(k00: float, k01: float, k11: float) -> tuple[float, float, Pair]:
    """Return the eigenvalues of K, the larger first, and its axis, without cancellation."""
    mean, half = 0.5 * (k00 + k11), 0.5 * (k00 - k11)
    spread = length(half, k01)
    if spread == 0.0:
        return mean, mean, (1.0, 0.0)
    axis = (spread + half, k01) if half >= 0.0 else (k01, spread - half)
    size = length(axis[0], axis[1])
    return mean + spread, max(mean - spread, 0.0), (axis[0] / size, axis[1] / size)


@compiled
def _secular_root(high: float, low: float, a: float, b: float) -> float:
    """Return sigma > 0 with ``(a / (sigma + high))^2 + (b / (sigma + low))^2 = 1``."""
    sigma, right = max(abs(a) - high, abs(b) - low, 0.0), length(a, b)
    left = sigma
    for _ in range(60):
        fa, fb = a / (sigma + high), b / (sigma + low)
        square = fa * fa + fb * fb
        norm = math.sqrt(square)
        if norm > 1.0:
            left = sigma
        else:
            right = sigma
        step = sigma + (norm - 1.0) * square / (fa * fa / (sigma + high) + fb * fb / (sigma + low))
        if not left <= step <= right:
            step = 0.5 * (left + right)
        if abs(step - sigma) <= 2.0 * _EPS * step:
            return step
        sigma = step
    return sigma


@compiled
def kink_force_in_plane(k00: float, k01: float, k11: float, q: Pair) -> tuple[Pair, bool]:
    """Return the force f in the unit disk, and whether the contact stands still (p = 0).

    K has rank one for a contact that pushes along one line only; q then lies along it too.
    """
    high, low, (cos, sin) = axes_of(k00, k01, k11)
    a, b = cos * q[0] + sin * q[1], cos * q[1] - sin * q[0]
    if low <= FLAT * high:
        still = abs(a) <= high
        fa, fb = (a / high if still and high > 0.0 else math.copysign(1.0, a)), 0.0
    else:
        fa, fb = a / high, b / low
        still = fa * fa + fb * fb <= 1.0
        if not still:
            sigma = _secular_root(high, low, a, b)
            fa, fb = a / (sigma + high), b / (sigma + low)
            size = length(fa, fb)
            fa, fb = fa / size, fb / size
    return (cos * fa - sin * fb, sin * fa + cos * fb), still


@compiled
def kink_step(B: Symmetric, b: Vector, kink: Kink, u: Pair) -> tuple[bool, Vector, Pair, bool]:
    """Return whether B is positive definite, the step d, the force f, and whether p = 0."""
    ok, L = factored(B)
    if not ok:
        return False, b, (0.0, 0.0), False
    z = solve(B, L, b)
    if kink.contact < 0:
        return True, scaled(-1.0, z), (0.0, 0.0), False
    one, two = kink_columns(kink)
    d, f, still = step_of_solved(z, solve(B, L, one), solve(B, L, two), kink, u)
    return True, d, f, still


@compiled
def step_of_solved(
    z: Vector, k1: Vector, k2: Vector, kink: Kink, u: Pair
) -> tuple[Vector, Pair, bool]:
    """Return step, force and whether p = 0, given ``z = B^-1 b`` and ``B^-1 P``."""
    one, two = kink_columns(kink)
    m = kink.mass
    q = u[0] - dot(one, z), u[1] - dot(two, z)
    f, still = kink_force_in_plane(m * dot(one, k1), m * dot(one, k2), m * dot(two, k2), q)
    return along(along(scaled(-1.0, z), -m * f[0], k1), -m * f[1], k2), f, still


@compiled
def snapped(kink: Kink, v: Vector) -> Vector:
    """Return the twist about the kink nearest to v."""
    w = (v[0] * kink.y - v[1] * kink.x + v[2]) / (1.0 + kink.x * kink.x + kink.y * kink.y)
    return w * kink.y, -w * kink.x, w
