"""The power of uniform friction beside forty digits, quadrature and finite differences."""

import mpmath as mp
import numpy as np
import pytest
import shapely
from scipy import integrate

from limitsurf.geometry.part import Part
from limitsurf.kernels.uniform_friction import power_many, uniform_patch

CIRCLE = np.exp(2j * np.pi * np.arange(300) / 300)
PARTS = {
    "L": Part([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)]),
    "ring and island": Part(
        shapely.union_all(
            [shapely.box(0, 0, 3, 2) - shapely.box(1, 0.5, 2, 1.2), shapely.box(5, 5, 6, 7)]
        )
    ),
    "needle": Part([(0, 0), (100, 0), (100, 1), (0, 1)]),
    "disk": Part(np.column_stack([CIRCLE.real, CIRCLE.imag])),
}
#: Distances of the centre of rotation from the centroid, in circumradii.
DISTANCES = (0.0, 0.3, 1.0, 2.0, 3.9, 4.1, 10.0, 1e3, 1e6, 1e12)


def patch_of(part):
    return uniform_patch(part.edges / part.circumradius)


def sums(patch, v):
    out = np.empty((np.atleast_2d(v).shape[0], 11))
    power_many(patch, np.ascontiguousarray(np.atleast_2d(v), dtype=float), out)
    return out


def exact_power(edges, v):
    """Return h by the primitive of the distance from a point, in the working precision."""
    vx, vy, w = (mp.mpf(float(x)) for x in v)
    cx, cy, total = -vy / w, vx / w, mp.mpf(0)
    for edge in edges:
        x0, y0, x1, y1 = (mp.mpf(float(x)) for x in edge)
        L = mp.hypot(x1 - x0, y1 - y0)
        tx, ty = (x1 - x0) / L, (y1 - y0) / L
        d = (x0 - cx) * ty - (y0 - cy) * tx
        s = [(x - cx) * tx + (y - cy) * ty for x, y in ((x0, y0), (x1, y1))]

        def primitive(s, d=d):
            turned = d * d * mp.asinh(s / abs(d)) if d != 0 else 0
            return (s * mp.sqrt(s * s + d * d) + turned) / 2

        total += d * (primitive(s[1]) - primitive(s[0])) / 3
    return abs(w) * total


def rotations(rng, distance):
    """Return twists about points at a distance, with either sense and any size."""
    angle = rng.uniform(0, 2 * np.pi, 3)
    c = distance * np.column_stack([np.cos(angle), np.sin(angle)])
    w = rng.choice([-1.0, 1.0], 3) * 10.0 ** rng.uniform(-3, 3, 3)
    return w[:, None] * np.column_stack([c[:, 1], -c[:, 0], np.ones(3)])


@pytest.mark.parametrize("name", PARTS)
def test_power_has_thirteen_digits_for_every_twist(name, rng):
    patch = patch_of(PARTS[name])
    with mp.workdps(50):
        for distance in DISTANCES if name != "disk" else DISTANCES[1::2]:
            for v in rotations(rng, distance):
                exact = exact_power(patch.edges, v)
                assert abs(mp.mpf(float(sums(patch, v)[0, 0])) / exact - 1) < 1e-13


@pytest.mark.parametrize("name", ["L", "ring and island"])
def test_centres_on_corners_and_edges(name):
    patch = patch_of(PARTS[name])
    ends = patch.edges[:, :2], 0.5 * (patch.edges[:, :2] + patch.edges[:, 2:])
    with mp.workdps(40):
        for x, y in np.vstack([*ends, ends[0] + 1e-9, ends[1] - 1e-13]):
            found = sums(patch, [y, -x, 1.0])
            assert np.isfinite(found).all()
            exact = float(exact_power(patch.edges, (y, -x, 1.0)))
            assert found[0, 0] == pytest.approx(exact, rel=1e-14)


def test_translations_and_rest():
    patch = patch_of(PARTS["L"])
    found = sums(patch, [[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]])
    assert found[0, :4] == pytest.approx(patch.area * np.array([5.0, 0.6, 0.8, 0.0]), abs=1e-15)
    assert not found[1, :4].any()


def test_power_is_the_integral_of_the_speed():
    """A triangle by quadrature, the centre inside and outside."""
    part = Part([(0, 0), (2, 0), (0, 1)])
    patch, R = patch_of(part), part.circumradius
    cx, cy = part.centroid
    for vx, vy, w in ((0.1, 0.2, 1.0), (1.0, -2.0, 0.7), (0.5, 0.3, 0.01)):

        def speed(y, x, vx=vx, vy=vy, w=w):
            return np.hypot(vx - w * (y - cy), vy + w * (x - cx))

        slow = integrate.dblquad(speed, 0, 2, 0, lambda x: 1 - x / 2, epsabs=1e-10)[0]
        assert sums(patch, [vx, vy, w * R])[0, 0] * R**2 == pytest.approx(slow, abs=1e-9)


@pytest.mark.parametrize("name", ["L", "ring and island", "disk"])
def test_gradient_and_hessian_are_derivatives(name, rng):
    """Sixth-order differences; Euler's relations for homogeneous functions."""
    patch = patch_of(PARTS[name])
    weights = np.array([-1, 9, -45, 45, -9, 1]) / 60.0
    steps = np.array([-3, -2, -1, 1, 2, 3])
    for v in np.vstack([rotations(rng, distance) for distance in (0.2, 1.5, 3.0, 6.0, 30.0)]):
        v = v / np.abs(v).max()
        h, *g = sums(patch, v)[0, :4]
        xx, xy, yy, xw, yw, ww = sums(patch, v)[0, 4:10]
        H, scale = np.array([[xx, xy, xw], [xy, yy, yw], [xw, yw, ww]]), patch.area
        for k in range(3):
            around = v + 1e-3 * steps[:, None] * np.eye(3)[k]
            slopes = weights @ sums(patch, around)[:, :4] / 1e-3
            assert slopes[0] == pytest.approx(g[k], abs=1e-9 * scale)
            assert slopes[1:] == pytest.approx(H[k], abs=1e-6 * np.abs(H).max())
        assert v @ g == pytest.approx(h, rel=1e-12)
        assert H @ v == pytest.approx(np.zeros(3), abs=1e-12 * np.abs(H).max())
        assert np.linalg.eigvalsh(H).min() > -1e-12 * np.abs(H).max()
