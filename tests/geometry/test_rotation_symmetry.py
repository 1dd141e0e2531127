import time

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from limitsurf.geometry.part import Part
from tests.planning.turn_shapes import KINDS, random_part, ring, turn_matrix


def order_by_trial(part):
    """The slow twin: turn vertices and middles of edges, look for the nearest of each."""
    x0, y0, x1, y1 = part.unit_edges.T
    points = np.concatenate([x0 + 1j * y0, 0.5 * (x0 + x1) + 0.5j * (y0 + y1)])
    tree = cKDTree(np.column_stack([points.real, points.imag]))
    for order in range(len(x0), 1, -1):
        turned = points * np.exp(2j * np.pi / order)
        distance, _ = tree.query(np.column_stack([turned.real, turned.imag]))
        if distance.max() <= 1e-9:
            return order
    return 1


def around(shape, copies):
    return shapely.union_all(
        [shapely.affinity.rotate(shape, 360 * k / copies, origin=(0, 0)) for k in range(copies)]
    )


@pytest.mark.parametrize("copies", [1, 2, 3, 4, 6, 7])
def test_pieces_and_holes_in_a_circle(copies):
    blade = shapely.Polygon([(1, -0.05), (1.4, 0.0), (1.3, 0.25)])
    part = Part(around(blade, copies))
    assert part.symmetry_order == order_by_trial(part) == copies
    disk = shapely.Polygon(ring(np.full(copies * 12, 2.0)))
    part = Part(disk.difference(around(blade, copies)))
    assert part.symmetry_order == order_by_trial(part) == copies


def test_holes_may_break_the_symmetry_of_the_outline():
    square = shapely.box(-1, -1, 1, 1)
    assert Part(square.difference(shapely.box(-0.5, -0.1, 0.5, 0.1))).symmetry_order == 2
    assert Part(square.difference(shapely.box(0.2, -0.1, 0.5, 0.1))).symmetry_order == 1


def test_vertices_on_straight_edges_do_not_matter():
    assert Part([(0, 0), (1, 0), (1, 0.3), (1, 1), (0, 1)]).symmetry_order == 4


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_random_parts(kind):
    for seed in range(5):
        part = random_part(kind, seed)
        if kind.__name__ != "blocks":  # the twin minds vertices on straight edges
            assert part.symmetry_order == order_by_trial(part)


@pytest.mark.parametrize("n", [3, 4, 12, 35])
def test_turned_and_moved(n, rng):
    for _ in range(5):
        shape = ring(np.tile([1.0, 0.7], n)) @ turn_matrix(rng.uniform(0, 7)) + rng.uniform(
            -9, 9, 2
        )
        assert Part(shape).symmetry_order == n


def test_many_corners_are_fast():
    part = Part(ring(np.ones(100_000)))
    _ = part.unit_edges
    start = time.thread_time()
    assert part.symmetry_order == 100_000
    assert time.thread_time() - start < 0.5  # 20 ms on one quiet core
