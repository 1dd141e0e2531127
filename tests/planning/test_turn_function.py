import numpy as np
import pytest
import shapely
import shapely.ops

from limitsurf.geometry.part import Part
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, NAMES, angle_distance


def polygon(n, radius=1.0):
    angles = 2 * np.pi * np.arange(n) / n
    return Part(radius * np.column_stack([np.cos(angles), np.sin(angles)]))


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_reference_cases(case):
    turn = turn_function(Part(case["vertices"]))
    assert angle_distance(turn.stable, case["stable_phi"]) < 1e-9
    assert angle_distance(turn.unstable, case["unstable_phi"]) < 1e-9
    assert turn.symmetry_order == case["symmetry_order"]
    assert not turn.neutral
    for sample in case["samples"]:
        phi = -sample["theta"]
        assert turn.potential(phi) == pytest.approx(sample["U"], rel=1e-12)
        assert turn.moment(phi) == pytest.approx(sample["dU"], abs=1e-13 * case["area"] ** 1.5)
        assert turn.curvature(phi) == pytest.approx(2 * sample["J"] - sample["U"], abs=1e-9)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_equilibria_are_all_the_sign_changes_of_a_dense_scan(case):
    """The slow twin: on a fine grid the sign of U' changes at each equilibrium, nowhere else."""
    turn = turn_function(Part(case["vertices"]))
    phi = np.linspace(0.0, np.pi, 20011, endpoint=False) + 1e-5
    signs = np.sign(turn.moment(phi))
    changes = phi[signs != np.roll(signs, 1)]
    equilibria = np.concatenate([turn.stable, turn.unstable])
    assert len(changes) == len(equilibria)
    assert angle_distance(changes, equilibria) < np.pi / 20000


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_equilibria_are_minima_and_maxima_of_the_potential(case):
    part = Part(case["vertices"])
    turn = turn_function(part)
    for angles, sign in ((turn.stable, 1.0), (turn.unstable, -1.0)):
        assert np.all(np.abs(turn.moment(angles)) <= 1e-14 * part.area**1.5)
        for step in (-1e-4, 1e-4):
            assert np.all(sign * (turn.potential(angles + step) - turn.potential(angles)) > 0)
        assert np.all(turn(angles) == 0)
        assert np.all(turn(angles + 1e-5) == -sign)
        assert np.all(turn(angles - 1e-5) == sign)


@pytest.mark.parametrize("ratio", [1.1, 1.2, 1.22])
def test_rectangle_in_closed_form(ratio):
    """Stable at tan(theta) = +-sqrt(3 b^2/a^2 - 2) for a/b < sqrt(1.5) (docs/planning.md)."""
    turn = turn_function(Part([(0, 0), (ratio, 0), (ratio, 1), (0, 1)]))
    theta = np.arctan(np.sqrt(3 / ratio**2 - 2))
    assert angle_distance(turn.stable, [theta, np.pi - theta]) < 1e-13


def test_long_rectangle_rests_along_its_axis():
    turn = turn_function(Part([(0, 0), (1.3, 0), (1.3, 1), (0, 1)]))
    assert angle_distance(turn.stable, [0.0]) < 1e-13


def test_triple_root():
    """The rectangle of ratio sqrt(1.5) has a triple root at 0."""
    turn = turn_function(Part([(0, 0), (np.sqrt(1.5), 0), (np.sqrt(1.5), 1), (0, 1)]))
    assert angle_distance(turn.stable, [0.0]) < 1e-5
    assert angle_distance(turn.unstable, [np.pi / 2]) < 1e-13


def test_ellipse_potential():
    """U = (4/3) a b sqrt(a^2 sin^2 + b^2 cos^2), here for a fine polygon."""
    a, b, n = 2.0, 1.0, 2000
    angles = 2 * np.pi * np.arange(n) / n
    part = Part(np.column_stack([a * np.cos(angles), b * np.sin(angles)]))
    turn = turn_function(part)
    theta = np.array([0.0, 0.4, 1.0, np.pi / 2])
    exact = 4 / 3 * a * b * np.hypot(a * np.sin(theta), b * np.cos(theta))
    assert turn.potential(-theta) == pytest.approx(exact, rel=1e-5)
    assert angle_distance(turn.stable, [0.0]) < 1e-9


@pytest.mark.parametrize(
    ("part", "degrees"),
    [
        (Part([(0, 0), (1, 0), (1, 1), (0, 1)]), 6.6),
        (polygon(5), 0.39),
        (Part([(0, 0), (2, 0), (2, 1), (0, 1)]), 39.0),
    ],
    ids=["square", "pentagon", "rectangle"],
)
def test_critical_angles(part, degrees):
    assert np.degrees(turn_function(part).critical_angle) == pytest.approx(degrees, rel=0.02)


def test_median_halves_the_part(paper_t):
    turn = turn_function(paper_t)
    for phi in (0.0, 0.3, 1.7, 3.0, 4.0):
        offset, chords = turn.median(phi)
        theta = -phi
        normal = np.array([-np.sin(theta), np.cos(theta)])
        points = shapely.get_coordinates(chords) - np.array(paper_t.centroid)
        assert points @ normal == pytest.approx(np.full(len(points), offset), abs=1e-12)
        halves = shapely.ops.split(paper_t.polygon, _long_line(paper_t, theta, offset))
        above = sum(
            piece.area
            for piece in halves.geoms
            if (np.array(piece.representative_point().coords[0]) - paper_t.centroid) @ normal
            > offset
        )
        assert above == pytest.approx(paper_t.area / 2, rel=1e-9)


def _long_line(part, theta, offset):
    along = np.array([np.cos(theta), np.sin(theta)])
    middle = np.array(part.centroid) + offset * np.array([-along[1], along[0]])
    return shapely.LineString([middle - 0.1 * along, middle + 0.1 * along])


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_size_and_place_do_not_matter(scale):
    shape = np.array(CASES[NAMES.index("blob_m3")]["vertices"])
    base = turn_function(Part(shape))
    other = turn_function(Part(scale * (shape + 100.0)))
    assert angle_distance(base.stable, other.stable) < 1e-9


def test_turning_the_part_shifts_the_equilibria(rng):
    shape = np.array(CASES[NAMES.index("simple_16")]["vertices"])
    base = turn_function(Part(shape))
    for angle in rng.uniform(0, np.pi, 5):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        turned = turn_function(Part(shape @ turn))
        assert angle_distance(turned.stable + angle, base.stable) < 1e-11


def test_holes_and_pieces():
    ring = shapely.Polygon(
        [(0, 0), (4, 0), (4, 2), (0, 2)], [[(1, 0.5), (3, 0.5), (3, 1.5), (1, 1.5)]]
    )
    pieces = shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(3, 0, 4.5, 1)])
    for outline in (ring, pieces):
        turn = turn_function(Part(outline))
        phi = np.linspace(0.0, np.pi, 4001, endpoint=False) + 1e-5
        signs = np.sign(turn.moment(phi))
        changes = np.count_nonzero(signs != np.roll(signs, 1))
        assert changes == len(turn.stable) + len(turn.unstable)


def test_many_sided_polygons_are_resolved_until_rounding_decides(monkeypatch):
    turn = turn_function(polygon(200))
    assert not turn.neutral
    assert len(turn.stable) == len(turn.unstable) == 100
    largest = np.abs(turn.moment(np.linspace(0, np.pi, 5000))).max() / turn.part.area**1.5
    monkeypatch.setattr("limitsurf.planning.turn_function.FLAT_MOMENT", 1.01 * largest)
    turn = turn_function(polygon(200))
    assert turn.neutral
    assert len(turn.stable) == len(turn.unstable) == 0
    assert "neutral" in repr(turn)


@pytest.mark.parametrize("seed", range(20))
def test_random_star_shapes_against_a_scan(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(5, 14))
    angles = np.sort(rng.uniform(0, 2 * np.pi, n))
    radii = rng.uniform(0.2, 1.0, n)
    points = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    if not shapely.Polygon(points).is_valid:
        pytest.fail("the seed gives an invalid polygon: choose another")
    turn = turn_function(Part(points))
    phi = np.linspace(0.0, np.pi, 20011, endpoint=False) + 1e-5
    signs = np.sign(turn.moment(phi))
    changes = phi[signs != np.roll(signs, 1)]
    assert angle_distance(changes, np.concatenate([turn.stable, turn.unstable])) < 2e-4
