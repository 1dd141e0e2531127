"""The diameter function, against support functions on dense grids."""

import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.planning.diameter_function import diameter_function
from limitsurf.planning.plan_lines import plan_lines
from limitsurf.planning.squeeze_function import squeeze_function
from tests.reference_cases import CASES, angle_distance


def width(part, phi):
    """The slow twin: the extent of all vertices across the jaws."""
    theta = -np.atleast_1d(phi)
    across = part.edges[:, :2] @ np.array([-np.sin(theta), np.cos(theta)])
    return np.ptp(across, axis=0)


def random_part(seed, n=12):
    return Part(
        shapely.convex_hull(shapely.MultiPoint(np.random.default_rng(seed).normal(size=(n, 2))))
    )


def reuleaux(per_arc):
    """Return a Reuleaux triangle of width 1, each arc by `per_arc` chords."""
    corners = np.exp(2j * np.pi * np.arange(3) / 3) / np.sqrt(3)
    share = np.linspace(0.0, np.pi / 3, per_arc, endpoint=False)
    arcs = [corners[k] + (corners[(k + 1) % 3] - corners[k]) * np.exp(1j * share) for k in range(3)]
    points = np.concatenate(arcs)
    return Part(np.column_stack([points.real, points.imag]))


PARTS = {case["name"]: Part(case["vertices"]) for case in CASES} | {
    f"random {seed}": random_part(seed) for seed in range(12)
}


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_width_and_its_derivatives(part):
    diameter = diameter_function(part)
    phi = np.linspace(-4.0, 7.0, 997)
    w = diameter.potential(phi)
    assert w == pytest.approx(width(part, phi), rel=1e-13)
    assert diameter.curvature(phi) == pytest.approx(-w)
    h = 1e-6
    smooth = ~np.any(np.abs(np.sin(phi[:, None] - diameter.breakpoints)) < 3 * h, axis=1)
    slope = (width(part, phi - h) - width(part, phi + h)) / (2 * h)
    assert diameter.moment(phi)[smooth] == pytest.approx(slope[smooth], abs=1e-8 * w.max())


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_equilibria_are_all_extrema_of_the_width(part):
    diameter = diameter_function(part)
    phi = np.linspace(0.0, np.pi, 40001)[:-1] + 1e-7
    w = width(part, phi)
    before, after = np.roll(w, 1), np.roll(w, -1)
    least, most = phi[(w <= before) & (w < after)], phi[(w >= before) & (w > after)]
    assert angle_distance(diameter.stable, least) < 1e-4
    assert angle_distance(diameter.unstable, most) < 1e-4
    assert np.all(diameter(diameter.stable) == 0)
    assert np.all(diameter(diameter.unstable) == 0)
    for angle in diameter.stable:  # with an edge flush
        assert np.abs(np.sin(diameter.breakpoints - angle)).min() < 1e-12
    assert diameter.moment(diameter.unstable) == pytest.approx(0.0, abs=1e-12 * w.max())


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_parts_turn_towards_the_smaller_width(part):
    diameter = diameter_function(part)
    squeeze = squeeze_function(diameter)
    for phi in np.random.default_rng(0).uniform(0.0, np.pi, 8):
        position, direction = phi, int(diameter(phi))
        while int(diameter(position)) == direction:
            position += direction * 1e-3
        assert angle_distance([position], [squeeze(phi)]) < 2e-3


def test_rectangle_of_figure_3():
    diameter = diameter_function(Part([(0, 0), (2, 0), (2, 1), (0, 1)]))
    assert diameter.stable == pytest.approx([0.0, np.pi / 2])
    assert diameter.unstable == pytest.approx([np.arctan(2.0), np.pi - np.arctan(2.0)])
    assert diameter.potential(diameter.unstable) == pytest.approx(np.sqrt(5.0))
    assert len(diameter.pieces) == 2
    plan = plan_lines(squeeze_function(diameter))
    assert len(plan.lines) == 2
    assert plan.least_margin == pytest.approx(np.pi / 4 - np.arctan(0.5))


def test_regular_polygons():
    """Width is constant up to cos(pi / 2n); odd ones have 2 n flush edges a turn."""
    for n in (3, 4, 5, 6, 7, 12):
        corners = np.exp(2j * np.pi * np.arange(n) / n)
        diameter = diameter_function(Part(np.column_stack([corners.real, corners.imag])))
        assert len(diameter.stable) == len(diameter.unstable) == (n if n % 2 else n // 2)
        assert squeeze_function(diameter).steps == 1
        assert diameter.critical_angle == pytest.approx(np.pi / (2 * n) if n % 2 else np.pi / n)
        assert diameter.symmetry_order == n


def test_constant_width_is_neutral():
    rough, fine = diameter_function(reuleaux(40)), diameter_function(reuleaux(40_000))
    assert not rough.neutral
    assert fine.neutral
    assert fine.critical_angle < 3e-5 < rough.critical_angle
    assert len(fine.stable) == len(fine.unstable) == 0
    assert np.all(fine([0.1, 2.0]) == 0)
    assert fine.potential([0.0, 0.3, 1.0]) == pytest.approx(1.0, abs=1e-9)
    assert squeeze_function(fine).steps == 0
    assert "neutral" in repr(fine)


def test_pieces_name_the_vertices_that_are_touched():
    part = PARTS["random 3"]
    diameter = diameter_function(part)
    assert [piece.right for piece in diameter.pieces[:-1]] == [
        piece.left for piece in diameter.pieces[1:]
    ]
    for left, right, upper, lower in diameter.pieces:
        for share in (0.01, 0.5, 0.99):
            theta = -(left + share * (right - left))
            n = np.array([-np.sin(theta), np.cos(theta)])
            across = part.edges[:, :2] @ n
            assert upper @ n == pytest.approx(across.max())
            assert lower @ n == pytest.approx(across.min())
        assert diameter.moment(left) == pytest.approx(diameter.moment(left + 1e-9), abs=1e-7)


def test_median_lies_halfway_between_the_jaws():
    part = PARTS["T"]
    diameter = diameter_function(part)
    for phi in (0.0, 0.4, 2.0, 5.0):
        offset, chord = diameter.median(phi)
        n = np.array([np.sin(phi), np.cos(phi)])
        across = part.edges[:, :2] @ n
        assert offset == pytest.approx((across.max() + across.min()) / 2)
        ends = shapely.get_coordinates(chord) - np.asarray(part.centroid)
        assert ends @ n == pytest.approx(offset)
        assert part.polygon.buffer(1e-9).contains(chord)


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e5, 0.0), (1.0, 1e4)])
def test_size_and_place_do_not_matter(scale, shift):
    points = np.asarray(shapely.get_coordinates(random_part(5).polygon))
    here = diameter_function(Part(points))
    there = diameter_function(Part(scale * points + shift))
    tolerance = 1e-10 if shift else 1e-13
    assert there.stable == pytest.approx(here.stable, abs=tolerance)
    assert there.unstable == pytest.approx(here.unstable, abs=tolerance)
    assert there.critical_angle == pytest.approx(here.critical_angle, abs=tolerance)


def test_hundred_thousand_vertices():
    angle = np.sort(np.random.default_rng(2).uniform(0.0, 2 * np.pi, 100_000))
    points = np.column_stack([2 * np.cos(angle), np.sin(angle)])
    diameter = diameter_function(Part(points))
    assert len(diameter.stable) == len(diameter.unstable) >= 1
    phi = np.array([0.3, 1.0, 2.0])
    assert diameter.potential(phi) == pytest.approx(width(diameter.part, phi))
