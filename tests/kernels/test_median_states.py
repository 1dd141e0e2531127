import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.kernels.median_cell import START
from limitsurf.kernels.median_states import median_states
from tests.planning.turn_shapes import KINDS, random_part, size_and_edges


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("number", [1, 2, 1000])
def test_states_are_those_of_the_sums_over_all_edges(kind, number, rng):
    for seed in range(3):
        edges, radius = size_and_edges(random_part(kind, seed))
        theta = START + np.pi * np.sort(rng.random(number))
        fast, slow = median_states(edges, radius, theta), squeeze_states(edges, theta, 0.5)
        assert np.allclose(fast[:, :3], slow[:, :3], rtol=0, atol=2e-14 * max(1, radius) ** 2)
        assert np.allclose(fast[:, 3:], slow[:, 3:], rtol=0, atol=1e-12 * max(1, radius) ** 3)


def test_equal_directions_and_none():
    edges, radius = size_and_edges(random_part(KINDS[1], 3))
    assert median_states(edges, radius, np.empty(0)).shape == (0, 6)
    theta = np.repeat([1.0, 2.0], 40)
    assert np.ptp(median_states(edges, radius, theta)[:40], axis=0).max() == 0.0


def test_many_edges_and_directions(rng):
    """The lists are in use only with more edges than are looked at one by one."""
    angle = np.sort(rng.uniform(0, 2 * np.pi, 3000))
    part = Part(np.column_stack([2 * np.cos(angle), np.sin(angle)]))
    edges, radius = size_and_edges(part)
    theta = START + np.pi * np.sort(rng.random(300))
    fast, slow = median_states(edges, radius, theta), squeeze_states(edges, theta, 0.5)
    assert np.allclose(fast, slow, rtol=0, atol=1e-13)
