import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.kernels.median_cell import START
from limitsurf.kernels.turn_roots import CLEAR, FLAT, ROOT, slope_signs
from tests.planning.turn_shapes import KINDS, random_part, ring, size_and_edges

ROUNDING = 2e-15


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_cells_say_what_the_sums_over_all_edges_say(kind, rng):
    edges, radius = size_and_edges(random_part(kind, 5))
    cells, looked = slope_signs(edges, radius, ROUNDING * max(1.0, radius))
    assert looked >= len(cells) or looked == 16
    assert cells[0, 0] == START
    assert cells[-1, 1] == pytest.approx(START + np.pi, abs=1e-14)
    assert np.all(cells[1:, 0] == cells[:-1, 1])
    for left, right, kind_, sign, root, _ in cells:
        theta = np.linspace(left, right, 30)
        if kind_ == ROOT:
            assert left < root < right
            theta = theta[np.abs(theta - root) > 1e-12]
        slope = squeeze_states(edges, theta, 0.5)[:, 2]
        slope[np.abs(slope) < 1e-13 * max(1.0, radius)] = 0.0
        if kind_ == CLEAR:
            assert np.all(slope * sign >= 0)
        if kind_ == ROOT:
            assert np.all(slope * sign * np.sign(theta - root) >= 0)


def test_a_disk_of_many_sides_takes_no_longer_than_others():
    edges, radius = size_and_edges(Part(ring(np.ones(40_000))))
    assert slope_signs(edges, radius, ROUNDING)[1] < 30 * 40_000


def test_cells_in_which_the_slope_is_rounding_are_flat():
    edges, radius = size_and_edges(Part(ring(np.ones(64))))
    cells, looked = slope_signs(edges, radius, 1e-3)
    assert np.all(cells[:, 2] == FLAT)
    assert looked < 5000
