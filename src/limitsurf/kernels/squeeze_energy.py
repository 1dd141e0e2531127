r"""Energy of a polygon in a squeeze field at any line, with its derivatives, by sums over edges.

With s and t the coordinates along the line and across it, :math:`t > z` on its left,

.. math::
    U   &= \int |t-z|\, dA = -\tfrac12 \oint (t-z)|t-z|\, ds \\
    U_z &= A_{right} - A_{left} = \oint |t-z|\, ds, \qquad
    U_\theta = \oint |t-z|\, s\, ds \\
    U_{zz} &= 2 c_0, \quad U_{z\theta} = 2 c_1, \quad
    U_{\theta\theta} = 2 c_2 - U + z U_z, \qquad c_k = \int_{chords} s^k\, ds .

The region lies on the left of its edges and its centroid at the origin. Second derivatives jump
where an edge lies on the line. Derivation: ``docs/planning.md``.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["Energy", "squeeze_energy", "squeeze_loads"]

#: U, U_z, U_theta, c_0, c_1, c_2.
Energy = tuple[float, float, float, float, float, float]


@compiled
def squeeze_energy(edges: Floats, area: float, z: float, theta: float) -> Energy:
    """Return ``(U, U_z, U_theta, c_0, c_1, c_2)``; exact where the line misses the polygon."""
    cos, sin = np.cos(theta), np.sin(theta)
    U, force, moment = 0.0, 0.0, 0.0
    c0, c1, c2 = 0.0, 0.0, 0.0
    left, right = False, False
    for i in range(edges.shape[0]):
        s0 = cos * edges[i, 0] + sin * edges[i, 1]
        s1 = cos * edges[i, 2] + sin * edges[i, 3]
        t0 = cos * edges[i, 1] - sin * edges[i, 0] - z
        t1 = cos * edges[i, 3] - sin * edges[i, 2] - z
        left |= t0 > 0.0
        right |= t0 < 0.0
        if (t0 > 0.0) != (t1 > 0.0):
            x = s0 + (s1 - s0) * (t0 / (t0 - t1))
            sign = 1.0 if t1 > t0 else -1.0
            c0 += sign * x
            c1 += sign * x * x / 2
            c2 += sign * x * x * x / 3
            first, second = abs(t0) * (x - s0), abs(t1) * (s1 - x)
            U -= (t0 * first + t1 * second) / 6
            force += (first + second) / 2
            moment += (first * (2 * s0 + x) + second * (2 * s1 + x)) / 6
        else:
            run = s1 - s0 if t0 + t1 > 0.0 else s0 - s1
            U -= run * (t0 * t0 + t0 * t1 + t1 * t1) / 6
            force += run * (t0 + t1) / 2
            moment += run * (t0 * (2 * s0 + s1) + t1 * (2 * s1 + s0)) / 6
    if left and right:
        return U, force, moment, c0, c1, c2
    return area * abs(z), -area if left else area, 0.0, 0.0, 0.0, 0.0


@compiled
def squeeze_loads(edges: Floats, area: float, theta: Floats, z: Floats) -> Floats:
    """Return rows ``(U_z, U_theta)``: force along n and moment on the part, for unit push."""
    out = np.empty((theta.shape[0], 2))
    for k in range(theta.shape[0]):
        _, out[k, 0], out[k, 1], _, _, _ = squeeze_energy(edges, area, z[k], theta[k])
    return out
