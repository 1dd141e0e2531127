"""Facets that hold a point found from the vertices: those the dual active set names."""

import numpy as np
import pytest
from scipy.optimize import nnls

from limitsurf.kernels.dual_active_set import closest_on_facets
from limitsurf.kernels.holding_facets import holding_facets

CUBE_A, CUBE_B = np.vstack([np.eye(3), -np.eye(3)]), np.ones(6)
CORNERS = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0]])
AROUND = np.array([0, 3, 6], np.int32), np.array([0, 1, 2, 0, 1, 5], np.int32)


def test_corner_edge_and_inside_of_a_cube():
    points = np.array([[2.0, 3.0, 4.0], [2.0, 3.0, 0.5], [0.0, 0.0, 0.0], [2.0, 1.0, 2.0]])
    simplex = np.array([[0, -1, -1, -1], [0, 1, -1, -1], [-1] * 4, [0, -1, -1, -1]], np.int32)
    found = holding_facets(points, simplex, CUBE_A, CUBE_B, *AROUND)
    assert [sorted(row) for row in found.tolist()] == [
        [0, 1, 2],
        [-1, 0, 1],
        [-1, -1, -1],
        [-1, 0, 2],
    ]


def test_of_many_facets_through_an_apex_those_that_carry_the_residual(rng):
    """A pyramid with twenty sides: three at most carry p - x, and they span it."""
    angle = 2 * np.pi * np.arange(20) / 20
    A = np.column_stack([np.cos(angle), np.sin(angle), np.ones(20)]) / np.sqrt(2)
    b = np.zeros(20)
    around = np.array([0, 20], np.int32), np.arange(20, dtype=np.int32)
    points = rng.normal(size=(50, 3)) * 0.3 + [0, 0, 2]
    points = points[np.hypot(points[:, 0], points[:, 1]) < points[:, 2] * 0.9]
    apex = np.tile(np.array([[0, -1, -1, -1]], np.int32), (len(points), 1))
    found = holding_facets(points, apex, A, b, *around)
    assert np.all(found[:, 0] >= 0)
    for p, facets in zip(points, found, strict=True):
        weights, rest = nnls(A[facets[facets >= 0]].T, p)
        assert rest <= 1e-12
        assert np.all(weights >= 0)
    x = closest_on_facets(points, A, b)[0]
    assert x == pytest.approx(np.zeros_like(x), abs=1e-13)
