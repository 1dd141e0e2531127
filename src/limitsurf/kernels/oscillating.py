r"""Mean friction of oscillating tips: potential, gradient and Hessian, piece by piece exact.

In the tip's frame the contact velocity is (p, q), q across. On a piece of the period the tip's
velocity goes linearly from one sample to the next, so the slip ``x = w - p`` goes from a to b and
the normal force from N_a to N_b. The integrals over the piece of ``N r``, ``r = sqrt(x^2 + q^2)``,
and of its derivatives have closed forms. Written out they are differences of large numbers, useless
for short pieces. With the ends of the piece as foci of elliptic coordinates they are sums of terms
of one sign:

.. math::
    S = r_a + r_b,\; t = \frac{b-a}{S},\; \sigma = \frac{a+b}{S},\; \kappa = 1 - t^2,\;
    \lambda = 1 - \sigma^2,\; A = \frac{\operatorname{artanh} t}{t},\; C = \frac{A-1}{t^2},\;
    B = 1 - \kappa C

    \int r = \frac S4 (1 + \sigma^2 + \kappa\lambda A), \quad
    \int \tau r = \frac{S t \sigma}{8} \left(\lambda B + \tfrac23 \sigma^2\right), \quad
    \int \frac1r = \frac{2A}S, \quad \int \frac xr = \sigma, \quad
    \int \frac{q^2}{r^3} = \frac{S\lambda}{2 r_a r_b}

and so on, with :math:`\tau` from -1/2 to 1/2 along the piece. ``r + x`` and ``r - x`` are found
without cancellation, and :math:`\kappa, \lambda` are products of sums of them.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["SUMS", "tip_sums"]

#: Columns of the answers: Phi, its gradient (x, y), its Hessian (xx, xy, yy).
SUMS = 6

_POLYNOMIAL_UP_TO = 0.25

Sums = tuple[float, float, float, float, float, float]


@compiled
def _excess(z: float) -> float:
    """Return C = (artanh(t)/t - 1)/t^2 at z = t^2 <= 1/4.

    Interpolated in Chebyshev nodes with 40 digits; off by at most 1e-17.
    """
    y = 0.2109809788597579688
    y = y * z - 0.1445049118341446777
    y = y * z + 0.1355790391369229839
    y = y * z + 0.01229244872854053172
    y = y * z + 0.05441915418234587182
    y = y * z + 0.05160769881147162028
    y = y * z + 0.05893099692590041597
    y = y * z + 0.06665886352701884132
    y = y * z + 0.07692345940270638333
    y = y * z + 0.09090907881509188144
    y = y * z + 0.111111111339389688
    y = y * z + 0.1428571428549010502
    y = y * z + 0.2000000000000086486
    return y * z + 0.3333333333333333278


@compiled
def _slips(w: Floats, p: float, q: float, work: Floats) -> None:
    """Fill rows ``x, r, r + x, r - x, 1/r`` of the samples, the first once more at the end."""
    K = w.shape[0]
    q2 = q * q
    for k in range(K + 1):
        x = w[k] - p if k < K else w[0] - p
        r = math.sqrt(x * x + q2)
        far = r + abs(x)
        near = q2 / far if far > 0.0 else 0.0
        work[0, k], work[1, k] = x, r
        work[2, k] = far if x > 0.0 else near
        work[3, k] = near if x > 0.0 else far
        work[4, k] = 1.0 / r if r > 0.0 else 0.0


@compiled
def _excesses(K: int, work: Floats) -> None:
    """Fill row 5 with C of every piece; at t = 1, on the piece itself, with 0."""
    for k in range(K):
        S, d = work[1, k] + work[1, k + 1], work[0, k + 1] - work[0, k]
        t = d / S if S > 0.0 else 0.0
        z = t * t
        work[6, k] = z
        work[5, k] = _excess(min(z, _POLYNOMIAL_UP_TO))
    for k in range(K):
        z = work[6, k]
        if z > _POLYNOMIAL_UP_TO:
            low, high = work[3, k + 1] + work[2, k], work[2, k + 1] + work[3, k]
            work[5, k] = 0.0
            if low > 0.0 and high > 0.0:  # 2 artanh |t| = |log((S + d)/(S - d))|
                work[5, k] = (abs(math.log(high / low)) / (2.0 * math.sqrt(z)) - 1.0) / z


@compiled
def _add_up(N: Floats, q: float, work: Floats, skip: Floats) -> Sums:
    """Return the sums over the pieces of Phi, its gradient and its Hessian, in the tip's frame."""
    K = N.shape[0]
    phi = gp = gq = hpp = hpq = hqq = 0.0
    for k in range(K):
        Na, Nb = N[k], N[k + 1] if k + 1 < K else N[0]
        on = skip[k]
        mean, rise = on * 0.5 * (Na + Nb), on * (Nb - Na)
        a, b, ra, rb = work[0, k], work[0, k + 1], work[1, k], work[1, k + 1]
        S = ra + rb
        inverse = 1.0 / S if S > 0.0 else 0.0
        t, sigma = (b - a) * inverse, (a + b) * inverse
        low, high = work[3, k + 1] + work[2, k], work[2, k + 1] + work[3, k]
        kappa = low * high * inverse * inverse
        lam = (work[3, k] + work[3, k + 1]) * (work[2, k] + work[2, k + 1]) * inverse * inverse
        C, z, s2 = work[5, k], t * t, sigma * sigma
        A, B = 1.0 + z * C, 1.0 - kappa * C
        ia, ib = work[4, k], work[4, k + 1]
        both = ia * ib
        phi += 0.25 * S * mean * (1.0 + s2 + kappa * lam * A)
        phi += 0.125 * S * rise * t * sigma * (lam * B + 2.0 / 3.0 * s2)
        gp += mean * sigma + 0.25 * rise * t * lam * B
        gq += inverse * (2.0 * mean * A - rise * sigma * t * C)
        hpp += on * 0.5 * lam * (Na * ia + Nb * ib)
        hpq += mean * sigma * both
        hpq += rise * t * inverse * (2.0 * C * inverse - 0.5 * S * s2 * both)
        hqq += mean * (2.0 * inverse * z * C + 0.5 * S * s2 * kappa * both)
        hqq += rise * sigma * t * (0.25 * lam * S * both - C * inverse)
    return phi, -gp, q * gq, hpp, q * hpq, hqq


@compiled
def _tip(w: Floats, N: Floats, p: float, q: float, width: float, work: Floats) -> Sums:
    """Return the sums, the Hessian smoothed where u is closer to the tip's line than `width`."""
    K = w.shape[0]
    _slips(w, p, q, work)
    _excesses(K, work)
    sums = _add_up(N, q, work, work[7])
    if abs(q) >= width:
        return sums
    _slips(w, p, width, work)
    _excesses(K, work)
    _, _, _, hpp, hpq, hqq = _add_up(N, width, work, work[7])
    share = q / width
    return sums[0], sums[1], sums[2], hpp, share * hpq, hqq + (1.0 - share * share) * hpp


@compiled
def _blurred_tip(w: Floats, N: Floats, p: float, q: float, blur: float, work: Floats) -> Sums:
    """Return the sums with ``sqrt(|u - w e|^2 + blur^2)`` for the distance: smooth everywhere."""
    away = math.sqrt(q * q + blur * blur)
    _slips(w, p, away, work)
    _excesses(w.shape[0], work)
    phi, gp, gq, hpp, hpq, hqq = _add_up(N, away, work, work[7])
    along, across = q / away, blur / away
    return phi, gp, along * gq, hpp, along * hpq, hqq + across * across * hpp


@compiled
def tip_sums(
    u: Floats,
    which: Ints,
    direction: Floats,
    w: Floats,
    N: Floats,
    width: float,
    blur: float,
    moving_only: bool,
    out: Floats,
) -> None:
    r"""Fill potential, gradient and Hessian of tips, each at its own contact velocity.

    .. math:: \Phi(u) = \frac1T \int_0^T N(t)\, |u - w(t) e| \,dt

    Parameters
    ----------
    u : (m, 2) float
        Contact velocities [m/s].
    which : (m,) int
        The tip of each.
    direction : (n, 2) float
        Unit vectors e.
    w, N : (n, K) float
        Tip velocities and friction radii (mu times normal force) at the samples.
    width : float
        Closer than this to the line of e the Hessian is that at this distance, its entry along
        and across falling linearly to 0 on the line, and that across rising by the share
        ``1 - (q/width)^2`` of that along: so a tip at rest gets N/width in all directions.
    blur : float
        If positive, the distance is ``sqrt(|u - w e|^2 + blur^2)`` all over, and `width` unused.
    moving_only : bool
        Leave out the pieces in which the tip rests.
    out : (m, 6) float
        The answers; see SUMS.
    """
    K = w.shape[1]
    work = np.empty((8, K + 1))
    for i in range(u.shape[0]):
        j = which[i]
        for k in range(K):
            rests = w[j, k] == 0.0 and w[j, (k + 1) % K] == 0.0
            work[7, k] = 0.0 if moving_only and rests else 1.0 / K
        ex, ey = direction[j, 0], direction[j, 1]
        p, q = u[i, 0] * ex + u[i, 1] * ey, u[i, 1] * ex - u[i, 0] * ey
        if blur > 0.0:
            phi, gp, gq, hpp, hpq, hqq = _blurred_tip(w[j], N[j], p, q, blur, work)
        else:
            phi, gp, gq, hpp, hpq, hqq = _tip(w[j], N[j], p, q, width, work)
        out[i, 0] = phi
        out[i, 1], out[i, 2] = gp * ex - gq * ey, gp * ey + gq * ex
        out[i, 3] = hpp * ex * ex - 2.0 * hpq * ex * ey + hqq * ey * ey
        out[i, 4] = (hpp - hqq) * ex * ey + hpq * (ex * ex - ey * ey)
        out[i, 5] = hpp * ey * ey + 2.0 * hpq * ex * ey + hqq * ex * ex
