import mpmath as mp
import numpy as np
import pytest
import shapely
import shapely.affinity
import shapely.ops

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.planning.turn_function import turn_function
from tests.planning.turn_shapes import (
    KINDS,
    convex,
    random_part,
    ring,
    scan_signs,
    size_and_edges,
    turn_matrix,
    zindler,
)
from tests.reference_cases import CASES, NAMES, angle_distance


def polygon(n, radius=1.0):
    return Part(radius * ring(np.ones(n)))


def assert_equilibria_are_the_sign_changes_of_a_scan(turn):
    """The slow twin: between clear signs of U' on a fine grid, the parity of roots must be right.

    More roots than one between two directions of the grid must be there if the sign says so.
    """
    theta, signs = scan_signs(turn.part)
    roots = np.concatenate([turn.stable, turn.unstable])
    at = np.searchsorted(theta, 0.123 + np.mod(-roots - 0.123, np.pi)) % len(theta)
    odd = np.bincount(at, minlength=len(theta)) % 2 == 1
    before = np.roll(signs, 1)
    clear = (signs != 0) & (before != 0)
    assert np.all(odd[clear] == (signs != before)[clear])


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_reference_cases(case):
    turn = turn_function(Part(case["vertices"]))
    assert angle_distance(turn.stable, case["stable_phi"]) < 1e-12
    assert angle_distance(turn.unstable, case["unstable_phi"]) < 1e-12
    assert turn.certificate.complete
    assert turn.certificate.residual <= 5e-16
    assert turn.symmetry_order == case["symmetry_order"]
    assert not turn.neutral
    for sample in case["samples"]:
        phi = -sample["theta"]
        assert turn.potential(phi) == pytest.approx(sample["U"], rel=1e-12)
        assert turn.moment(phi) == pytest.approx(sample["dU"], abs=1e-13 * case["area"] ** 1.5)
        curvature = 2 * sample["J"] - sample["U"]
        assert turn.curvature(phi) == pytest.approx(curvature, abs=1e-12 * case["area"] ** 1.5)


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


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_random_parts_against_a_scan(kind):
    for seed in range(12):
        turn = turn_function(random_part(kind, seed))
        assert_equilibria_are_the_sign_changes_of_a_scan(turn)
        assert turn.certificate.complete or turn.certificate.widest < 1e-4  # a triple root
        order = np.argsort(np.concatenate([turn.stable, turn.unstable]))
        kinds = np.concatenate([np.ones(len(turn.stable)), -np.ones(len(turn.unstable))])[order]
        assert np.all(kinds * np.roll(kinds, 1) < 0)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_many_random_parts_against_a_scan(kind):
    for seed in range(100, 300):
        turn = turn_function(random_part(kind, seed))
        assert_equilibria_are_the_sign_changes_of_a_scan(turn)
        assert turn.certificate.complete or turn.certificate.widest < 1e-4


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_residuals_are_rounding(kind):
    """U' at an equilibrium: 1e-14 area^1.5, or U'' times the rounding of an angle, for needles."""
    for seed in range(12):
        part = random_part(kind, seed)
        turn = turn_function(part)
        found = np.concatenate([turn.stable, turn.unstable])
        steep = np.abs(turn.curvature(found)).max(initial=0.0) / part.area**1.5
        radius = size_and_edges(part)[1]
        assert turn.certificate.residual <= 1e-14 + 1e-15 * (steep + radius)


@pytest.mark.parametrize("n", range(3, 61))
def test_regular_polygons_in_closed_form(n):
    """Medians of symmetry: through a corner and, for even n, through the middles of sides."""
    turn = turn_function(polygon(n))
    number = n if n % 2 else n // 2
    assert len(turn.stable) == len(turn.unstable) == number
    grid = np.pi / number * np.arange(number)
    for angles in (turn.stable, turn.unstable):
        offsets = np.mod(angles - angles[0], np.pi / number)
        assert np.minimum(offsets, np.pi / number - offsets).max() < 1e-9
    both = np.concatenate([turn.stable, turn.unstable])
    assert angle_distance(both, np.concatenate([grid, grid + np.pi / (2 * number)])) < 1e-9
    assert turn.certificate.complete
    assert turn.symmetry_order == n


@pytest.mark.parametrize("points", [3, 5, 6, 11, 40])
def test_stars(points):
    turn = turn_function(Part(ring(np.tile([1.0, 0.45], points))))
    assert_equilibria_are_the_sign_changes_of_a_scan(turn)
    assert turn.certificate.complete
    assert len(turn.stable) % (points if points % 2 else points // 2) == 0


@pytest.mark.parametrize(
    "part",
    [polygon(64), polygon(101), polygon(2000), Part(zindler(400)), Part(zindler(3000))],
    ids=["64-gon", "101-gon", "2000-gon", "zindler-400", "zindler-3000"],
)
def test_disks_and_zindler_curves_are_neutral(part):
    turn = turn_function(part)
    assert turn.neutral
    assert turn.critical_angle < 3e-5
    assert "neutral" in repr(turn)
    assert len(turn.stable) == len(turn.unstable) > 0  # what is left is exact
    gap = np.diff(np.sort(np.concatenate([turn.stable, turn.unstable]))).min()
    assert np.all(turn(turn.stable + 0.2 * gap) == -1)
    assert np.all(turn(turn.stable - 0.2 * gap) == 1)


def test_a_disk_of_very_many_sides_has_no_equilibria_but_rounding():
    turn = turn_function(polygon(100_000))
    assert turn.neutral
    assert len(turn.stable) == len(turn.unstable) == 0
    assert turn.certificate.unresolved == 1


@pytest.mark.parametrize("n", [5, 16, 49])
def test_neutral_is_a_matter_of_the_angle_asked_for(n):
    turn = turn_function(polygon(n))
    assert turn.neutral == (turn.critical_angle < 3e-5)
    assert turn_function(polygon(n), neutral_angle=0.1).neutral
    assert not turn_function(polygon(n), neutral_angle=0.0).neutral


@pytest.mark.parametrize("angle", [-1e-3, np.nan, np.inf])
def test_bad_neutral_angles(angle, paper_t):
    with pytest.raises(InputError, match="neutral_angle"):
        turn_function(paper_t, neutral_angle=angle)


def test_a_moment_that_is_rounding_has_no_equilibria(monkeypatch):
    monkeypatch.setattr("limitsurf.planning.turn_function.FLAT_MOMENT", 1e-3)
    turn = turn_function(polygon(200))
    assert turn.neutral
    assert len(turn.stable) == len(turn.unstable) == 0
    assert np.all(turn(np.linspace(0, 3, 50)) == 0)
    assert not turn.certificate.complete
    assert turn.certificate.widest == pytest.approx(np.pi)


def test_bad_orientations(paper_t):
    turn = turn_function(paper_t)
    with pytest.raises(InputError, match="phi"):
        turn.moment([0.0, np.nan])


def test_shapes_of_answers(paper_t):
    turn = turn_function(paper_t)
    for query in (turn, turn.potential, turn.moment, turn.curvature):
        assert np.shape(query(0.3)) == ()
        assert query(np.zeros((2, 3))).shape == (2, 3)
        assert query([]).shape == (0,)
        assert np.allclose(query([0.3, 0.3 + np.pi, 0.3 - 7 * np.pi]), query(0.3), rtol=1e-12)


@pytest.mark.parametrize("name", ["T", "blob_m3", "longplan_L5", "simple_16"])
def test_far_from_the_origin(name):
    shape = np.array(CASES[NAMES.index(name)]["vertices"])
    size = np.ptp(shape)
    base = turn_function(Part(shape))
    for scale in (1e-6, 1.0, 1e5):
        far = turn_function(Part(scale * (shape + 1e5 * size * np.array([0.6, -0.8]))))
        # coordinates are rounded to 1e-16 of 1e5 sizes
        assert angle_distance(base.stable, far.stable) < 1e-8
        assert angle_distance(base.unstable, far.unstable) < 1e-8


def moment_with_fifty_digits(vertices, theta):
    """Return U' over area^1.5 by clipping at the median, found by bisection, in mpmath."""
    points = [(mp.mpf(x), mp.mpf(y)) for x, y in vertices]
    cos, sin = mp.cos(theta), mp.sin(theta)
    turned = [(cos * x + sin * y, cos * y - sin * x) for x, y in points]
    pairs = list(zip(turned, turned[1:] + turned[:1], strict=True))

    def clipped(z):
        """Return area and first moment in s of what lies above z (edges below it fold onto it)."""
        area = first = mp.mpf(0)
        for (s0, t0), (s1, t1) in pairs:
            if t0 < z and t1 < z:
                continue
            if (t0 < z) != (t1 < z):
                cross = s0 + (s1 - s0) * (z - t0) / (t1 - t0)
                s0, t0, s1, t1 = (cross, z, s1, t1) if t0 < z else (s0, t0, cross, z)
            a, b = t0 - z, t1 - z
            area -= (a + b) * (s1 - s0) / 2
            first -= (s1 - s0) * (a * (2 * s0 + s1) + b * (s0 + 2 * s1)) / 6
        return area, first

    low, high = min(t for _, t in turned), max(t for _, t in turned)
    total, moment = clipped(low - 1)
    for _ in range(180):
        z = (low + high) / 2
        low, high = (z, high) if clipped(z)[0] > total / 2 else (low, z)
    return (moment - 2 * clipped(z)[1]) / total**1.5


@pytest.mark.slow
@pytest.mark.parametrize("name", ["simple_16", "T", "star5", "convex_20", "near_square"])
def test_equilibria_with_fifty_digits(name):
    """The sign of U' changes within 1e-12 of each equilibrium."""
    vertices = CASES[NAMES.index(name)]["vertices"]
    turn = turn_function(Part(vertices))
    with mp.workdps(50):
        for angles, sign in ((turn.stable, 1), (turn.unstable, -1)):
            for phi in angles:
                left, right = (
                    moment_with_fifty_digits(vertices, mp.mpf(-phi) + mp.mpf(d))
                    for d in ("-1e-12", "1e-12")
                )
                assert left * sign < 0 < right * sign


def test_sides_are_cut_as_the_pieces_say():
    for kind in KINDS:
        for seed in range(4):
            turn = turn_function(random_part(kind, seed))
            edges, radius = size_and_edges(turn.part)
            for piece in turn.pieces:
                theta = -0.5 * (piece.left + piece.right)
                z = squeeze_states(edges, np.array([theta]), 0.5)[0, 0]
                t0 = np.cos(theta) * edges[:, 1] - np.sin(theta) * edges[:, 0] - z
                t1 = np.cos(theta) * edges[:, 3] - np.sin(theta) * edges[:, 2] - z
                cut = set(np.flatnonzero((t0 > 0) != (t1 > 0)).tolist())
                near = np.minimum(np.abs(t0), np.abs(t1)) < 1e-11 * radius
                assert all(near[i] for i in cut ^ set(piece.edges))
            assert sum(p.right - p.left for p in turn.pieces) == pytest.approx(np.pi, abs=1e-11)
            assert all(p.right > p.left for p in turn.pieces)
            assert np.all(np.diff(turn.breakpoints) > 0)


@pytest.mark.parametrize("seed", range(8))
def test_two_pieces_of_equal_area(seed):
    """The line may lie anywhere in the gap between them; U has one value all the same."""
    rng = np.random.default_rng(seed)
    piece = shapely.Polygon(convex(rng, 6))
    turned = shapely.affinity.rotate(piece, [0, 180, 37][seed % 3])
    part = Part(shapely.MultiPolygon([piece, shapely.affinity.translate(turned, 12, seed)]))
    turn = turn_function(part)
    assert_equilibria_are_the_sign_changes_of_a_scan(turn)
    assert turn.certificate.complete
    theta = np.linspace(0, np.pi, 500)
    slow = squeeze_states(part.unit_edges, theta, 0.5)
    assert slow[:, 4].min() < 1e-7  # in the gap, or at a tip beside it
    assert turn.potential(-theta) == pytest.approx(slow[:, 1] * part.area**1.5, rel=1e-13)
    assert turn.moment(-theta) == pytest.approx(slow[:, 2] * part.area**1.5, abs=1e-12)
    assert sum(p.right - p.left for p in turn.pieces) == pytest.approx(np.pi)


def test_median_turns_with_the_part(rng):
    shape = np.array(CASES[NAMES.index("simple_16")]["vertices"])
    base = turn_function(Part(shape))
    for angle in rng.uniform(-7, 7, 5):
        turned = turn_function(Part(shape @ turn_matrix(angle)))
        for phi in rng.uniform(-7, 7, 5):
            offset, chords = turned.median(phi)
            same, lines = base.median(phi + angle)
            assert offset == pytest.approx(same, abs=1e-12)
            assert chords.length == pytest.approx(lines.length, rel=1e-9)
