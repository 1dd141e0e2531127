"""The median kernel against polygons cut by shapely and integrated by hand."""

import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import area_left, median_offset, squeeze_states
from tests.reference_cases import CASES, NAMES

SHAPES = {
    "L": [(0, 0), (3, 0), (3, 1.1), (1, 1.1), (1, 4), (0, 4)],
    "triangle": [(0, 0), (4, 0), (1, 3)],
    "comb": [
        (0, 0),
        (7, 0),
        (7, 3),
        (6, 3),
        (6, 1),
        (4, 1),
        (4, 3),
        (3, 3),
        (3, 1),
        (1, 1),
        (1, 3),
        (0, 3),
    ],
}


def _parts():
    yield from (Part(vertices) for vertices in SHAPES.values())
    ring = shapely.Point(0, 0).buffer(2).difference(shapely.box(-0.5, -0.5, 1.0, 0.7))
    yield Part(ring)
    yield Part(shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0, 3, 2)]))


PARTS = list(_parts())


def cut(part, theta, z):
    """Return the pieces left and right of a line, in coordinates (s, t - z), by shapely."""
    edges = shapely.affinity.affine_transform(
        shapely.affinity.translate(part.polygon, *(-np.array(part.centroid))),
        [np.cos(theta), np.sin(theta), -np.sin(theta), np.cos(theta), 0.0, -z],
    )
    reach = 10 * part.circumradius
    return [
        shapely.intersection(edges, shapely.box(-reach, low, reach, high))
        for low, high in ((0.0, reach), (-reach, 0.0))
    ]


@pytest.mark.parametrize("part", PARTS, ids=repr)
@pytest.mark.parametrize("theta", [0.0, 0.3, 1.1, np.pi / 2, 2.9])
def test_median_energy_and_moment_match_cut_polygons(part, theta):
    z, energy, slope, _, length, _ = squeeze_states(part.edges, np.array([theta]), part.area / 2)[0]
    left, right = cut(part, theta, z)
    assert left.area == pytest.approx(right.area, rel=1e-12)
    moments = [piece.area * np.array(piece.centroid.coords[0]) for piece in (left, right)]
    assert energy == pytest.approx(moments[0][1] - moments[1][1], rel=1e-12)
    scale = part.area * part.circumradius
    assert slope == pytest.approx(moments[1][0] - moments[0][0], abs=1e-13 * scale)
    line = shapely.LineString([(-20, 0), (20, 0)])
    inside = shapely.union(left, right)
    assert length == pytest.approx(shapely.length(shapely.intersection(line, inside)), abs=1e-9)


@pytest.mark.parametrize("part", PARTS, ids=repr)
def test_derivatives_of_the_energy(part):
    """U' by differences of U, and U'' + U = 2 J by differences of U', away from vertex events."""
    theta, h = np.array([0.37, 1.234, 2.6]), 1e-5
    half = part.area / 2
    below, here, above = (squeeze_states(part.edges, theta + d, half) for d in (-h, 0.0, h))
    unit = part.area**1.5
    assert (above[:, 1] - below[:, 1]) / (2 * h) == pytest.approx(here[:, 2], abs=1e-8 * unit)
    curvature = (above[:, 2] - below[:, 2]) / (2 * h)
    assert curvature + here[:, 1] == pytest.approx(2 * here[:, 3], abs=1e-8 * unit)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_reference_samples(case):
    part = Part(case["vertices"])
    unit = case["area"] ** 0.5
    for sample in case["samples"]:
        theta = sample["theta"]
        normal = np.array([-np.sin(theta), np.cos(theta)])
        got = squeeze_states(part.unit_edges, np.array([theta]), 0.5)[0]
        offset = (sample["median_offset"] - normal @ case["centroid"]) / unit
        expected = [
            offset,
            sample["U"] / unit**3,
            sample["dU"] / unit**3,
            sample["J"] / unit**3,
            sample["chord_length"] / unit,
        ]
        assert got[:5] == pytest.approx(expected, abs=2e-14)


def test_area_left_decreases_from_the_area_to_zero():
    part = Part(SHAPES["comb"])
    areas = [area_left(part.edges, 0.7, z)[0] for z in np.linspace(-8, 8, 200)]
    assert areas[0] == pytest.approx(part.area)
    assert areas[-1] == 0.0
    assert np.all(np.diff(areas) <= 1e-12)


def test_median_of_a_tall_sliver():
    part = Part([(0, 0), (1e-6, 0), (1e-6, 1), (0, 1)])
    assert median_offset(part.edges, 0.0, part.area / 2) == pytest.approx(0.0, abs=1e-15)
