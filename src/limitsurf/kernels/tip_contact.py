r"""Cycle averages of the contact of a sinusoidally moving tip with a part that stands still.

The tip's height is :math:`a \sin\varphi` about its mean; it touches from :math:`-\alpha` before
the peak. With :math:`\psi = \varphi - \pi/2` and the part at the height :math:`a\cos\alpha`:

Kelvin-Voigt, no tension: :math:`N/(Ka) = \cos\psi - \cos\alpha - t \sin\psi` with
:math:`t = C\omega/K`, until N = 0 at :math:`\psi = \beta`,
:math:`\beta + \epsilon = \arccos(\cos\alpha\cos\epsilon)`, :math:`\epsilon = \arctan t`.

Restitution e: :math:`N/(Ka) = \cos\psi - \cos\alpha`, times e while the tip falls, so that the
impulses of the two halves are as 1 to e.

All averages have closed forms. They are written with :math:`1 - \cos` and :math:`x - \sin x`, so
that light touches (small :math:`\alpha`) keep their digits. Own derivation; the model of the
contact is the classical one, e.g. K. L. Johnson, *Contact Mechanics*, 1985, section 11.5.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["ContactLaw", "Push", "half_angle", "release_angle", "tip_averages", "tip_cells"]


class ContactLaw(NamedTuple):
    """Stiffness K [N/m], loss ``t = C omega / K`` [1], restitution e in [0, 1]; t = 0 or e = 1."""

    stiffness: float
    loss: float
    restitution: float


class Push(NamedTuple):
    """Averages over a cycle [N] of N times 1, cos, sin, and each of these times sign(cos).

    `slope` is the derivative of the mean by the penetration [N/m].
    """

    mean: float
    cos: float
    sin: float
    signed: float
    signed_cos: float
    signed_sin: float
    slope: float


@compiled
def _x_less_sin(x: float) -> float:
    """Return ``x - sin x`` without cancellation."""
    if abs(x) > 0.7:
        return x - math.sin(x)
    square, term, total = x * x, x * x * x / 6.0, 0.0
    for n in range(9):
        total += term
        term *= -square / ((2 * n + 4) * (2 * n + 5))
    return total


@compiled
def half_angle(penetration: float, amplitude: float) -> float:
    """Return alpha in [0, pi], by which the touch leads the peak, for a penetration there."""
    share = min(max(penetration / (2.0 * amplitude), 0.0), 1.0)
    return 2.0 * math.asin(math.sqrt(share))


@compiled
def release_angle(alpha: float, loss: float) -> float:
    """Return beta, by which the release trails the peak, in a Kelvin-Voigt contact."""
    eps = math.atan(loss)
    square = math.sin(0.5 * eps) ** 2 + math.cos(eps) * math.sin(0.5 * alpha) ** 2
    return max(2.0 * math.asin(math.sqrt(min(square, 1.0))) - eps, 0.0)


@compiled
def tip_averages(law: ContactLaw, amplitude: float, penetration: float) -> Push:
    """Return the averages for a penetration [m] at the peak, at most twice the amplitude [m]."""
    if penetration <= 0.0:
        return Push(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    t, e = law.loss, law.restitution
    alpha = half_angle(penetration, amplitude)
    beta = release_angle(alpha, t)
    p, q = 2.0 * math.sin(0.5 * alpha) ** 2, 2.0 * math.sin(0.5 * beta) ** 2  # 1 - cos
    arc_a, arc_b = 0.25 * _x_less_sin(2.0 * alpha), 0.25 * _x_less_sin(2.0 * beta)
    sa, sb = math.sin(alpha), math.sin(beta)
    rise = alpha * p - _x_less_sin(alpha) + t * p
    fall = e * (beta * p - _x_less_sin(beta) - t * q)
    rise_cos = 0.5 * p * p + t * arc_a
    fall_cos = e * (-q * (p - 0.5 * q) + t * arc_b)
    rise_sin = arc_a + 0.5 * t * sa * sa
    fall_sin = e * (beta - arc_b - (1.0 - p) * sb - 0.5 * t * sb * sb)
    unit = law.stiffness * amplitude / (2.0 * math.pi)
    return Push(
        unit * (rise + fall),
        unit * (rise_cos + fall_cos),
        unit * (rise_sin + fall_sin),
        unit * (rise - fall),
        unit * (rise_cos - fall_cos),
        unit * (rise_sin - fall_sin),
        law.stiffness / (2.0 * math.pi) * (alpha + e * beta + t),
    )


@compiled
def _impulse(psi: float, p: float, t: float) -> float:
    """Integrate ``cos - cos alpha - t sin`` from the peak to psi, with p = 1 - cos alpha."""
    return psi * p - _x_less_sin(psi) - t * 2.0 * math.sin(0.5 * psi) ** 2


@compiled
def tip_cells(law: ContactLaw, amplitude: float, penetration: float, cells: int) -> Floats:
    """Return the mean of N [N] in equal cells of a cycle that starts at the tip's lowest point.

    An even number of cells has a boundary at the peak, so that the impulses of either half of the
    cycle are kept exactly; values at points would miss a share of the jump at touch.
    """
    force = np.zeros(cells)
    if penetration <= 0.0:
        return force
    alpha = half_angle(penetration, amplitude)
    beta = release_angle(alpha, law.loss)
    p, width = 2.0 * math.sin(0.5 * alpha) ** 2, 2.0 * math.pi / cells
    for i in range(cells):
        start = max((i - 0.5 * cells) * width, -alpha)
        end = min((i + 1 - 0.5 * cells) * width, beta)
        if end > start:
            share = law.restitution if 2 * i >= cells else 1.0
            gain = _impulse(end, p, law.loss) - _impulse(start, p, law.loss)
            force[i] = max(law.stiffness * amplitude * share * gain / width, 0.0)
    return force
