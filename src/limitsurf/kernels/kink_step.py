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
from limitsurf.kernels.symmetric3 import Symmetric, factored, solve, times
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
def axes_of(a: float, b: float, d: float) -> tuple[float, float, float, float]:
    """Return the eigenvalues of ``[[a, b], [b, d]]``, larger first, and the axis of the larger."""
    half = 0.5 * (a - d)
    spread = length(half, b)
    high = 0.5 * (a + d) + spread
    low = max(a * d - b * b, 0.0) / high if high > 0.0 else 0.0
    cos, sin = 1.0, 0.0
    if spread > 0.0:  # without cancellation
        cos, sin = (spread + half, b) if half >= 0.0 else (b, spread - half)
        size = length(cos, sin)
        cos, sin = cos / size, sin / size
    return high, low, cos, sin


@compiled
def kink_force_in_plane(
    k00: float, k01: float, k11: float, q: Pair, line: bool = False
) -> tuple[Pair, bool]:
    """Return the force f in the unit disk, and whether the contact stands still (p = 0).

    `line` says that the contact pushes along one line only: K and q have no other component.
    """
    high, low, cos, sin = axes_of(k00, k01, k11)
    a, b = cos * q[0] + sin * q[1], cos * q[1] - sin * q[0]  # in the axes of K
    if high == 0.0 or (a == 0.0 and b == 0.0):
        return (0.0, 0.0), True
    if line:
        fa = max(-1.0, min(a / high, 1.0))
        return (cos * fa, sin * fa), abs(a) <= high
    if low > 0.0 and length(a / high, b / low) <= 1.0:
        fa, fb = a / high, b / low
        return (cos * fa - sin * fb, sin * fa + cos * fb), True
    fa, fb = _secular_force(high, low, a, b)
    return (cos * fa - sin * fb, sin * fa + cos * fb), False


@compiled
def _secular_force(high: float, low: float, a: float, b: float) -> Pair:
    """Return the unit f with ``(sigma I + K) f = q``, sigma > 0, in the axes of K."""
    left, right = max(abs(a) - high, abs(b) - low, 0.0), length(a, b)
    sigma = left
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
            break
        sigma = step
    fa, fb = a / (sigma + high), b / (sigma + low)
    norm = length(fa, fb)
    return fa / norm, fb / norm


@compiled
def kink_step(B: Symmetric, b: Vector, kink: Kink, u: Pair) -> tuple[bool, Vector, Pair, bool]:
    """Return whether B is positive definite, the step d, the force f, and whether p = 0."""
    if kink.contact >= 0 and kink.stretch == (1.0, 0.0, 1.0):
        return _step_about(B, b, kink, u)
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
def _unit_force(a: float, b: float, d: float, m: float, r: Pair) -> tuple[Pair, float]:
    """Return the unit f, and sigma, with ``(m I + sigma A) f = r``, for ``|r| > m``."""
    high, low, cos, sin = axes_of(a, b, d)
    ra, rb = cos * r[0] + sin * r[1], cos * r[1] - sin * r[0]  # in the axes of A
    excess = length(ra, rb) - m
    sigma = left = max(excess / high, (abs(rb) - m) / low)
    right = excess / low
    for _ in range(60):
        wa, wb = m + sigma * high, m + sigma * low
        square = (ra / wa) ** 2 + (rb / wb) ** 2
        norm = math.sqrt(square)
        if norm > 1.0:
            left = sigma
        else:
            right = sigma
        falls = (ra / wa) ** 2 * high / wa + (rb / wb) ** 2 * low / wb
        step = sigma + (norm - 1.0) * square / falls
        if not left <= step <= right:
            step = 0.5 * (left + right)
        if abs(step - sigma) <= 2.0 * _EPS * step:
            break
        sigma = step
    fa, fb = ra / (m + sigma * high), rb / (m + sigma * low)
    norm = length(fa, fb)
    return ((cos * fa - sin * fb) / norm, (sin * fa + cos * fb) / norm), sigma


@compiled
def _step_about(B: Symmetric, b: Vector, kink: Kink, u: Pair) -> tuple[bool, Vector, Pair, bool]:
    r"""Return what `kink_step` does, for a disk, without inverting a nearly singular B.

    With n the rotation about the contact, :math:`G^T n = 0`, and :math:`d = (\delta, 0) + w n`, the
    model is least over w first. A, the Schur complement of n, is left: :math:`A p + m f = r` for
    :math:`p = u + \delta`, so that p = 0 if :math:`|r| \le m`, else :math:`(m + \sigma A) f = r`.
    """
    n, m = (kink.y, -kink.x, 1.0), kink.mass
    Bn = times(B, n)
    turning, gw = dot(n, Bn), dot(n, b)
    if not turning > 0.0:
        return False, b, (0.0, 0.0), False
    cx, cy = Bn[0] / turning, Bn[1] / turning
    a00, a01, a11 = B[0] - cx * Bn[0], B[1] - cx * Bn[1], B[2] - cy * Bn[1]
    if not (a00 > 0.0 and a00 * a11 - a01 * a01 > 0.0):
        return False, b, (0.0, 0.0), False
    r = a00 * u[0] + a01 * u[1] - b[0] + cx * gw, a01 * u[0] + a11 * u[1] - b[1] + cy * gw
    still = length(r[0], r[1]) <= m
    if still:
        f, sigma = (r[0] / m, r[1] / m), 0.0
    else:
        f, sigma = _unit_force(a00, a01, a11, m, r)
    dx, dy = sigma * f[0] - u[0], sigma * f[1] - u[1]
    w = -(gw / turning + cx * dx + cy * dy)
    return True, along((dx, dy, 0.0), w, n), f, still


@compiled
def step_of_solved(
    z: Vector, k1: Vector, k2: Vector, kink: Kink, u: Pair
) -> tuple[Vector, Pair, bool]:
    """Return step, force and whether p = 0, given ``z = B^-1 b`` and ``B^-1 P``."""
    one, two = kink_columns(kink)
    m = kink.mass
    q = u[0] - dot(one, z), u[1] - dot(two, z)
    r, s, t = kink.stretch
    line = abs(r * t - s * s) <= 16.0 * _EPS * (r * r + 2.0 * s * s + t * t)
    f, still = kink_force_in_plane(m * dot(one, k1), m * dot(one, k2), m * dot(two, k2), q, line)
    return along(along(scaled(-1.0, z), -m * f[0], k1), -m * f[1], k2), f, still


@compiled
def snapped(kink: Kink, v: Vector) -> Vector:
    """Return the twist about the kink nearest to v."""
    w = (v[0] * kink.y - v[1] * kink.x + v[2]) / (1.0 + kink.x * kink.x + kink.y * kink.y)
    return w * kink.y, -w * kink.x, w
