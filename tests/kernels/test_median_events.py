import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import median_offset
from limitsurf.kernels.median_events import median_events
from tests.planning.turn_shapes import (
    KINDS,
    brute_force_events,
    random_part,
    ring,
    size_and_edges,
)
from tests.reference_cases import CASES, NAMES, angle_distance


@pytest.mark.parametrize("kind", [k for k in KINDS if k.__name__ not in ("sliver", "blocks")])
def test_events_against_brute_force_over_pairs_of_vertices(kind):
    for seed in range(4):
        part = random_part(kind, seed)
        theta, vertex, _ = median_events(*size_and_edges(part))
        assert len(theta) == len(vertex)
        assert angle_distance(np.mod(theta, np.pi), brute_force_events(part)) < 1e-10


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_the_median_passes_the_vertex(kind):
    edges, radius = size_and_edges(random_part(kind, 9))
    for theta, v in zip(*median_events(edges, radius)[:2], strict=True):
        height = np.cos(theta) * edges[v, 1] - np.sin(theta) * edges[v, 0]
        assert height == pytest.approx(median_offset(edges, theta, 0.5), abs=1e-12 * radius)


@pytest.mark.parametrize("n", [3, 4, 7, 12, 501])
def test_convex_polygons_have_one_event_a_vertex(n):
    _, vertex, _ = median_events(*size_and_edges(Part(ring(np.ones(n)))))
    assert sorted(vertex.tolist()) == list(range(n))


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_reference_cases(case):
    number = len(median_events(*size_and_edges(Part(case["vertices"])))[0])
    if case["name"] == "L_pivot":  # the line rests on a vertex: how often it passes is a matter
        assert abs(number - case["n_vertex_events"]) <= 2  # of rounding
    else:
        assert number == case["n_vertex_events"]
