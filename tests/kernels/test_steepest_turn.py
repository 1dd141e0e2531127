import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.kernels.steepest_turn import steepest_turn
from tests.planning.turn_shapes import KINDS, random_part, ring, size_and_edges


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_steepest_ratio_against_a_scan(kind):
    edges, radius = size_and_edges(random_part(kind, 2))
    steepest, where = steepest_turn(edges, radius)
    at = squeeze_states(edges, np.array([where]), 0.5)[0]
    assert abs(at[2] / at[1]) == pytest.approx(steepest, rel=1e-9, abs=1e-13)
    states = squeeze_states(edges, np.linspace(0, np.pi, 5001), 0.5)
    near = squeeze_states(edges, where + np.linspace(-1e-3, 1e-3, 2001), 0.5)
    for scan in (states, near):
        ratio = np.abs(scan[:, 2] / scan[:, 1])
        assert ratio.max() <= steepest * (1 + 1e-9) + 1e-13
    assert np.abs(near[:, 2] / near[:, 1]).max() >= steepest * (1 - 1e-6) - 1e-13


def test_a_needle_turns_steeply_in_few_directions():
    """|U'/U| = cos t |sin t| / (sin^2 t + width) or so: a peak as narrow as the needle."""
    edges, radius = size_and_edges(Part([(0, 0), (1, 0), (1, 1e-5), (0, 1e-5)]))
    steepest, _ = steepest_turn(edges, radius)
    scan = squeeze_states(edges, np.linspace(-1e-4, 1e-4, 20_001), 0.5)
    assert steepest == pytest.approx(np.abs(scan[:, 2] / scan[:, 1]).max(), rel=1e-4)


@pytest.mark.parametrize("n", [5, 16, 64, 101])
def test_regular_polygons_are_less_and_less_steep(n):
    edges, radius = size_and_edges(Part(ring(np.ones(n))))
    steepest, _ = steepest_turn(edges, radius)
    scan = squeeze_states(edges, np.linspace(0, 2 * np.pi / n, 4001), 0.5)
    assert steepest == pytest.approx(np.abs(scan[:, 2] / scan[:, 1]).max(), rel=1e-5)
