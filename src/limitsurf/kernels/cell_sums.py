r"""The eleven sums of a cell of contacts: by its series, or contact by contact.

``h, g0, g1, g2, Hxx, Hxy, Hyy, Hxw, Hyw, Hww, sum m/|u|``: the support function :math:`\sum m|u|`,
its gradient, its Hessian and the sum that scales rounding.

In complex notation a contact's Hessian with respect to its velocity is
:math:`C p = (k p - q \bar p)/2`, with :math:`k = m/|u|` and :math:`q = m u^2/|u|^3`; a unit of w
moves the contact by :math:`i z`. With :math:`z = z_0 + d` the moments are those of the sums about
the centre, and :math:`\sum m\, d \times u/|u|`, :math:`\sum C(i d)`,
:math:`\sum (i d)\cdot C(i d)`.
"""

from __future__ import annotations

import math

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.moment_series import series_powers, series_sums

__all__ = ["add_cell", "add_contacts"]

_TINY = 1e-100  # a smaller theta is replaced by it: no sum notices, and nothing is divided by 0
_SLOW = 1e-140  # contacts slower than this, beside a twist of size 1, are at rest


@compiled
def add_cell(
    moments: Floats,
    balls: Floats,
    c: int,
    order: int,
    ux: float,
    uy: float,
    theta: float,
    sign: float,
    powers: Floats,
    sums: Floats,
) -> None:
    """Add the sums of one cell by its series up to an order.

    Parameters
    ----------
    moments, balls, c : (C, 2, T) float, (C, 3) float, int
        Moments in units of the radius; centres and radii; the cell.
    order : int
        Last order of the series, at least 2.
    ux, uy : float
        Velocity of the centre.
    theta, sign : float
        ``|w| radius / |u|`` and the sign of w.
    powers : (2, T) float
        Room to work in.
    sums : (11,) float
        Added to.
    """
    x, y = balls[c, 0], balls[c, 1]
    speed = math.sqrt(ux * ux + uy * uy)
    half = 0.5 / speed
    ex, ey = 2.0 * half * ux, 2.0 * half * uy
    theta = max(theta, _TINY)
    lever = sign * balls[c, 2] / theta  # |u| / w: series of order 1 stand for first moments
    # i w radius / u = i sign theta conj(e)
    series_powers(sign * theta * ey, sign * theta * ex, order, powers)
    fr, fi, turn, inverse, hr, hi = series_sums(moments, c, powers, order)
    gx, gy = ex * fr - ey * fi, ex * fi + ey * fr
    sums[0] += speed * (fr + turn)
    sums[1] += gx
    sums[2] += gy
    sums[3] += x * gy - y * gx + lever * turn
    e2r, e2i = ex * ex - ey * ey, 2.0 * ex * ey
    qr = half * (e2r * (inverse - hr) + e2i * hi)
    qi = half * (e2i * (inverse - hr) - e2r * hi)
    k = half * inverse
    cxx, cxy, cyy = k - qr, -qi, k + qr
    px, py = -half * lever * (ex * hr - ey * hi), -half * lever * (ex * hi + ey * hr)
    wx, wy = x * cxy - y * cxx, x * cyy - y * cxy
    sums[4] += cxx
    sums[5] += cxy
    sums[6] += cyy
    sums[7] += wx + px
    sums[8] += wy + py
    sums[9] += x * (wy + 2.0 * py) - y * (wx + 2.0 * px) + half * lever * lever * hr
    sums[10] += 2.0 * k


@compiled
def add_contacts(
    x: Floats, y: Floats, m: Floats, v: Floats, blur: float, sums: Floats
) -> tuple[float, float]:
    """Add the sums of contacts one by one.

    Parameters
    ----------
    x, y, m : (n,) float
        The contacts.
    v : (3,) float
        Twist of size about 1.
    blur : float
        Twice the error that rounding may make in a velocity.
    sums : (11,) float
        Added to; contacts at rest add nothing.

    Returns
    -------
    mass, turned : float
        ``sum m``, and a bound on ``sum m |e - e'|``, the error of the directions u/|u|: two
        vectors that differ by d differ in direction by ``2 d / |u|``, and by 2 at most.
    """
    h = g0 = g1 = g2 = 0.0
    hxx = hxy = hyy = hxw = hyw = hww = 0.0
    total = mass = turned = 0.0
    v0, v1, w = v[0], v[1], v[2]
    for i in range(x.shape[0]):
        ux = v0 - w * y[i]
        uy = v1 + w * x[i]
        square = ux * ux + uy * uy
        inverse = 1.0 / math.sqrt(square) if square > _SLOW * _SLOW else 0.0
        k = m[i] * inverse
        ex, ey = ux * inverse, uy * inverse
        cxx, cxy, cyy = k * ey * ey, -k * ex * ey, k * ex * ex
        wx, wy = x[i] * cxy - y[i] * cxx, x[i] * cyy - y[i] * cxy
        mass += m[i]
        turned += m[i] * min(blur * inverse, 2.0) if inverse > 0.0 else m[i]
        h += k * square
        g0 += m[i] * ex
        g1 += m[i] * ey
        g2 += m[i] * (x[i] * ey - y[i] * ex)
        hxx += cxx
        hxy += cxy
        hyy += cyy
        hxw += wx
        hyw += wy
        hww += x[i] * wy - y[i] * wx
        total += k
    sums[0] += h
    sums[1] += g0
    sums[2] += g1
    sums[3] += g2
    sums[4] += hxx
    sums[5] += hxy
    sums[6] += hyy
    sums[7] += hxw
    sums[8] += hyw
    sums[9] += hww
    sums[10] += total
    return mass, turned
