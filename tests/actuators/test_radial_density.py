"""The radial density beside quadrature, forty digits and differences."""

import mpmath as mp
import numpy as np
import pytest
import shapely
from scipy.integrate import quad

from limitsurf.actuators.force_fields import radial_field
from limitsurf.actuators.radial_density import RadialField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from tests.actuators.test_density_field import RING_AND_ISLAND, slope, star

L = Part([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)])
PARTS = {"L": L, "ring and island": Part(RING_AND_ISLAND)}
CENTER = np.array([0.3, -0.2])
#: Distances of the centre from the centroid, in circumradii; the series begins at 4.
DISTANCES = (0.0, 0.4, 1.0, 2.5, 3.99, 4.01, 20.0)


def slow_load(part, pose, center):
    """Cut every triangle into those between its edges and the centre; integrate along the edges.

    Over such a triangle the direction e depends only on where the ray meets the edge.
    """
    out = np.zeros(4)
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(part.at(pose)))
    for triangle in triangles:
        corners = shapely.get_coordinates(shapely.orient_polygons(triangle))[:3] - center
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            cross = a[0] * b[1] - a[1] * b[0]
            if abs(cross) < 1e-14:
                continue
            near = float(np.clip(-(a @ (b - a)) / ((b - a) @ (b - a)), 0.0, 1.0))

            def ray(v, a=a, b=b):
                x = a + v * (b - a)
                rho = np.hypot(*x)
                s = pose[:2] - center  # of the centre of mass
                # moment about it: arms u x - s, with u in [0, 1] and weight u
                return np.array([*(-0.5 * x / rho), 0.5 * (s[0] * x[1] - s[1] * x[0]) / rho, rho])

            for k in range(4):
                points = [near] if 0.0 < near < 1.0 else None
                value = quad(lambda v, k=k: ray(v)[k], 0, 1, points=points, epsabs=1e-13)[0]
                out[k] += cross * value * (1.0 / 3.0 if k == 3 else 1.0)
    return out


def around(rng, part, distance):
    """Return a pose with the centre at a distance, in circumradii, from the centroid."""
    angle, theta = rng.uniform(0, 2 * np.pi, 2)
    away = distance * part.circumradius * np.array([np.cos(angle), np.sin(angle)])
    return np.array([*(CENTER + away), theta])


@pytest.mark.parametrize("name", PARTS)
def test_loads_and_potentials_are_those_of_quadrature(name, rng):
    part, field = PARTS[name], RadialField(2.0, CENTER)
    for distance in DISTANCES[:5] if name == "L" else DISTANCES[1::2]:
        pose = around(rng, part, distance)
        slow = 2.0 * slow_load(part, pose, CENTER)
        assert field.load(part, pose) == pytest.approx(slow[:3], abs=1e-11 * part.area)
        assert field.potential(part, pose) == pytest.approx(slow[3], rel=1e-11)


@pytest.mark.parametrize("name", PARTS)
def test_jacobians_and_loads_are_derivatives(name, rng):
    part, field = PARTS[name], RadialField(2.0, CENTER)
    inside = [pose for d in (0.3, 0.8) for pose in [around(rng, part, d)] if clear(part, pose)]
    for pose in [*inside, *(around(rng, part, d) for d in (1.5, 3.0, 3.9999, 4.0001, 6.0, 50.0))]:
        scale = part.area * part.circumradius * (1.0 + np.hypot(*pose[:2]))
        J = field.jacobian(part, pose)
        twin = slope(lambda q: field.load(part, q), pose)
        assert np.abs(J - twin).max() <= 3e-11 * scale
        assert np.array_equal(J, J.T)
        pull = -slope(lambda q: field.potential(part, q), pose)
        assert np.abs(field.load(part, pose) - pull).max() <= 3e-11 * scale


def clear(part, pose):
    return shapely.distance(part.at(pose).boundary, shapely.Point(CENTER)) > 0.05


def exact(part, pose, center):
    """Return force and moment in the working precision: sums over the edges of the real thing."""
    c, s = mp.cos(mp.mpf(pose[2])), mp.sin(mp.mpf(pose[2]))
    dx, dy = (mp.mpf(float(center[k])) - mp.mpf(float(pose[k])) for k in (0, 1))
    fx = fy = mp.mpf(0)
    for edge in part.edges:
        x0, y0, x1, y1 = (mp.mpf(float(x)) for x in edge)
        ax, ay, bx, by = c * x0 - s * y0, s * x0 + c * y0, c * x1 - s * y1, s * x1 + c * y1
        length = mp.hypot(bx - ax, by - ay)
        tx, ty = (bx - ax) / length, (by - ay) / length
        d = (ax - dx) * ty - (ay - dy) * tx
        t = [(x - dx) * tx + (y - dy) * ty for x, y in ((ax, ay), (bx, by))]

        def primitive(t, d=d):
            return (t * mp.sqrt(t * t + d * d) + d * d * mp.asinh(t / abs(d))) / 2

        K = primitive(t[1]) - primitive(t[0])
        fx, fy = fx - ty * K, fy + tx * K
    return [fx, fy, dx * fy - dy * fx]


def test_far_centres_keep_the_digits_of_the_moment():
    """It falls as one over the distance, and would drown in the rounding of the force."""
    R = L.circumradius
    with mp.workdps(60):
        for distance in (3.0, 5.0, 30.0, 1e3, 1e6):
            pose = np.array([CENTER[0] + distance * R, CENTER[1] + 0.3 * R, 0.7])
            found, twin = RadialField(1.0, CENTER).load(L, pose), exact(L, pose, CENTER)
            for value, true in zip(found, twin, strict=True):
                assert value == pytest.approx(float(true), rel=3e-13)


def test_the_centre_on_corners_and_edges():
    """Finite, and the limit of what is next to it."""
    turned = RadialField(1.0, CENTER)
    ends = np.vstack([L.edges[:, :2], 0.5 * (L.edges[:, :2] + L.edges[:, 2:])])
    for r in ends:
        pose = np.array([*(CENTER - r), 0.0])
        beside = pose + np.array([1e-9, -2e-9, 0.0])
        assert turned.load(L, pose) == pytest.approx(turned.load(L, beside), abs=1e-7)
        J = turned.jacobian(L, pose)
        assert np.isfinite(J).all()
        assert pytest.approx(turned.jacobian(L, beside), abs=1e-5) == J


def test_a_disk_in_closed_form():
    """In the middle U = 2/3 pi r^3; the stiffness is half of ``integral dA / rho = 2 pi r``."""
    t = 2 * np.pi * np.arange(2000) / 2000
    disk, field = Part(np.column_stack([np.cos(t), np.sin(t)])), RadialField(3.0)
    assert field.potential(disk, np.zeros(3)) == pytest.approx(2 * np.pi, rel=1e-5)
    J = field.jacobian(disk, np.zeros(3))
    assert pytest.approx(-3.0 * np.pi * np.diag([1.0, 1.0, 0.0]), abs=1e-4) == J


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_units_of_length_do_not_matter(scale, rng):
    part = star(rng, 11)
    other = Part(scale * part.edges[:, :2])
    field, scaled = RadialField(1.0, CENTER), RadialField(1.0, scale * CENTER)
    unit = scale ** np.array([2.0, 2.0, 3.0])
    for distance in DISTANCES:
        pose = around(rng, part, distance)
        there = pose * [scale, scale, 1.0]
        found = scaled.load(other, there) / unit
        assert found == pytest.approx(field.load(part, pose), abs=1e-12 * part.area)


def test_densities_at_points_and_other_shapes(rng):
    field = RadialField(3.0, CENTER)
    points = rng.normal(size=(3, 4, 2))
    assert field(points) == pytest.approx(3.0 * radial_field(CENTER)(points), abs=1e-14)
    assert not field(CENTER).any()
    q = rng.normal(size=(2, 5, 3))
    assert field.load(L, q).shape == (2, 5, 3)
    assert field.jacobian(L, q).shape == (2, 5, 3, 3)
    assert field.potential(L, q).shape == (2, 5)
    assert np.array_equal(field.load(L, q)[1, 2], field.load(L, q[1, 2]))
    assert field.scaled(-2.0).load(L, q) == pytest.approx(-2.0 * field.load(L, q), rel=1e-14)
    assert field.convex
    assert not field.scaled(-2.0).convex
    assert repr(field) == "RadialField(3 N/m^2 towards (0.3, -0.2) m)"


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: RadialField(np.nan), "density"),
        (lambda: RadialField("fast"), "density"),
        (lambda: RadialField(1.0, [0.0]), "center"),
        (lambda: RadialField(1.0).scaled(np.inf), "factor"),
        (lambda: RadialField(1.0).load(L, [0.0, 1.0]), "pose"),
        (lambda: RadialField(1.0)([1.0, 2.0, 3.0]), "points"),
    ],
)
def test_bad_arguments_are_named(make, argument):
    with pytest.raises(InputError) as found:
        make()
    assert found.value.argument == argument
