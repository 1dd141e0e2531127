r"""Power that uniform friction under a polygon takes, with gradient and Hessian in the twist.

For a twist v with rotation w about the point c, :math:`u = w\, \hat z \times (r - c)`, and

.. math:: h(v) = \int |u|\, dA = |w| \int \rho\, dA, \qquad \rho = |r - c|, \quad e = (r - c)/\rho .

The divergence theorem turns the integrals over the polygon into integrals over its edges, which
have closed forms. With d the distance of c inside an edge, s the coordinate along it, n and t its
outer normal and direction, L its length, :math:`\Sigma = \rho_0 + \rho_1`, :math:`s_m` the mean
of its ends,

.. math::
    J = \int \frac{ds}{\rho} = \log\frac{\Sigma + L}{\Sigma - L}, \qquad
    K = \int \rho\, ds = \tfrac12 \left( L \left( \frac{2 s_m^2}{\Sigma} + \frac{\Sigma}{2} \right)
        + d^2 J \right)

(sums of positive terms: no digits are lost on short or far edges), and

.. math::
    \int \rho\, dA = \sum \tfrac13 d K, \quad \int e\, dA = \sum n K, \quad
    \int \frac{1 - e e^T}{\rho} dA = \sum \Big( n\, d J + t\, \frac{2 s_m L}{\Sigma} \Big) n^T .

**Far centres.** The sums over edges cancel by the factor \|c\|/size; near translations they would
lose all digits. Where c is farther than `_FAR` radii from the centroid, the power series of
`moment_series` about it takes over, with the moments of the polygon up to order 24: its tail is
below 1e-16 there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.cell_sums import add_cell
from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.moment_series import MAX_ORDER, row_start
from limitsurf.kernels.vectors import Vector, row

__all__ = ["NOISE", "Room", "UniformPatch", "new_room", "power_many", "power_sums", "uniform_patch"]

_EPS = float(np.finfo(np.float64).eps)
_FAR = 4.0  # theta = 1/4: the tail of order 25 is 0.23 * 4^-25
_ROUNDING = 8.0 * _EPS
NOISE = 10  # place of the rounding error of h


class UniformPatch(NamedTuple):
    """A polygon about its centroid in units of its circumradius.

    Directed edges (E, 4) with the inside on their left, complex moments (1, 2, T) and the unit ball
    of a cell of `moment_series`, area and polar second moment.
    """

    edges: Floats
    moments: Floats
    ball: Floats
    area: float
    polar: float


class Room(NamedTuple):
    """Where to work: powers (2, T), and the sums (11,) that come out."""

    powers: Floats
    sums: Floats


@compiled
def new_room() -> Room:
    """Return room for the sums of one twist."""
    return Room(np.empty((2, row_start(MAX_ORDER + 1))), np.empty(11))


def uniform_patch(edges: Floats) -> UniformPatch:
    """Return the patch of a polygon's edges, given about its centroid in circumradii.

    Each edge spans a triangle with the centroid, over which a monomial of order n integrates to
    ``cross / (n + 2)`` times its mean on the edge; Gauss's rule with 13 nodes is exact for those.
    """
    nodes, weights = np.polynomial.legendre.leggauss(MAX_ORDER // 2 + 1)
    share, weight = 0.5 * (nodes + 1.0), 0.5 * weights
    z0, z1 = edges[:, 0] + 1j * edges[:, 1], edges[:, 2] + 1j * edges[:, 3]
    z = (z0[:, None] + (z1 - z0)[:, None] * share).ravel()
    spans = ((z0.conj() * z1).imag[:, None] * weight).ravel()
    moments = np.empty((1, 2, row_start(MAX_ORDER + 1)))
    powers = [np.ones_like(z)]
    for _ in range(MAX_ORDER):
        powers.append(powers[-1] * z)
    for n in range(MAX_ORDER + 1):
        for low in range(n // 2 + 1):
            value = np.sum(spans * powers[n - low] * powers[low].conj()) / (n + 2)
            moments[0, :, row_start(n) + low] = value.real, value.imag
    area, polar = float(moments[0, 0, 0]), float(moments[0, 0, row_start(2) + 1])
    return UniformPatch(np.array(edges), moments, np.array([[0.0, 0.0, 1.0]]), area, polar)


@compiled
def _near(edges: Floats, v: Vector, sums: Floats) -> tuple[float, float]:
    """Fill the sums from the edges; return rounding errors of force and moment."""
    w = v[2]
    cx, cy = -v[1] / w, v[0] / w
    area = gx = gy = sxx = sxy = syy = 0.0
    lengths = arms = 0.0
    for i in range(edges.shape[0]):
        ax, ay = edges[i, 0] - cx, edges[i, 1] - cy
        bx, by = edges[i, 2] - cx, edges[i, 3] - cy
        tx, ty = edges[i, 2] - edges[i, 0], edges[i, 3] - edges[i, 1]
        L = math.sqrt(tx * tx + ty * ty)
        tx, ty = tx / L, ty / L
        d, s0, s1 = ax * ty - ay * tx, ax * tx + ay * ty, bx * tx + by * ty
        r0, r1 = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
        total, mean = r0 + r1, 0.5 * (s0 + s1)
        gap = total - L  # without cancellation where c lies beside the edge
        if s0 < 0.0 < s1:
            gap = d * d * (1.0 / (r0 - s0) + 1.0 / (r1 + s1))
        J = math.log1p(2.0 * L / gap) if gap > 0.0 else 0.0
        K = 0.5 * (L * (2.0 * mean * mean / total + 0.5 * total) + d * d * J)
        across, along = d * J, 2.0 * mean * L / total
        area += d * K / 3.0
        gx += ty * K
        gy -= tx * K
        sxx += (ty * across + tx * along) * ty
        syy -= (ty * along - tx * across) * tx
        sxy += 0.5 * ((ty * along - tx * across) * ty - (ty * across + tx * along) * tx)
        lengths += K
        arms += abs(d) * K / 3.0
    sign, over = (1.0 if w > 0.0 else -1.0), 1.0 / abs(w)
    sums[0] = abs(w) * area
    sums[1], sums[2] = -sign * gy, sign * gx
    sums[3] = sign * (area + cx * gx + cy * gy)
    xx, xy, yy = over * syy, -over * sxy, over * sxx
    sums[4], sums[5], sums[6] = xx, xy, yy
    sums[7], sums[8] = cx * xy - cy * xx, cx * yy - cy * xy
    sums[9] = cy * cy * xx - 2.0 * cx * cy * xy + cx * cx * yy
    sums[NOISE] = _ROUNDING * abs(w) * arms
    far = math.sqrt(cx * cx + cy * cy)
    return _ROUNDING * lengths, _ROUNDING * (arms + far * lengths)


@compiled
def power_sums(patch: UniformPatch, v: Vector, room: Room) -> tuple[float, float]:
    """Fill the sums ``h, g0, g1, g2, Hxx, Hxy, Hyy, Hxw, Hyw, Hww, noise of h`` of a twist v.

    Returns
    -------
    force, moment : float
        Bounds on the rounding errors of the gradient.
    """
    sums, speed = room.sums, math.sqrt(v[0] * v[0] + v[1] * v[1])
    if abs(v[2]) * _FAR > speed:
        return _near(patch.edges, v, sums)
    sums[:] = 0.0
    if speed > 0.0:
        theta, sign = abs(v[2]) / speed, -1.0 if v[2] < 0.0 else 1.0
        add_cell(
            patch.moments, patch.ball, 0, MAX_ORDER, v[0], v[1], theta, sign, room.powers, sums
        )
        sums[NOISE] = 4.0 * _ROUNDING * sums[0]
    return 4.0 * _ROUNDING * patch.area, 4.0 * _ROUNDING * patch.area


@compiled
def power_many(patch: UniformPatch, twists: Floats, out: Floats) -> None:
    """Fill rows (k, 11) of `power_sums` for twists (k, 3)."""
    room = new_room()
    for k in range(twists.shape[0]):
        power_sums(patch, row(twists, k), room)
        out[k] = room.sums
