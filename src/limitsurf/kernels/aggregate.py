"""A few contacts that stand for many: each at the centroid of a cell, with all its friction.

By Jensen's inequality ``m |u(centroid)| <= sum m_i |u_i|``: the sum over the few lies in the sum
over all. So what the few hold is held, and otherwise their twist is a good start.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["aggregate"]


@compiled
def aggregate(x: Floats, y: Floats, m: Floats, side: int) -> tuple[Floats, Floats, Floats]:
    """Return ``(x, y, m)`` of at most side x side contacts, on a square grid over all."""
    left, right, low, high = x.min(), x.max(), y.min(), y.max()
    pitch = max(right - left, high - low, 1e-300) / side * (1.0 + 1e-12)
    sums = np.zeros((side * side, 3))
    for i in range(x.shape[0]):
        cell = int((x[i] - left) / pitch) * side + int((y[i] - low) / pitch)
        sums[cell, 0] += m[i]
        sums[cell, 1] += m[i] * (x[i] - left)
        sums[cell, 2] += m[i] * (y[i] - low)
    kept = 0
    for cell in range(side * side):
        if sums[cell, 0] > 0.0:
            sums[kept] = sums[cell]
            kept += 1
    total = sums[:kept, 0].copy()
    return left + sums[:kept, 1] / total, low + sums[:kept, 2] / total, total
