r"""The median of a polygon and the energy of a squeeze field there, from integrals over its edges.

With :math:`u = (\cos\theta, \sin\theta)`, :math:`n = (-\sin\theta, \cos\theta)`,
:math:`s = u\cdot x`, :math:`t = n\cdot x` and the region kept on the left of its edges, Green's
theorem gives

.. math:: A_{left}(z) = \int_{t>z} dA = -\oint (t-z)^+ ds

and the sums of `squeeze_energy`. Holes and several pieces need nothing special. The chords of the
line enter through their end points only: an edge that crosses upwards is a right end, one that
crosses downwards a left end.
Reference: Boehringer et al. 1994, section 3 (conditions I and II); potential and
``U'' + U = 2 J`` as derived in ``docs/planning.md``.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.squeeze_energy import squeeze_energy

__all__ = ["area_left", "median_offset", "squeeze_states"]


@compiled
def area_left(edges: Floats, theta: float, z: float) -> tuple[float, float]:
    """Return the area where ``n.x > z`` and the length of the chords on the line ``n.x = z``."""
    cos, sin = np.cos(theta), np.sin(theta)
    area = 0.0
    chord = 0.0
    for i in range(edges.shape[0]):
        s0 = cos * edges[i, 0] + sin * edges[i, 1]
        s1 = cos * edges[i, 2] + sin * edges[i, 3]
        t0 = cos * edges[i, 1] - sin * edges[i, 0] - z
        t1 = cos * edges[i, 3] - sin * edges[i, 2] - z
        if t0 > 0.0 and t1 > 0.0:
            area -= 0.5 * (t0 + t1) * (s1 - s0)
        elif (t0 > 0.0) != (t1 > 0.0):
            top = max(t0, t1)
            share = top / abs(t1 - t0)
            area -= 0.5 * top * share * (s1 - s0)
            crossing = s0 + (s1 - s0) * (t0 / (t0 - t1))
            chord += crossing if t1 > t0 else -crossing
    return area, chord


@compiled
def median_offset(edges: Floats, theta: float, half_area: float) -> float:
    """Return z with ``area_left(z) = half_area``: Newton steps kept inside a bracket.

    The area is a decreasing, piecewise quadratic function of z, its slope minus the chord.
    """
    cos, sin = np.cos(theta), np.sin(theta)
    low, high = np.inf, -np.inf
    for i in range(edges.shape[0]):
        t = cos * edges[i, 1] - sin * edges[i, 0]
        low = min(low, t)
        high = max(high, t)
    z = 0.5 * (low + high)
    last = np.inf
    for _ in range(200):
        area, chord = area_left(edges, theta, z)
        excess = area - half_area
        if excess > 0.0:
            low = z
        elif excess < 0.0:
            high = z
        else:
            return z
        step = z + excess / chord if chord > 0.0 else np.inf
        # where chords appear or vanish Newton's steps may shrink the bracket too slowly
        if not low < step < high or abs(step - z) > 0.5 * last:
            step = 0.5 * (low + high)
        last = abs(step - z)
        if last <= 1e-16 * (high - low) or step in (low, high):
            return step
        if last <= 2e-16 * max(abs(z), half_area):
            return step
        z = step
    return z


@compiled
def squeeze_states(edges: Floats, theta: Floats, half_area: float) -> Floats:
    """Return rows ``(z, U, U', J, chord length, s_m)`` at the medians of directions `theta`."""
    out = np.empty((theta.shape[0], 6))
    for k in range(theta.shape[0]):
        z = median_offset(edges, theta[k], half_area)
        energy, _, slope, c0, c1, c2 = squeeze_energy(edges, 2.0 * half_area, z, theta[k])
        out[k, 0], out[k, 1], out[k, 2], out[k, 4] = z, energy, slope, c0
        out[k, 3] = c2 - c1 * c1 / c0 if c0 > 0.0 else 0.0
        out[k, 5] = c1 / c0 if c0 > 0.0 else 0.0
    return out
