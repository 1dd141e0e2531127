"""Vertices of Minkowski sums of polytopes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.hull_polytope import hull_polytope
from limitsurf.kernels.minkowski import minkowski_sum_of_all
from limitsurf.sets.hulls import convex_hull

__all__ = ["vertex_sum"]

Array = NDArray[np.float64]


def vertex_sum(terms: Sequence[Array]) -> Array:
    """Return the vertices (k, n) of the sum of convex hulls of points, n at most 3.

    In three dimensions by the overlay of the normal fans, in time of the sum's size (Lemma 10).
    """
    if terms[0].shape[1] == 3:
        return minkowski_sum_of_all([hull_polytope(points) for points in terms]).vertices
    return reduce(_sum_of_two, terms)


def _sum_of_two(a: Array, b: Array) -> Array:
    points = (a[:, None] + b[None]).reshape(-1, a.shape[1])
    vertices: Array = points[convex_hull(points).vertices]
    return vertices
