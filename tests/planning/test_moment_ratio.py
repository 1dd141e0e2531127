import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.planning.moment_ratio import MomentRatio, Zones, _separated
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, NAMES


def ratio_of(name):
    return MomentRatio(turn_function(Part(CASES[NAMES.index(name)]["vertices"])))


@pytest.mark.parametrize("name", ["T", "U_sym", "blob_m3", "longplan_L5"])
@pytest.mark.parametrize(("tangent", "share"), [(0.0, 0.0), (0.0, 0.4), (0.3, 0.2), (-0.5, 0.9)])
def test_zones_are_where_the_ratio_exceeds_its_error(name, tangent, share):
    """Slow twin: the sign at each of many orientations."""
    ratio = ratio_of(name)
    phi = np.linspace(0.0, np.pi, 4001)
    top = np.abs(ratio(phi)).max()
    zones = ratio.zones(tangent * top, share * top)
    excess = ratio(phi) - tangent * top
    clear = np.abs(np.abs(excess) - share * top) > 1e-6 * top
    signs = np.where(np.abs(excess) <= share * top, 0, np.sign(excess))
    found = np.array([zones.sign(zones.cell_of(p)) for p in phi])
    assert np.array_equal(found[clear], signs[clear])
    edges = np.abs(ratio(zones.borders) - tangent * top)
    assert len(zones.borders) == 1 or np.abs(edges - share * top).max() < 1e-9 + 1e-12


@pytest.mark.parametrize("name", ["T", "blob_m3"])
def test_without_errors_the_zones_are_the_equilibria(name):
    ratio = ratio_of(name)
    zones = ratio.zones(0.0, 0.0)
    turn = ratio.turn
    for phi in turn.unstable:
        low, high = zones.source_of(phi)
        assert low <= phi <= high
        assert high - low < 1e-5
    ends = np.append(turn.unstable[1:], turn.unstable[0] + np.pi)
    for left, right in zip(turn.unstable, ends, strict=True):
        low, high = zones.rest_between(left + 1e-5, right - 1e-5)
        inside = np.mod(turn.stable - left, np.pi) + left
        assert np.abs(inside - low).min() < 1e-5
        assert high - low < 1e-5


def test_a_skew_moves_equilibria_to_where_the_ratio_is_its_tangent():
    """planning.md: a square's equilibria shift by about eps U / (2J - U)."""
    ratio = MomentRatio(turn_function(Part([(0, 0), (1, 0), (1, 1), (0, 1)])))
    eps = 1e-4
    zones = ratio.zones(np.tan(eps), 0.0)
    low, high = zones.source_of(np.pi / 2)
    turn = ratio.turn
    expected = eps * turn.potential(np.pi / 2) / turn.curvature(np.pi / 2)
    assert 0.5 * (low + high) - np.pi / 2 == pytest.approx(-expected, rel=1e-3)


def test_a_cell_that_the_grid_missed_is_put_between_opposite_signs():
    zones = _separated(np.array([0.2, 1.0]), np.array([1, -1]))
    assert zones.signs.tolist() == [0, 1, 0, -1]
    assert zones.borders.tolist() == [0.2, 0.2, 1.0, 1.0]
    assert zones.source_of(0.5) == (0.2, 0.2)
    assert zones.source_of(1.5) == (0.2 + np.pi, 0.2 + np.pi)


def test_cells_are_numbered_beyond_half_a_turn():
    zones = Zones(np.array([0.1, 0.3, 1.0, 1.2]), np.array([0, 1, 0, -1]))
    for phi in (-7.0, -0.5, 0.2, 0.29, 2.9, 3.3, 11.0):
        low, high = zones.cell(zones.cell_of(phi))
        assert low <= phi < high
