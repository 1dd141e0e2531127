r"""Force and moment of a squeeze field on a polygon, off its median too, from its edges.

With the part's frame, line and Green's theorem of `median`, a unit push per area towards the line
``n.x = z`` from both sides gives

.. math:: F_n = A - 2 A_{left}(z), \qquad M = U_\theta(z, \theta) = \oint |t - z|\, s\, ds

about the origin of the edges. `DensityField` integrates any density, with derivatives; this is the
squeeze alone, at a twentieth of the time.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.median import area_left

__all__ = ["squeeze_loads"]


@compiled
def _moment(edges: Floats, theta: float, z: float) -> float:
    cos, sin = np.cos(theta), np.sin(theta)
    moment = 0.0
    for i in range(edges.shape[0]):
        s0 = cos * edges[i, 0] + sin * edges[i, 1]
        s1 = cos * edges[i, 2] + sin * edges[i, 3]
        t0 = cos * edges[i, 1] - sin * edges[i, 0] - z
        t1 = cos * edges[i, 3] - sin * edges[i, 2] - z
        if (t0 > 0.0) != (t1 > 0.0):
            c = s0 + (s1 - s0) * (t0 / (t0 - t1))
            moment += abs(t0) * (c - s0) * (2 * s0 + c) / 6
            moment += abs(t1) * (s1 - c) * (2 * s1 + c) / 6
        else:
            sign = 1.0 if t0 + t1 > 0.0 else -1.0
            moment += sign * (s1 - s0) * (2 * t0 * s0 + 2 * t1 * s1 + t0 * s1 + t1 * s0) / 6
    return moment


@compiled
def squeeze_loads(edges: Floats, area: float, theta: Floats, z: Floats) -> Floats:
    """Return rows ``(F_n, M)`` for lines at angles theta and offsets z in the part's frame."""
    out = np.empty((theta.shape[0], 2))
    for k in range(theta.shape[0]):
        left, _ = area_left(edges, theta[k], z[k])
        out[k, 0] = area - 2.0 * left
        out[k, 1] = _moment(edges, theta[k], z[k])
    return out
