"""Force densities: loads beside shapely, Jacobians and potentials beside differences."""

import numpy as np
import pytest
import shapely
from scipy.constants import g

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.actuators.density_field import DensityField, push_density
from limitsurf.actuators.density_piece import DensityPiece
from limitsurf.actuators.force_fields import skewed_squeeze_field, squeeze_field, uniform_field
from limitsurf.actuators.realised_field import activate
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part

RING_AND_ISLAND = shapely.union_all(
    [
        shapely.Polygon(
            [(0, 0), (3, 0), (3, 2), (1, 2.5), (0, 1)], [[(1, 0.5), (2, 0.5), (2, 1), (1.2, 1.1)]]
        ),
        shapely.box(5, 5, 6, 7),
    ]
)
A = np.array([[0.3, -1.2], [0.4, 0.8]])
CORNER = np.array([0.3, 0.4])
FIELDS = {
    "uniform": DensityField.uniform(0.4, 2.0),
    "squeeze": DensityField.squeeze(0.3, 2.0, 0.1),
    "skewed": DensityField.skewed_squeeze(2.3, 0.4, 2.0, -0.1),
    "elliptic": DensityField.linear([[2.0, 0.3], [0.3, 1.0]], [1.0, 2.0]),
    "vortex": DensityField.linear(A, [0.5, 0.0]),
    "wedge": DensityField(
        [
            DensityPiece([1, 2], A, [0.3, 0.2], [[2, 0.6], [0, 1]], [2 * 0.3 + 0.6 * 0.4, 0.4]),
            DensityPiece([-1, 0.5], A.T, [1, 1], [[-1, -0.3]], [-(0.3 + 0.3 * 0.4)]),
        ]
    ),
}


def star(rng, n):
    """Return a random part, hardly ever convex."""
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    radius = rng.uniform(0.4, 2.0, n)
    return Part(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def parts(rng):
    return [Part(RING_AND_ISLAND), star(rng, 7), star(rng, 23)]


def poses(rng, k):
    return rng.normal(size=(k, 3)) * [1.0, 1.0, 3.0]


def slow_load(field, part, pose):
    """Clip with shapely, cut into triangles, integrate by the rule of the edges' midpoints."""
    load = np.zeros(3)
    for piece in field.pieces:
        region = shapely.box(-50, -50, 50, 50)
        for n, b in zip(piece.normals, piece.bounds, strict=True):
            t, foot = np.array([-n[1], n[0]]), b * n
            corners = [foot - 200 * t, foot + 200 * t, foot + 200 * (t - n), foot - 200 * (t + n)]
            region &= shapely.Polygon(corners)
        clipped = part.at(pose) & region
        for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(clipped)):
            p = shapely.get_coordinates(triangle)[:3]
            for x in 0.5 * (p + np.roll(p, 1, axis=0)):
                f, r = piece.force + piece.slope @ (x - piece.anchor), x - pose[:2]
                load += triangle.area / 3 * np.array([*f, r[0] * f[1] - r[1] * f[0]])
    return load


@pytest.mark.parametrize("name", FIELDS)
def test_loads_are_those_of_clipped_triangles(name, rng):
    field = FIELDS[name]
    for part in parts(rng):
        for pose in poses(rng, 6):
            scale = part.area * np.abs(field(part.edges[:, :2] + pose[:2])).max()
            slow = slow_load(field, part, pose)
            assert field.load(part, pose) == pytest.approx(slow, abs=1e-11 * (1.0 + scale))


def smooth_poses(field, part, rng, k):
    """Return poses at which no corner comes to a border within the steps of a difference."""
    found = []
    for pose in poses(rng, 200):
        outline = part.at(pose)
        at = shapely.get_coordinates(outline)
        gap = shapely.distance(outline.boundary, shapely.Point(CORNER))
        for piece in field.pieces:
            if len(piece.normals):
                gap = min(gap, np.abs(at @ piece.normals.T - piece.bounds).min())
        if gap > 0.02:
            found.append(pose)
    assert len(found) >= k
    return found[:k]


def slope(function, pose, h=1e-3):
    """Return the derivatives with respect to the pose, by differences of sixth order."""
    weights, steps = np.array([-1, 9, -45, 45, -9, 1]) / 60.0, np.array([-3, -2, -1, 1, 2, 3])
    around = pose + h * steps[:, None, None] * np.eye(3)  # (6, 3, 3)
    return np.tensordot(weights, function(around), axes=1).T / h


@pytest.mark.parametrize("name", FIELDS)
def test_jacobians_are_derivatives_of_loads(name, rng):
    field = FIELDS[name]
    for part in parts(rng):
        for pose in smooth_poses(field, part, rng, 4):
            J = field.jacobian(part, pose)
            twin = slope(lambda q, part=part: field.load(part, q), pose)
            assert np.abs(J - twin).max() <= 1e-10 * (1.0 + np.abs(J).max())


@pytest.mark.parametrize("name", ["uniform", "squeeze", "elliptic"])
def test_loads_are_minus_the_gradients_of_potentials(name, rng):
    field = FIELDS[name]
    for part in parts(rng):
        for pose in smooth_poses(field, part, rng, 4):
            pull = slope(lambda q, part=part: field.potential(part, q), pose)
            load = field.load(part, pose)
            assert -pull == pytest.approx(load, abs=1e-10 * (1.0 + np.abs(load).max()))


def test_a_squeezes_potential_is_the_integral_of_the_distance(rng):
    """Also where the line halves the part through its centroid, and along an edge."""
    square = Part([(0, 0), (2, 0), (2, 2), (0, 2)])
    field = DensityField.squeeze(0.0, 3.0)
    for y, expected in ((0.0, 2.0), (1.0, 4.0), (5.0, 20.0), (0.5, 2.5)):
        assert field.potential(square, (7.0, y, 0.0)) == pytest.approx(3.0 * expected, rel=1e-14)
    assert field.load(square, (0.0, 0.0, 0.0)) == pytest.approx(np.zeros(3), abs=1e-14)
    J = field.jacobian(square, (0.0, 0.0, 0.0))
    stiffness = np.diag([0.0, -12.0, 3.0 * (2.0 - 4.0 / 3.0)])  # the last is U - 2 J: unstable
    assert np.abs(J - stiffness).max() < 1e-13
    assert np.array_equal(field.load(square, (0.0, 1.0, 0.0)), [0.0, -12.0, 0.0])


def test_poses_broadcast(rng):
    field, part = FIELDS["squeeze"], star(rng, 9)
    q = rng.normal(size=(2, 5, 3))
    assert field.load(part, q).shape == (2, 5, 3)
    assert field.potential(part, q).shape == (2, 5)
    assert field.jacobian(part, q).shape == (2, 5, 3, 3)
    assert np.array_equal(field.load(part, q)[1, 2], field.load(part, q[1, 2]))
    assert field.load(part, np.empty((0, 3))).shape == (0, 3)


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_units_of_length_do_not_matter(scale, rng):
    part = star(rng, 11)
    other = Part(scale * part.edges[:, :2])
    field, scaled = DensityField.squeeze(0.3, 1.0, 0.2), DensityField.squeeze(0.3, 1.0, 0.2 * scale)
    for pose in poses(rng, 10):
        there = pose * [scale, scale, 1.0]
        unit = scale ** np.array([2.0, 2.0, 3.0])
        found, expected = scaled.load(other, there) / unit, field.load(part, pose)
        assert found == pytest.approx(expected, abs=1e-13 * part.area)


def test_far_from_the_origin_only_the_distance_from_borders_is_rounded(rng):
    part, far = star(rng, 11), np.array([3e4, -7e4])
    n = np.array([-np.sin(0.3), np.cos(0.3)])
    near, there = DensityField.squeeze(0.3, 1.0), DensityField.squeeze(0.3, 1.0, float(n @ far))
    near_linear, linear = DensityField.linear(A), DensityField.linear(A, far)
    for pose in poses(rng, 10) * [0.3, 0.3, 1.0]:
        q = pose + np.array([*far, 0.0])
        assert there.load(part, q) == pytest.approx(near.load(part, pose), abs=1e-9)
        assert linear.load(part, q) == pytest.approx(near_linear.load(part, pose), abs=1e-9)


def test_densities_at_points_are_those_of_the_ideal_fields(rng):
    points = rng.normal(size=(3, 40, 2))
    pairs = [
        (DensityField.squeeze(0.7, 3.0, 0.2), squeeze_field(0.7, 0.2)),
        (DensityField.skewed_squeeze(0.7, 0.3, 3.0, 0.2), skewed_squeeze_field(0.7, 0.3, 0.2)),
        (DensityField.uniform(0.7, 3.0), uniform_field(0.7)),
    ]
    for density, ideal in pairs:
        assert density(points) == pytest.approx(3.0 * ideal(points), abs=1e-14)
        assert density.scaled(1 / 3.0)(points) == pytest.approx(ideal(points), abs=1e-14)
    on_line = np.array([[0.0, 0.0], [4.0, 0.0]])
    assert not DensityField.squeeze(0.0, 3.0)(on_line).any()
    assert FIELDS["vortex"](points) == pytest.approx(-(points - [0.5, 0.0]) @ A.T, abs=1e-14)


def test_an_array_realises_a_density(array64, paper_t):
    density = push_density(paper_t, array64)
    pixel = array64.pixel
    assert density == pytest.approx(pixel.friction * pixel.offset_fraction * 0.08 * g, rel=1e-14)
    field = DensityField.squeeze(0.5, density)
    run = activate(array64, field.scaled(1 / density)).active
    assert np.array_equal(run, activate(array64, squeeze_field(0.5)).active)
    assert run.sum() == squeeze_activation(array64, 0.5).active.sum()


def test_scaled_fields_scale_loads_and_potentials(rng):
    part, pose = star(rng, 9), (0.1, 0.2, 0.3)
    for name in ("squeeze", "elliptic"):
        field, double = FIELDS[name], FIELDS[name].scaled(2.0)
        assert double.load(part, pose) == pytest.approx(2.0 * field.load(part, pose), rel=1e-14)
        expected = 2.0 * field.potential(part, pose)
        assert double.potential(part, pose) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("name", ["skewed", "vortex", "wedge"])
def test_fields_without_potential_say_so(name):
    assert not FIELDS[name].has_potential
    with pytest.raises(InputError, match="no potential"):
        FIELDS[name].potential(Part([(0, 0), (1, 0), (0, 1)]), (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: DensityField([]), "pieces"),
        (lambda: DensityPiece([1.0, 0.0], normals=[[0.0, 0.0]], bounds=[1.0]), "normals"),
        (lambda: DensityPiece([1.0, 0.0], normals=[[0.0, 1.0]]), "bounds"),
        (lambda: DensityPiece([1.0]), "force"),
        (lambda: DensityPiece([1.0, 0.0], slope=A, level=0.0), "level"),
        (lambda: DensityField.squeeze(np.nan, 1.0), "angle"),
        (lambda: DensityField.squeeze(0.0, np.inf), "density"),
        (lambda: DensityField.squeeze(0.0, 1.0, np.nan), "offset"),
        (lambda: DensityField.skewed_squeeze(0.0, 1.6, 1.0), "skew"),
        (lambda: DensityField.linear([1.0, 2.0]), "stiffness"),
        (lambda: FIELDS["squeeze"].scaled(np.nan), "factor"),
        (lambda: FIELDS["squeeze"]([1.0, 2.0, 3.0]), "points"),
        (lambda: FIELDS["squeeze"].load(Part([(0, 0), (1, 0), (0, 1)]), [0.0, 1.0]), "pose"),
    ],
)
def test_bad_arguments_are_named(make, argument):
    with pytest.raises(InputError) as found:
        make()
    assert found.value.argument == argument
