r"""What is left between points and their closest points: distances and outer normals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["residuals"]


@compiled
def residuals(
    points: Floats, closest: Floats, W: Floats, inside: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    r"""Return the distances and unit outer normals of points p with closest points x.

    .. math:: \sqrt{e^T W e}, \quad W e / |W e|, \qquad e = p - x

    Parameters
    ----------
    points, closest : (k, n) float
        The points p and x.
    W : (n, n) float
        The metric.
    inside : (k,) bool
        Points with distance 0 and no normal.
    """
    k, n = points.shape
    distance, normal = np.zeros(k), np.zeros((k, n))
    for i in range(k):
        if inside[i]:
            continue
        square, length2 = 0.0, 0.0
        for a in range(n):
            for b in range(n):
                normal[i, a] += W[a, b] * (points[i, b] - closest[i, b])
            square += normal[i, a] * (points[i, a] - closest[i, a])
            length2 += normal[i, a] * normal[i, a]
        distance[i] = math.sqrt(max(square, 0.0))
        if length2 > 0.0:
            for a in range(n):
                normal[i, a] /= math.sqrt(length2)
    return distance, normal
