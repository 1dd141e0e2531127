"""The facets that hold a closest point which was found from the vertices.

Of all facets through the point, those count whose normals combine to ``p - x`` with multipliers
>= 0: the active set of the same projection onto these facets alone.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.dual_active_set import closest_by_facets, new_working_set
from limitsurf.kernels.vectors import row

__all__ = ["holding_facets"]


@compiled
def holding_facets(
    points: Floats, simplex: Ints, A: Floats, b: Floats, ptr: Ints, facets: Ints
) -> Ints:
    """Return the facets (k, 3) that hold the closest points, then -1; all -1 inside.

    Parameters
    ----------
    points : (k, 3) float
        The points that were projected.
    simplex : (k, 4) int32
        The vertices that span their closest points, then -1.
    A, b : (m, 3), (m,) float
        Facets, rows of A of length 1.
    ptr, facets : int32
        Facets through vertex i, ascending: ``facets[ptr[i]:ptr[i + 1]]``.
    """
    found = np.full((simplex.shape[0], 3), -1, np.int32)
    most = (ptr[1:] - ptr[:-1]).max()
    common = np.empty(most, np.int32)
    normals, offsets = np.empty((3, most)), np.empty(most)
    work = new_working_set()
    for k in range(simplex.shape[0]):
        count = _common(simplex[k], ptr, facets, common)
        if count <= 1:
            found[k, :count] = common[:count]
            continue
        for j in range(count):
            normals[:, j] = A[common[j]]
            offsets[j] = b[common[j]]
        _, held, _, _ = closest_by_facets(row(points, k), normals[:, :count], offsets[:count], work)
        for j in range(held):
            found[k, j] = common[work.facets[j]]
    return found


@compiled
def _common(simplex: Ints, ptr: Ints, facets: Ints, common: Ints) -> int:
    """Fill the facets through all vertices of a simplex; return their number."""
    if simplex[0] < 0:
        return 0
    count = 0
    for e in range(ptr[simplex[0]], ptr[simplex[0] + 1]):
        shared = True
        for j in range(1, 4):
            i = simplex[j]
            shared = shared and (i < 0 or _holds(facets, ptr[i], ptr[i + 1], facets[e]))
        if shared:
            common[count] = facets[e]
            count += 1
    return count


@compiled
def _holds(values: Ints, start: int, end: int, value: int) -> bool:
    for e in range(start, end):  # noqa: SIM110 - compiled
        if values[e] == value:
            return True
    return False
