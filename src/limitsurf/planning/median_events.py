"""Directions at which the median of a polygon passes through a vertex.

Between two such events the median crosses the same edges, and the squeeze energy is analytic in
the direction. Candidates come from a coarse grid: the offset of the median and the offset of a
vertex change with the direction by at most the part's diameter per radian.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from limitsurf.kernels.median import left_areas, squeeze_states
from limitsurf.planning.analytic_roots import analytic_roots

__all__ = ["median_events"]

Array = NDArray[np.float64]

_SAME = 1e-12  # rad; one event found from both sides of a border of two cells


def median_events(edges: Array, half_area: float) -> Array:
    """Return the sorted directions in [0, pi) at which the median meets a vertex.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges, area 1, centroid at the origin.
    half_area : float
        Half the area.

    Notes
    -----
    Where the median pivots about a reflex vertex for a whole interval, the ends of the interval
    (and perhaps points inside it) are returned: additional events are harmless.
    """
    vertices = np.unique(edges[:, :2], axis=0)
    diameter = float(pdist(vertices).max())
    cells = max(64, 4 * len(vertices))
    borders = np.linspace(0.0, np.pi, cells + 1)
    middles = 0.5 * (borders[1:] + borders[:-1])
    offsets = squeeze_states(edges, middles, half_area)[:, 0]
    reach = diameter * (0.5 * np.pi / cells) * (1 + 1e-9)
    events = [
        event
        for cell, (theta, offset) in enumerate(zip(middles, offsets, strict=True))
        for i in np.flatnonzero(np.abs(vertices @ _normal(theta) - offset) <= reach)
        for event in _events_of_vertex(edges, half_area, vertices, int(i), borders[cell : cell + 2])
    ]
    found = np.sort(np.mod(np.asarray(events), np.pi))
    return found[np.diff(found, prepend=found[-1] - np.pi) > _SAME]


def _normal(theta: float) -> Array:
    return np.array([-np.sin(theta), np.cos(theta)])


def _events_of_vertex(
    edges: Array, half_area: float, vertices: Array, i: int, cell: Array
) -> list[float]:
    """Return the roots, in one cell of directions, of the area left of the line through vertex i.

    The area is analytic between the directions towards other vertices.
    """
    towards = np.delete(vertices, i, axis=0) - vertices[i]
    critical = np.mod(np.arctan2(towards[:, 1], towards[:, 0]), np.pi)
    inside = critical[(critical > cell[0]) & (critical < cell[1])]
    knots = np.concatenate([cell[:1], np.sort(inside), cell[1:]])
    px, py = vertices[i]

    def excess(theta: Array) -> Array:
        area: Array = left_areas(edges, theta, px, py) - half_area
        return area

    return [
        root for a, b in itertools.pairwise(knots) if b > a for root in analytic_roots(excess, a, b)
    ]
