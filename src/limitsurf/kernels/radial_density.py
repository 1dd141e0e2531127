r"""Load of a unit push towards a point on a polygon, its derivatives and its potential.

With c the centre seen from the centroid, :math:`\rho = |r - c|` and :math:`e = (r - c)/\rho`,
everything follows from :math:`\Phi(c) = \int \rho\, dA` and its derivatives
:math:`-E = -\int e\, dA` and :math:`S = \int (1 - e e^T)/\rho\, dA`, in closed form in
`uniform_friction`. A turn of the part turns c about the centroid; with :math:`q = \hat z \times c`

.. math::
    F = -E, \qquad M = -c \times E, \qquad
    F_s = -S, \qquad F_\theta = M_s = -(\hat z \times E + S q), \qquad
    M_\theta = -(c \cdot E + q^T S q) .

**Far centres.** These sums cancel by the factor \|c\|. With complex r and c,
:math:`\rho = |c|\, |1 - r/c|`, hence in polar coordinates of the centre, :math:`c = R e^{i\alpha}`,

.. math::
    \Phi = \sum_{k,l} \beta_k \beta_l\, R^{1-k-l}\, e^{-i(k-l)\alpha} \int r^k \bar r^l\, dA ,
    \qquad (1 - t)^{1/2} = \sum \beta_k t^k ,

whose derivatives in R and alpha are taken term by term, so that the moment :math:`\Phi_\alpha`
keeps its relative precision. Farther than four circumradii order 24 leaves less than rounding.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.density import JACOBIAN, LOAD, POTENTIAL
from limitsurf.kernels.moment_series import MAX_ORDER, row_start, series_powers
from limitsurf.kernels.uniform_friction import Room, UniformPatch, new_room, power_sums

__all__ = ["radial_states"]

_FAR = 4.0  # circumradii; where `power_sums` changes to its series, too


def _terms() -> tuple[Floats, Floats, Floats]:
    """Return coefficients, orders k + l, and k - l, in the order in which moments are stored.

    A pair k > l stands for (l, k) as well, whose term is conjugate.
    """
    beta = np.ones(MAX_ORDER + 1)
    for k in range(1, MAX_ORDER + 1):
        beta[k] = beta[k - 1] * (k - 1.5) / k
    pairs = [(n - low, low) for n in range(MAX_ORDER + 1) for low in range(n // 2 + 1)]
    weights = [beta[k] * beta[low] * (1.0 if k == low else 2.0) for k, low in pairs]
    table = np.array([(w, k + low, k - low) for w, (k, low) in zip(weights, pairs, strict=True)])
    return table[:, 0].copy(), table[:, 1].copy(), table[:, 2].copy()


_WEIGHT, _ORDER, _WINDING = _terms()


@compiled
def _polar(
    moments: Floats, cx: float, cy: float, powers: Floats
) -> tuple[float, float, float, float, float, float]:
    """Return Phi and its derivatives ``R, alpha, RR, R alpha, alpha alpha`` at a far centre."""
    square = cx * cx + cy * cy
    R = math.sqrt(square)
    series_powers(cx / square, -cy / square, MAX_ORDER, powers)
    phi = r = a = rr = ra = aa = 0.0
    for t in range(row_start(MAX_ORDER + 1)):
        w, n, m = _WEIGHT[t], _ORDER[t], _WINDING[t]
        re = w * (powers[0, t] * moments[0, 0, t] - powers[1, t] * moments[0, 1, t])
        im = w * (powers[0, t] * moments[0, 1, t] + powers[1, t] * moments[0, 0, t])
        phi += re
        r += (1.0 - n) * re
        a += m * im
        rr -= (1.0 - n) * n * re
        ra += (1.0 - n) * m * im
        aa -= m * m * re
    return R * phi, r, R * a, rr / R, ra, R * aa


@compiled
def _fill(
    F: tuple[float, float, float],
    potential: float,
    S: tuple[float, float, float],
    T: tuple[float, float, float],
    out: Floats,
) -> None:
    """Fill a state with load, potential and the symmetric Jacobian ``[[-S, T], [T', T2]]``."""
    out[LOAD], out[LOAD + 1], out[LOAD + 2] = F
    out[POTENTIAL] = potential
    J = out[JACOBIAN:].reshape(3, 3)
    J[0, 0], J[0, 1], J[1, 1] = -S[0], -S[1], -S[2]
    J[0, 2], J[1, 2], J[2, 2] = T
    J[1, 0], J[2, 0], J[2, 1] = J[0, 1], J[0, 2], J[1, 2]


@compiled
def _near_state(
    patch: UniformPatch, dx: float, dy: float, theta: float, room: Room, out: Floats
) -> None:
    """Fill the state of a part whose centre of the field lies at (dx, dy), world axes."""
    cos, sin = math.cos(theta), math.sin(theta)
    power_sums(patch, (sin * -dx + cos * dy, -(cos * dx + sin * dy), 1.0), room)
    sums = room.sums
    ex, ey = cos * sums[2] + sin * sums[1], sin * sums[2] - cos * sums[1]
    xx, xy, yy = sums[6], -sums[5], sums[4]
    double, single = 2.0 * cos * sin * xy, cos * sin * (xx - yy) + (cos * cos - sin * sin) * xy
    sxx = cos * cos * xx - double + sin * sin * yy
    syy = sin * sin * xx + double + cos * cos * yy
    qx, qy = -dy, dx
    tx, ty = sxx * qx + single * qy, single * qx + syy * qy
    turned = -(dx * ex + dy * ey + qx * tx + qy * ty)
    S, T = (sxx, single, syy), (ey - tx, -ex - ty, turned)
    _fill((-ex, -ey, dy * ex - dx * ey), sums[0], S, T, out)


@compiled
def _far_state(
    patch: UniformPatch, dx: float, dy: float, theta: float, room: Room, out: Floats
) -> None:
    """Fill the same from the series about the centroid."""
    cos, sin = math.cos(theta), math.sin(theta)
    phi, r, a, rr, ra, aa = _polar(
        patch.moments, cos * dx + sin * dy, cos * dy - sin * dx, room.powers
    )
    R = math.sqrt(dx * dx + dy * dy)
    x, y = dx / R, dy / R
    across, mixed, along = r / R + aa / (R * R), ra / R - a / (R * R), rr
    sxx = along * x * x - 2.0 * mixed * x * y + across * y * y
    sxy = (along - across) * x * y + mixed * (x * x - y * y)
    syy = along * y * y + 2.0 * mixed * x * y + across * x * x
    F = (r * x - a / R * y, r * y + a / R * x, a)
    T = (-(ra * x - aa / R * y), -(ra * y + aa / R * x), -aa)
    _fill(F, phi, (sxx, sxy, syy), T, out)


@compiled
def radial_states(
    patch: UniformPatch,
    radius: float,
    center: tuple[float, float],
    density: float,
    poses: Floats,
    out: Floats,
) -> None:
    """Fill states (k, 13) as `density_states` does: load, potential, Jacobian by rows.

    Parameters
    ----------
    patch, radius : UniformPatch, float
        The part in circumradii, and its circumradius [m].
    center, density : (2,) and float
        Where everything is pushed [m], and how much [N/m^2].
    poses : (k, 3) float
        Poses [m, m, rad].
    """
    room = new_room()
    square = density * radius * radius
    cube, line = square * radius, density * radius
    for i in range(poses.shape[0]):
        dx, dy = (center[0] - poses[i, 0]) / radius, (center[1] - poses[i, 1]) / radius
        if dx * dx + dy * dy < _FAR * _FAR:
            _near_state(patch, dx, dy, poses[i, 2], room, out[i])
        else:
            _far_state(patch, dx, dy, poses[i, 2], room, out[i])
        out[i, LOAD : LOAD + 2] *= square
        out[i, LOAD + 2 : JACOBIAN] *= cube
        J = out[i, JACOBIAN:].reshape(3, 3)
        J[:2, :2] *= line
        J[:2, 2] *= square
        J[2, :2] *= square
        J[2, 2] *= cube
