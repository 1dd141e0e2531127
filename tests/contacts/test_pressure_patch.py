"""Patches beside integrals in closed form: loads, moments, spin torques, stated errors."""

from itertools import pairwise
from math import factorial

import numpy as np
import pytest
import shapely
from scipy import integrate

from limitsurf.contacts.patch_quadrature import hertz_nodes, polygon_nodes
from limitsurf.contacts.pressure_patch import PressurePatch
from limitsurf.errors import InputError

FAR = np.array([100.0, -50.0])
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
RING_AND_ISLAND = shapely.union_all(
    [
        shapely.Polygon(
            [(0, 0), (3, 0), (3, 2), (1, 2.5), (0, 1)], [[(1, 0.5), (2, 0.5), (2, 1), (1.2, 1.1)]]
        ),
        shapely.box(5, 5, 6, 7),
    ]
)


def loads(contacts, mu):
    """Return total force and its centre."""
    N = contacts.radius / mu
    return N.sum(), N @ contacts.position / N.sum()


@pytest.mark.parametrize("size", [5.0, 0.5])
def test_uniform_pressure_is_exact_in_force_and_moments(size):
    far = shapely.transform(RING_AND_ISLAND, lambda p: p + FAR)
    for outline in (RING_AND_ISLAND, far):
        contacts, _ = PressurePatch.uniform(outline, 3.0, 0.5).contact_set(size)
        force, center = loads(contacts, 0.5)
        assert force == pytest.approx(3.0, rel=1e-13)
        c = shapely.centroid(RING_AND_ISLAND)
        expected = np.array([c.x, c.y]) + (outline is far) * FAR
        assert center == pytest.approx(expected, abs=1e-12)
        assert shapely.contains_xy(outline, *contacts.position.T).all()


def test_linear_pressure_has_the_given_centre():
    patch = PressurePatch.linear(RING_AND_ISLAND, 3.0, 0.5, [2.0, 1.9])
    force, center = loads(patch.contact_set(0.5)[0], 0.5)
    assert force == pytest.approx(3.0, rel=1e-13)
    assert center == pytest.approx([2.0, 1.9], abs=1e-13)
    # the core of a square is the diamond of a sixth of its side
    edge = PressurePatch.linear(SQUARE, 1.0, 1.0, [0.5 + 1 / 6, 0.5]).contact_set(0.1)[0]
    assert edge.radius.min() >= 0.0
    with pytest.raises(InputError, match="core"):
        PressurePatch.linear(SQUARE, 1.0, 1.0, [0.5 + 1 / 6 + 1e-6, 0.5])


def test_hertz_pressure_is_exact_in_force_and_moments():
    contacts, _ = PressurePatch.hertz([3.0, -2.0], 0.5, 4.0, 0.25).contact_set(0.1)
    force, center = loads(contacts, 0.25)
    assert force == pytest.approx(4.0, rel=1e-13)
    assert center == pytest.approx([3.0, -2.0], abs=1e-13)
    r2 = ((contacts.position - center) ** 2).sum(axis=1)
    assert contacts.radius @ r2 == pytest.approx(2 / 5 * 0.25, rel=1e-12)


def spin(contacts):
    return float(contacts.limit_surface().support([0.0, 0.0, 1.0]))


@pytest.mark.parametrize("size", [0.3, 0.1, 0.03])
def test_spin_torques_are_known_within_the_errors(size):
    contacts, error = PressurePatch.hertz([0.0, 0.0], 1.0, 1.0, 1.0).contact_set(size)
    off = abs(spin(contacts) - 3 * np.pi / 16)
    assert off <= error.estimate
    assert error.estimate <= error.bound
    square = shapely.box(-1.0, -1.0, 1.0, 1.0)
    contacts, error = PressurePatch.uniform(square, 1.0, 1.0).contact_set(size)
    exact = (np.sqrt(2.0) + np.log(1.0 + np.sqrt(2.0))) / 3.0
    assert abs(spin(contacts) - exact) / np.sqrt(2.0) <= error.estimate
    assert error.estimate <= error.bound


def test_errors_fall_with_the_size():
    for patch in (
        PressurePatch.uniform(RING_AND_ISLAND, 1.0, 1.0),
        PressurePatch.hertz([0.0, 0.0], 2.0, 1.0, 1.0),
    ):
        errors = [patch.contact_set(size)[1] for size in (0.8, 0.4, 0.2)]
        for larger, smaller in pairwise(errors):
            assert smaller.estimate < 0.5 * larger.estimate
            assert smaller.bound < 0.7 * larger.bound


def test_the_bound_holds_for_any_twist(rng):
    """Fine contacts stand for the truth; twists are scaled to a largest speed of 1."""
    patch = PressurePatch.uniform(RING_AND_ISLAND, 1.0, 0.5)
    fine, _ = patch.contact_set(0.05)
    rough, error = patch.contact_set(2.0)
    corners = shapely.get_coordinates(RING_AND_ISLAND)
    for v in rng.normal(size=(200, 3)) * [3.0, 3.0, 1.0]:
        fastest = np.hypot(v[0] - v[2] * corners[:, 1], v[1] + v[2] * corners[:, 0]).max()
        h = [s.limit_surface().support(v / fastest) for s in (fine, rough)]
        assert abs(h[0] - h[1]) <= error.bound


def test_a_sampled_pressure(rng):
    def bump(r):
        return np.exp(-(r**2).sum(axis=1))

    box = shapely.box(-1.0, -1.0, 2.0, 1.0)
    exact = integrate.dblquad(lambda y, x: np.exp(-x * x - y * y), -1, 2, -1, 1)[0]
    patch = PressurePatch.sampled(box, bump, 0.5)
    assert patch.normal_force == pytest.approx(exact, rel=1e-9)
    contacts, error = patch.contact_set()
    assert loads(contacts, 0.5)[0] == pytest.approx(exact, rel=1e-7)
    assert error.bound == np.inf
    scaled = PressurePatch.sampled(box, bump, 0.5, normal_force=7.0).contact_set()[0]
    assert loads(scaled, 0.5)[0] == pytest.approx(7.0, rel=1e-14)


def test_rules_are_exact_for_polynomials():
    triangle = shapely.Polygon([(0, 0), (1, 0), (0, 1)])
    for coarse, degree in ((False, 5), (True, 2)):
        nodes = polygon_nodes(triangle, 0.4, coarse=coarse)
        x, y = nodes.position.T
        for a in range(degree + 1):
            for b in range(degree + 1 - a):
                exact = factorial(a) * factorial(b) / factorial(a + b + 2)
                assert nodes.weight @ (x**a * y**b) == pytest.approx(exact, rel=1e-13)


def test_hertz_rings_carry_the_load_around_them():
    for size in (0.9, 0.3, 0.05):
        nodes = hertz_nodes(1.0, size)
        r = np.hypot(*nodes.position.T)
        assert nodes.weight.sum() == pytest.approx(1.0)
        assert nodes.size.max() < 2.5 * size
        assert np.all(r < 1.0)


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: PressurePatch.uniform(SQUARE, -1.0, 0.5), "normal_force"),
        (lambda: PressurePatch.uniform(SQUARE, 1.0, -0.5), "mu"),
        (lambda: PressurePatch.uniform([(0, 0), (1, 1), (1, 0), (0, 1)], 1.0, 0.5), "outline"),
        (lambda: PressurePatch.hertz([0, 0], 0.0, 1.0, 0.5), "radius"),
        (lambda: PressurePatch.sampled(SQUARE, lambda r: -r[:, 0], 0.5), "pressure"),
        (lambda: PressurePatch.sampled(SQUARE, lambda r: r, 0.5), "pressure"),
        (lambda: PressurePatch.sampled(SQUARE, lambda r: 0 * r[:, 0], 0.5, 1.0), "pressure"),
        (lambda: PressurePatch.uniform(SQUARE, 1.0, 0.5).contact_set(0.0), "size"),
        (lambda: PressurePatch.uniform(SQUARE, 1.0, 0.5).contact_set(1e-6), "size"),
        (lambda: PressurePatch.hertz([0, 0], 1.0, 1.0, 0.5).contact_set(1e-6), "size"),
    ],
)
def test_bad_arguments_are_named(make, argument):
    with pytest.raises(InputError) as found:
        make()
    assert found.value.argument == argument
