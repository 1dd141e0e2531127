from fractions import Fraction

import numpy as np
import pytest
import shapely

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def polar_moment_by_sampling(part, n=400):
    left, bottom, right, top = part.polygon.bounds
    x, y = np.meshgrid(
        left + (right - left) * (np.arange(n) + 0.5) / n,
        bottom + (top - bottom) * (np.arange(n) + 0.5) / n,
    )
    inside = shapely.contains_xy(part.polygon, x, y)
    r2 = (x - part.centroid[0]) ** 2 + (y - part.centroid[1]) ** 2
    return r2[inside].sum() * (right - left) * (top - bottom) / n**2


def test_square():
    part = Part(SQUARE, 2.0)
    assert part.area == 1.0
    assert part.centroid == (0.5, 0.5)
    assert part.mass == 2.0
    assert part.polar_moment == pytest.approx(1 / 6)
    assert part.inertia == pytest.approx(1 / 3)
    assert part.circumradius == pytest.approx(np.sqrt(0.5))
    assert part.symmetry_order == 4


@pytest.mark.parametrize(
    "outline",
    [
        [(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (0, 4)],
        shapely.Point(1, 1).buffer(2).difference(shapely.box(0, 0, 1, 2)),
        shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0, 3, 2)]),
    ],
)
def test_moments_match_sampling(outline):
    part = Part(outline)
    assert part.polar_moment == pytest.approx(polar_moment_by_sampling(part), rel=2e-3)


@pytest.mark.parametrize("vertices", [SQUARE, SQUARE[::-1], [*SQUARE, SQUARE[0]]])
def test_direction_and_closing_of_the_ring_do_not_matter(vertices):
    part = Part(vertices)
    x0, y0, x1, y1 = part.edges.T
    assert len(part.edges) == 4
    assert 0.5 * np.sum(x0 * y1 - x1 * y0) == pytest.approx(1.0)


@pytest.mark.parametrize("scale", [1e-6, 1e5])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_size_and_place_do_not_matter(scale, shift):
    base = Part([(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (0, 4)])
    moved = Part(scale * (np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (0, 4)]) + shift))
    assert moved.unit_edges == pytest.approx(base.unit_edges, abs=1e-9 if shift else 1e-14)


def test_repeated_vertices_are_dropped():
    part = Part([(0, 0), (1, 0), (1, 0), (1, 1), (0, 1)])
    assert len(part.edges) == 4


@pytest.mark.parametrize(
    ("outline", "problem"),
    [
        ([], "empty"),
        ([(0, 0), (1, 1)], "fewer than three"),
        ([(0, 0), (1, 0), (2, 0)], "no area"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "no area|Self-intersection"),
        ([(0, 0), (2, 2), (2, 0), (0, 1)], "Self-intersection"),
        ([(0, 0), (1, np.nan), (1, 1)], "not finite"),
        ([(0, 0), (1, np.inf), (1, 1)], "not finite"),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0)], "shape"),
        ("square", "no array"),
        (np.array(SQUARE) + 1j, "no array"),
        ([(0, 0), (1, 0), (2, 0), (1, 0), (1, 1), (0, 1)], "Self-intersection"),
        ([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)], "Self-intersection"),
        ([(0, 0)] * 5, "no area"),
        (1e-170 * np.array(SQUARE), "scale the coordinates"),
        (1e170 * np.array(SQUARE), "scale the coordinates"),
        (np.array(SQUARE) + 1e17, "no area"),
        (shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(0.5, 0, 2, 1)]), "simple"),
        (shapely.LineString([(0, 0), (1, 1)]), "not a polygon"),
        (shapely.Polygon(), "empty"),
    ],
)
def test_bad_outlines(outline, problem):
    with pytest.raises(InputError, match=problem) as caught:
        Part(outline)
    assert caught.value.argument == "outline"


@pytest.mark.parametrize("density", [0.0, -1.0, np.nan, "80 g", "80 parsnip"])
def test_bad_densities(density):
    with pytest.raises(InputError, match="areal_density"):
        Part(SQUARE, density)


def test_mass_needs_a_density():
    with pytest.raises(InputError, match="areal_density"):
        _ = Part(SQUARE).mass


def test_placing_a_part():
    part = Part(SQUARE)
    placed = part.at((3.0, 4.0, np.pi / 2))
    assert shapely.centroid(placed).coords[0] == pytest.approx((3.0, 4.0))
    corner = shapely.get_coordinates(Part([(0, 0), (2, 0), (2, 1), (0, 1)]).at((0, 0, np.pi / 2)))
    assert corner.max(axis=0) == pytest.approx([0.5, 1.0])


def test_symmetry_orders():
    angles = 2 * np.pi * np.arange(7) / 7
    assert Part(np.column_stack([np.cos(angles), np.sin(angles)])).symmetry_order == 7
    assert Part([(0, 0), (2, 0), (2, 1), (0, 1)]).symmetry_order == 2
    assert Part([(0, 0), (4, 0), (0, 3)]).symmetry_order == 1
    # equal vertices, unequal edges: a square with two of four mid-edge notches filled
    assert Part([(0, 0), (1, 0), (1, 1), (0, 1.001)]).symmetry_order == 1


def test_edges_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        Part(SQUARE).edges[0, 0] = 1.0


@pytest.mark.parametrize("place", [(0.0, 0.0), (1e6, -3e5), (3.0, 1e8)])
def test_edges_are_about_the_centroid_to_their_last_digit(place, rng):
    """Against exact fractions: far from the origin the centroid itself has fewer digits."""
    angle = np.sort(rng.uniform(0.0, 2 * np.pi, 9))
    vertices = np.column_stack([np.cos(angle), 0.3 * np.sin(angle)]) + place
    points = [tuple(Fraction(float(c)) for c in vertex) for vertex in vertices]
    sums = [Fraction(0)] * 3
    for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1], strict=True):
        cross = x0 * y1 - x1 * y0
        sums = [s + cross * t for s, t in zip(sums, (1, x0 + x1, y0 + y1), strict=True)]
    exact = [
        [float(c - s / (3 * sums[0])) for c, s in zip(p, sums[1:], strict=True)] for p in points
    ]
    found = Part(vertices).edges
    assert not found.flags.writeable
    apart = np.abs(found[:, None, :2] - np.array(exact)).max(axis=2)
    assert apart.min(axis=1).max() < 1e-15
