r"""A cell of contacts seen from afar: power series of its sums about its centre.

Complex notation: a contact at :math:`z = z_0 + d` moves with :math:`u = U + i w z = u_0 (1 + s)`,
where :math:`u_0 = U + i w z_0` is the velocity of the centre and :math:`s = i w d / u_0`. With
:math:`b, c, e` the binomial coefficients of the powers 1/2, -1/2, -3/2,

.. math::
    \frac{u}{|u|} = \frac{u_0}{|u_0|} \sum_{k,l} b_k c_l s^k \bar s^l, \qquad
    \frac{1}{|u|} = \frac{1}{|u_0|} \sum_{k,l} c_k c_l s^k \bar s^l, \qquad
    \frac{u^2}{|u|^3} = \frac{u_0^2}{|u_0|^3} \sum_{k,l} b_k e_l s^k \bar s^l.

Summed over the contacts the powers become moments :math:`M_{kl} = \sum m d^k \bar d^l`; as
:math:`M_{lk} = \bar M_{kl}`, those with k >= l are enough. They are stored order by order
(n = k + l).

**Tail.** With :math:`|s| \le \theta` the terms of order n of u/|u| are at most
:math:`\sum_{k+l=n} |b_k c_l| \theta^n`. The sums of moduli are the coefficients of
:math:`(2 - \sqrt{1-t}) / \sqrt{1-t} = 2 (1-t)^{-1/2} - 1`: :math:`2 |c_n|`, which fall with n. For
|u| they are those of :math:`(2 - \sqrt{1-t})^2 = 5 - t - 4\sqrt{1-t}`: :math:`4 |b_n|`. Hence the
geometric tails below.

**First moments.** With :math:`\sigma = i w / u_0`, so that :math:`s = \sigma d`, the moment of the
forces about the centre is

.. math::
    \mathrm{Im} \sum m \bar d \frac{u}{|u|} =
    \frac{|u_0|}{w} \,\mathrm{Re} \sum_{k,l} b_k c_{l-1} \sigma^k \bar\sigma^l M_{kl}.

The series starts at order 1, and so keeps its relative precision through the division by w,
however small. As :math:`b_l = c_l + c_{l-1}`, it adds up with the series of u/|u| to that of |u|.
The Hessian C of m|u| satisfies C u = 0, which gives its first and second moments from the series
of coefficients :math:`c_k c_l - b_k e_l`; it starts at order 1, its real part at order 2.
"""

from __future__ import annotations

from math import comb

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = [
    "FORCE_TAIL",
    "MAX_ORDER",
    "MONOMIALS",
    "SPEED_TAIL",
    "row_start",
    "series_powers",
    "series_sums",
]

MAX_ORDER = 24


def _binomials(power: float) -> Floats:
    """Return the coefficients of ``(1 + t)^power`` up to order MAX_ORDER + 1."""
    result = np.ones(MAX_ORDER + 2)
    for k in range(1, MAX_ORDER + 2):
        result[k] = result[k - 1] * (power - k + 1) / k
    return result


def _terms() -> list[tuple[int, int]]:
    """Return the pairs (k, l), k >= l, in the order in which their moments are stored."""
    return [(n - low, low) for n in range(MAX_ORDER + 1) for low in range(n // 2 + 1)]


def _series_table() -> Floats:
    """Return (6, T): what each series takes from Re and Im of the terms ``s^k conj(s)^l``.

    Rows: Re and Im of u/|u|, moment, 1/|u|, Re and Im of the Hessian's series. A pair stands for
    (k, l) and (l, k), whose terms are conjugate.
    """
    b, c, e = _binomials(0.5), _binomials(-0.5), _binomials(-1.5)
    before = np.concatenate([[0.0], c[:-1]])
    rows = []
    for k, low in _terms():
        here, swapped = c[k] * c[low] - b[k] * e[low], c[k] * c[low] - b[low] * e[k]
        row = [
            b[k] * c[low] + b[low] * c[k],
            b[k] * c[low] - b[low] * c[k],
            b[k] * before[low] + b[low] * before[k],
            2.0 * c[k] * c[low],
            here + swapped,
            here - swapped,
        ]
        rows.append(np.array(row) * (0.5 if k == low else 1.0))
    return np.ascontiguousarray(np.array(rows).T)


def _monomial_table() -> Floats:
    r"""Return (n, j, l): ``z^(n-l) conj(z)^l`` as a sum over j of ``x^(n-j) y^j``.

    The coefficient is :math:`i^j \sum_s (-1)^s \binom{n-l}{j-s} \binom{l}{s}`; real for even j,
    imaginary for odd j, and stored without the factor i. Rows are padded to 16 entries.
    """
    table = np.zeros((MAX_ORDER + 1, MAX_ORDER + 1, 16))
    for k, low in _terms():
        for j in range(k + low + 1):
            ways = sum((-1) ** s * comb(k, j - s) * comb(low, s) for s in range(min(j, low) + 1))
            table[k + low, j, low] = (-1) ** (j // 2) * ways
    return table


_SERIES = _series_table()
MONOMIALS = _monomial_table()
#: The tail of u/|u| after order n is at most ``FORCE_TAIL[n+1] theta^(n+1) / (1-theta)``.
FORCE_TAIL = 2.0 * np.abs(_binomials(-0.5))
#: The same for |u| / |u_0|; n >= 1.
SPEED_TAIL = 4.0 * np.abs(_binomials(0.5))


@compiled
def row_start(n: int) -> int:
    """Return the place of the first moment of order n: the number of pairs of lower order."""
    return ((n + 1) * (n + 1)) // 4


@compiled
def series_powers(re: float, im: float, order: int, powers: Floats) -> None:
    """Fill `powers` (2, T) with Re and Im of ``a^k conj(a)^l`` up to an order, a = re + im i.

    Those of order n are ``a^n`` and ``|a|^2`` times those of order n - 2.
    """
    square = re * re + im * im
    pr, pi = 1.0, 0.0
    for n in range(order + 1):
        new, old = row_start(n), row_start(n - 2)
        powers[0, new], powers[1, new] = pr, pi
        for k in range(n // 2):
            powers[0, new + 1 + k] = square * powers[0, old + k]
            powers[1, new + 1 + k] = square * powers[1, old + k]
        pr, pi = pr * re - pi * im, pr * im + pi * re


@compiled
def series_sums(
    moments: Floats, c: int, powers: Floats, order: int
) -> tuple[float, float, float, float, float, float]:
    """Return the six series of ``_series_table`` up to an order.

    Parameters
    ----------
    moments, c : (C, 2, T) float, int
        Re and Im of the moments of ``d / r``, r the radius of a cell; the cell.
    powers : (2, T) float
        From `series_powers`, of ``i w r / u_0``.
    order : int
        The last order to sum.
    """
    fr = fi = turn = inverse = hr = hi = 0.0
    for t in range(row_start(order + 1)):
        re = powers[0, t] * moments[c, 0, t] - powers[1, t] * moments[c, 1, t]
        im = powers[0, t] * moments[c, 1, t] + powers[1, t] * moments[c, 0, t]
        fr += _SERIES[0, t] * re
        fi += _SERIES[1, t] * im
        turn += _SERIES[2, t] * re
        inverse += _SERIES[3, t] * re
        hr += _SERIES[4, t] * re
        hi += _SERIES[5, t] * im
    return fr, fi, turn, inverse, hr, hi
