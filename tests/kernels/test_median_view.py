"""What a cell promises of its directions, against sums over all edges."""

import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import area_left, median_offset, squeeze_states
from limitsurf.kernels.median_cell import CELLS, START, whole_turn
from limitsurf.kernels.median_view import halves, look, median_in
from tests.planning.turn_shapes import KINDS, random_part, ring, size_and_edges


def cells_below(edges, radius, levels, rng):
    """Return views of cells on random ways down the halvings, with the room for their lists."""
    kept, stack = whole_turn(edges, radius)
    cell = stack[rng.integers(CELLS)]
    for _ in range(levels):
        view = look(edges, radius, kept, cell)
        yield kept, view
        cell = halves(view)[rng.integers(2)]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_cells_promise_what_holds(kind, rng):
    edges, radius = size_and_edges(random_part(kind, 7))
    for _ in range(5):
        for kept, view in cells_below(edges, radius, 30, rng):
            theta = view.theta + view.half * np.sort(rng.uniform(-1, 1, 20))
            exact = squeeze_states(edges, theta, 0.5)
            curvature = 2 * exact[:, 3] - exact[:, 1]
            rounding = 1e-13 * radius**3
            assert np.all(curvature >= view.low - rounding)
            assert np.all(curvature <= view.high + rounding)
            lever = np.abs(exact[:, 5] - view.middle) * np.cos(view.half)
            assert np.all(lever <= view.drift + view.half * radius + 1e-10 * radius)
            near = [median_in(edges, kept, view, angle) for angle in theta]
            assert np.allclose(near, exact, rtol=0, atol=1e-12 * max(1, radius) ** 3)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_edges_not_listed_stay_on_their_side(kind, rng):
    edges, radius = size_and_edges(random_part(kind, 11))
    for kept, view in cells_below(edges, radius, 20, rng):
        listed = set(kept[view.known.first :][: view.known.number].tolist())
        others = edges[[i for i in range(len(edges)) if i not in listed]]
        for theta in view.theta + view.half * np.linspace(-1, 1, 7):
            z = median_offset(edges, theta, 0.5)
            t0 = np.cos(theta) * others[:, 1] - np.sin(theta) * others[:, 0] - z
            t1 = np.cos(theta) * others[:, 3] - np.sin(theta) * others[:, 2] - z
            assert np.all(t0 * t1 > 0)


def test_few_edges_are_left_in_narrow_cells(rng):
    n = 10_000
    edges, radius = size_and_edges(Part(ring(np.ones(n))))
    for _, view in cells_below(edges, radius, 15, rng):
        assert view.known.number <= 4 + 2 * n * view.half


def test_cells_cover_half_a_turn():
    edges, radius = size_and_edges(random_part(KINDS[0], 0))
    _, stack = whole_turn(edges, radius)
    cells = stack[::-1]
    assert cells[0].left == START
    assert cells[-1].right == pytest.approx(START + np.pi, abs=1e-15)
    assert [c.right for c in cells[:-1]] == [c.left for c in cells[1:]]


@pytest.mark.parametrize(("kind", "seed"), [(2, 3), (4, 5), (7, 2)])
def test_medians_halve_the_area_where_chords_come_and_go(kind, seed):
    """Newton's steps alone stayed far from the median for some of these directions."""
    part = random_part(KINDS[kind], seed)
    edges = part.unit_edges
    for theta in np.linspace(0, np.pi, 3001):
        assert area_left(edges, theta, median_offset(edges, theta, 0.5))[0] == pytest.approx(
            0.5, abs=1e-12
        )
