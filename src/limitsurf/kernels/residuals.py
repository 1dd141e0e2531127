r"""What is left between points and their closest points: distances, outer normals, twists."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["residuals"]


@compiled
def residuals(
    points: Floats, closest: Floats, W: Floats, inside: NDArray[np.bool_]
) -> tuple[Floats, Floats, Floats]:
    r"""Return distances, unit outer normals and twists of points p with closest points x.

    .. math:: \sqrt{e^T W e}, \quad W e / |W e|, \quad -W e, \qquad e = p - x

    Parameters
    ----------
    points, closest : (k, n) float
        The points p and x.
    W : (n, n) float
        The metric.
    inside : (k,) bool
        Points with distance 0 and neither normal nor twist.
    """
    k, n = points.shape
    distance, normal, twist = np.zeros(k), np.zeros((k, n)), np.zeros((k, n))
    for i in range(k):
        if inside[i]:
            continue
        square, length2 = 0.0, 0.0
        for a in range(n):
            pull = 0.0
            for b in range(n):
                pull += W[a, b] * (points[i, b] - closest[i, b])
            normal[i, a], twist[i, a] = pull, -pull
            square += pull * (points[i, a] - closest[i, a])
            length2 += pull * pull
        distance[i] = math.sqrt(max(square, 0.0))
        if length2 > 0.0:
            for a in range(n):
                normal[i, a] /= math.sqrt(length2)
    return distance, normal, twist
