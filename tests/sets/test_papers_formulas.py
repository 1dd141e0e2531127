"""What the 1994 paper says of limit surfaces: its five properties, Lemma 10, explicit cases."""

import numpy as np
import pytest

from limitsurf.contacts.coulomb import contact_map, coulomb_contact
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.h_polytope import HPolytope
from limitsurf.sets.linear_image import LinearImage, transport
from limitsurf.sets.minkowski_sum import MinkowskiSum

POSITIONS = np.array([[1.0, 0.0], [-1.0, 0.0], [0.2, 0.9]])
RADII = np.array([1.0, 0.6, 0.8])
SURFACES = {
    "one contact": coulomb_contact(POSITIONS[0], RADII[0]),
    "bar": MinkowskiSum(coulomb_contact([1, 0], 1.0), coulomb_contact([-1, 0], 1.0)),
    "three contacts": MinkowskiSum(*map(coulomb_contact, POSITIONS, RADII)),
}


def friction(v):
    """Return the load of three Coulomb contacts on a part that moves with twist v."""
    total = np.zeros(3)
    for r, m in zip(POSITIONS, RADII, strict=True):
        u = contact_map(r).T @ v
        total += contact_map(r) @ (-m * u / np.linalg.norm(u))
    return total


@pytest.mark.parametrize("name", SURFACES)
def test_property_1_closed_and_convex(name, rng):
    L = SURFACES[name]
    x = L.support_point(rng.normal(size=(6, 3)))
    assert np.all(L.contains(x, tol=1e-6))
    assert np.all(L.contains(0.5 * (x[:3] + x[3:]), tol=1e-6))


def test_properties_2_and_3_sliding_friction_is_on_the_surface_with_normal_minus_v(rng):
    L = SURFACES["three contacts"]
    for v in rng.normal(size=(10, 3)):
        F = friction(v)
        assert L.contains(F, tol=1e-6)
        assert -v @ F == pytest.approx(float(L.support(-v)))
        assert L.support_point(-v) == pytest.approx(F)


@pytest.mark.parametrize("name", SURFACES)
def test_property_4_friction_is_the_point_nearest_to_the_load(name, rng):
    L = SURFACES[name]
    for load in 3 * rng.normal(size=(3, 3)):
        nearest = L.project(load)
        others = L.support_point(rng.normal(size=(300, 3)))
        assert np.linalg.norm(others - load, axis=1).min() >= nearest.distance - 1e-6


def test_property_5_the_section_at_zero_moment_is_the_limit_curve():
    """For the symmetric bar pure forces up to the sum of the radii hold it."""
    bar = SURFACES["bar"]
    for angle in np.linspace(0, np.pi, 5):
        force = np.array([np.cos(angle), np.sin(angle), 0.0])
        assert bar.contains(1.999 * force)
        assert not bar.contains(2.001 * force)


def test_lemma_10_the_bar_of_figures_8_and_9():
    bar = SURFACES["bar"]
    assert bar.support(np.vstack([np.eye(3), -np.eye(3)])) == pytest.approx([2.0] * 6)
    diagonal = np.array([0.0, 1.0, 1.0])  # along one disk's steepest direction, across the other's
    assert bar.support(diagonal) == pytest.approx(2.0)
    # both disks hold (1, 0, 0): the sum has the segment between the two disks' tips as a ridge
    face = bar.face([1.0, 0.0, 0.0])
    assert face.support([0, 1, 0]) == pytest.approx(0.0)


def test_where_the_load_is_not_unique_the_face_says_so():
    """Figure 6b: at the centre of rotation a contact can exert any load of its disk."""
    contact = coulomb_contact([1.0, 0.0], 1.0)
    rotation = np.array([0.0, -1.0, 1.0])  # about the contact
    assert contact.face(-rotation) is contact
    assert contact.face([1.0, 0.0, 0.0]).project([9.0, 9.0, 9.0]).point == pytest.approx([1, 0, 0])


def test_transport_composes_and_moves_loads(rng):
    a, b = rng.normal(size=(2, 2))
    assert transport(a) @ transport(b) == pytest.approx(transport(a + b))
    assert transport(a) @ transport(-a) == pytest.approx(np.eye(3))
    there = coulomb_contact(a, 1.0)
    moved = LinearImage(transport(a), coulomb_contact([0.0, 0.0], 1.0))
    d = rng.normal(size=(20, 3))
    assert moved.support(d) == pytest.approx(there.support(d))
    p = 2 * rng.normal(size=(20, 3))
    assert moved.project(p).point == pytest.approx(there.project(p).point)


def test_flat_facet_formula(rng):
    """F_s = d n_s/|n_s|^2 with n_s = T_s^-T n: the facet nearest to the origin after transport."""
    for _ in range(20):
        n, d = rng.normal(size=3), rng.uniform(0.1, 2.0)
        T = transport(rng.normal(size=2))
        n_s = np.linalg.solve(T.T, n)
        half_space = HPolytope([-n_s], [-d])  # {x : n_s x >= d}
        assert half_space.project(np.zeros(3)).point == pytest.approx(d * n_s / (n_s @ n_s))


def test_ellipse_in_the_plane_by_its_quartic(rng):
    """Closest point of x^2/a^2 + y^2/b^2 = 1: sum (s_i p_i / (s_i^2 + t))^2 = 1, a quartic in t."""
    a, b = 2.0, 0.7
    ellipse = Ellipsoid([0, 0], np.diag([a, b]))
    for p in 4 * rng.normal(size=(30, 2)):
        if (p[0] / a) ** 2 + (p[1] / b) ** 2 <= 1:
            assert ellipse.project(p).point == pytest.approx(p)
            continue
        u, w = np.poly1d([1.0, a * a]), np.poly1d([1.0, b * b])
        quartic = u**2 * w**2 - (a * p[0]) ** 2 * w**2 - (b * p[1]) ** 2 * u**2
        t = max(r.real for r in quartic.roots if abs(r.imag) < 1e-9)
        x = np.array([a * a * p[0] / (a * a + t), b * b * p[1] / (b * b + t)])
        assert ellipse.project(p).point == pytest.approx(x, abs=1e-9)
