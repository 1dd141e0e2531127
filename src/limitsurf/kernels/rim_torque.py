r"""Electrostatic torque of one side of a tilted grid's rim, per half-square volt.

The rim on one side of the rod is an edge of length b at the lever R and two strips out to it. Its
gap at the lever x is :math:`h + x \vartheta` where :math:`\vartheta` is the tilt that raises this
side. With the pressure :math:`\varepsilon_0 V^2 / (2\,\mathrm{gap}^2)` on a strip of width
:math:`w_{eff}`, the torque that lowers the side is :math:`\tfrac12\varepsilon_0 w_{eff} V^2` times

.. math:: \frac{bR}{(h + R\vartheta)^2} + 2\int_0^R \frac{x\,dx}{(h + x\vartheta)^2}
   = \frac{R}{h^2}\Big(\frac{b}{(1+u)^2} + 2 R\, g(u)\Big), \quad u = R\vartheta/h, \quad
   g(u) = \frac{\ln(1+u) - u/(1+u)}{u^2}.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import compiled

__all__ = ["RimSide", "rim_shape", "strip_integral"]


class RimSide(NamedTuple):
    """One side of the rim: lever R of its edge, length b of the edge, gap h at rest [m]."""

    lever: float
    length: float
    gap: float


@compiled
def strip_integral(u: float) -> float:
    """Return ``g(u) = (ln(1+u) - u/(1+u)) / u^2 = int_0^1 x / (1+ux)^2 dx``, for u > -1."""
    if abs(u) < 0.05:
        total, power = 0.0, 1.0
        for n in range(12):  # the closed form would lose digits like u^2
            total += (n + 1) / (n + 2) * power
            power *= -u
        return total
    return (math.log1p(u) - u / (1.0 + u)) / (u * u)


@compiled
def rim_shape(side: RimSide, tilt: float) -> float:
    """Return the torque [1] of a side over ``eps0 w_eff V^2 / 2``; `tilt` raises the side."""
    u = side.lever * tilt / side.gap
    inner = side.length / (1.0 + u) ** 2 + 2.0 * side.lever * strip_integral(u)
    return side.lever / side.gap**2 * inner
