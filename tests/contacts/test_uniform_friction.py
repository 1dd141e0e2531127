"""Uniform friction: the set, its closest points, and sums of contacts that stand for it."""

import numpy as np
import pytest
import shapely
from scipy.constants import g

from limitsurf.contacts.friction_load import friction_load
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.projection import Status
from tests.sets import test_convex_sets as every_set

L = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)]
RING = shapely.box(0, 0, 3, 2) - shapely.box(1, 0.5, 2, 1.2)
SPECIMENS = {
    "part": UniformFriction(Part(L), 0.7),
    "outline": UniformFriction(L, 0.7),
    "ring": UniformFriction(RING, 2.0),
    "needle": UniformFriction(Part([(0, 0), (30, 0), (30, 1), (0, 1)]), 1.0),
    "far": UniformFriction(shapely.transform(RING, lambda p: p + np.array([30.0, -20.0])), 0.3),
}
QUERIES = [
    every_set.test_residual_lies_in_the_normal_cone,
    every_set.test_error_bounds_are_small_and_never_negative,
    every_set.test_projection_is_idempotent,
    every_set.test_projection_is_non_expansive,
    every_set.test_inside_points_stay,
    every_set.test_distance_and_projection_agree,
    every_set.test_metrics_are_changes_of_coordinates,
    every_set.test_normals_are_unit_and_outer,
    every_set.test_face_holds_the_points_farthest_along_its_normal,
    every_set.test_queries_broadcast,
]


@pytest.fixture(params=SPECIMENS)
def friction(request):
    return SPECIMENS[request.param]


def loads_around(S, rng, k, shares=(0.1, 0.9, 1.0, 1.1, 2.0, 30.0)):
    """Return loads at shares of boundary points."""
    boundary = S.support_point(rng.normal(size=(k, 3)))
    return boundary * rng.choice(shares, size=(k, 1))


@pytest.mark.parametrize("query", QUERIES, ids=lambda query: query.__name__)
def test_it_is_a_convex_set(friction, query, rng):
    query(friction, rng)


def test_contacts_stand_for_it(friction, rng):
    contacts, error = friction.contact_set(0.02 * friction.part.circumradius)
    twin = contacts.limit_surface()
    corners = friction.part.edges[:, :2] + friction._center
    for v in rng.normal(size=(20, 3)):
        fastest = np.hypot(v[0] - v[2] * corners[:, 1], v[1] + v[2] * corners[:, 0]).max()
        off = abs(friction.support(v / fastest) - twin.support(v / fastest))
        assert off <= min(error.bound, 3.0 * error.estimate)


def test_closest_loads_are_the_limits_of_those_of_many_contacts(rng):
    S = SPECIMENS["part"]
    p = loads_around(S, rng, 20, shares=(0.5, 1.5, 4.0))
    W = np.array([1.0, 1.0, 0.3])
    exact, sizes, errors = S.project(p, W), (0.1, 0.05, 0.025), []
    for size in sizes:
        rough = S.contact_set(size * S.part.circumradius)[0].project(p, W)
        assert np.array_equal(exact.inside, rough.inside)
        errors.append(np.abs(exact.point - rough.point).max())
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 1.5
    assert errors[-1] < 2e-5


def test_the_conic_form_is_that_of_its_contacts(rng):
    S = SPECIMENS["outline"]
    d = rng.normal(size=(3, 3))
    slow = np.einsum("ij,ij->i", d, ConvexSet._support_points(S, d))
    _, error = S.contact_set()
    fastest = 3.0 * np.abs(d).sum(axis=1)
    assert np.all(np.abs(S.support(d) - slow) <= error.estimate * fastest + 1e-6)


@pytest.mark.parametrize("condition", [1.0, 1e2, 1e5])
def test_closest_points_meet_the_optimality_conditions(friction, condition, rng):
    """W (p - x) is an outer normal at x, no farther than the bounds say, which are tiny."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    W = turn @ np.diag([1.0, np.sqrt(condition), condition]) @ turn.T
    p = loads_around(friction, rng, 40, shares=(1.1, 2.0, 30.0))
    found = friction.project(p, W)
    assert not found.inside.any()
    e = (p - found.point) @ W
    excess = friction.support(e) - np.einsum("ij,ij->i", e, found.point)
    size = np.sqrt(np.einsum("ij,jk,ik->i", p, W, p))
    assert np.all(np.abs(excess) <= 4.0 * size * found.error_bound)
    assert np.all(found.error_bound <= 1e-11 * size)


def test_random_outlines_metrics_and_loads(rng):
    """Slender parts, stretched metrics, loads far away and 1e-9 from the boundary: all solved."""
    for n in rng.integers(3, 40, 25):
        angle, radius = (
            2 * np.pi / n * (np.arange(n) + rng.uniform(0, 0.8, n)),
            rng.uniform(0.3, 2, n),
        )
        thin = 10.0 ** rng.uniform(-1.7, 0.0)
        corners = radius * np.array([np.cos(angle), thin * np.sin(angle)])
        S = UniformFriction(Part(corners.T), 10.0 ** rng.uniform(-3, 3))
        boundary = S.support_point(rng.normal(size=(100, 3)) * [1, 1, 10.0 ** rng.uniform(-2, 2)])
        near = 1.0 + rng.choice([-1, 1], 40) * 10.0 ** rng.uniform(-9, -2, 40)
        shares = np.concatenate([rng.choice([0.01, 0.5, 0.99, 1.01, 2, 100, 1e6], 60), near])
        turn, condition = np.linalg.qr(rng.normal(size=(3, 3)))[0], 10.0 ** rng.uniform(0, 8)
        W = turn @ np.diag([1.0, np.sqrt(condition), condition]) @ turn.T
        p = boundary * shares[:, None]
        found = S.project(p, W)
        assert np.array_equal(found.inside, shares < 1.0)
        size = np.sqrt(np.einsum("ij,jk,ik->i", p, W, p)) + np.sqrt(
            np.einsum("ij,jk,ik->i", boundary, W, boundary)
        )
        assert np.all(found.error_bound <= 1e-9 * size)
        assert found.iterations.max() <= 25


def test_loads_on_the_boundary_are_told_apart(friction, rng):
    boundary = friction.support_point(rng.normal(size=(30, 3)))
    assert friction.project(boundary * (1.0 - 1e-9)).inside.all()
    outside = friction.project(boundary * (1.0 + 1e-9))
    assert not outside.inside.any()
    assert np.all(outside.twist.any(axis=1))
    touching = friction.project(boundary)
    assert not np.any(touching.status == Status.FAILED)
    assert np.all(touching.distance <= 1e-11 * np.abs(boundary).max())


def test_held_loads_stick_exactly():
    S = SPECIMENS["part"]
    held = friction_load(S, [0.5, 0.2, 0.1], [1.0, 1.0, 0.2])
    assert held.sticks
    assert not held.net.any()
    sliding = friction_load(S, [50.0, 0.0, 0.0], [1.0, 1.0, 0.2])
    assert sliding.net[0] == pytest.approx(50.0 - 0.7 * 4.5, abs=0.1)
    assert S.project([0.0, 0.0, 0.0]).inside


def test_moments_about_another_point(rng):
    """About the origin of its coordinates the load has the moment of its force at the centroid."""
    about_part, about_origin = SPECIMENS["part"], SPECIMENS["outline"]
    x, y = about_part.part.centroid
    d = rng.normal(size=(5, 3))
    moved = d + np.column_stack([-d[:, 2] * y, d[:, 2] * x, np.zeros(5)])
    f, g = about_part.support_point(moved), about_origin.support_point(d)
    assert g[:, :2] == pytest.approx(f[:, :2], abs=1e-13)
    assert g[:, 2] == pytest.approx(f[:, 2] + x * f[:, 1] - y * f[:, 0], abs=1e-12)


def test_hessian_is_scaled_and_transported(friction, rng):
    d, h = rng.normal(size=3), 1e-4
    slopes = [
        (friction.support_point(d + h * e) - friction.support_point(d - h * e)) / (2 * h)
        for e in np.eye(3)
    ]
    H = friction.hessian(d)
    assert np.abs(H - slopes).max() <= 1e-5 * np.abs(H).max()
    assert friction.hessian(np.tile(d, (2, 4, 1))).shape == (2, 4, 3, 3)
    assert friction.hessian(2.0 * d) == pytest.approx(0.5 * H, rel=1e-12)


@pytest.mark.parametrize("scale", [1e-6, 1e4])
def test_units_do_not_matter(scale, rng):
    small = UniformFriction(Part(scale * np.array(L)), 0.7)
    unit = np.array([scale**2, scale**2, scale**3])
    p = loads_around(SPECIMENS["part"], rng, 20, shares=(0.1, 0.9, 1.1, 2.0, 30.0))
    W = np.array([1.0, 1.0, 0.5])
    one, other = SPECIMENS["part"].project(p, W), small.project(p * unit, W / unit**2)
    assert other.point / unit == pytest.approx(one.point, abs=1e-10)
    assert np.array_equal(one.inside, other.inside)


@pytest.mark.parametrize("traction", [0.0, -1.0, np.nan, "1"])
def test_a_traction_must_be_positive(traction):
    with pytest.raises(InputError) as found:
        UniformFriction(L, traction)
    assert found.value.argument == "traction"


def test_a_part_that_lies_flat_rubs_with_its_weight():
    part = Part(L, 0.8)
    S = UniformFriction.under_weight(part, 0.25)
    assert S.support([0.0, 1.0, 0.0]) == pytest.approx(0.25 * part.mass * g, rel=1e-14)
    with pytest.raises(InputError, match="areal_density"):
        UniformFriction.under_weight(Part(L), 0.25)


def test_the_kink_at_rest_has_no_hessian():
    with pytest.raises(InputError, match="kink"):
        SPECIMENS["part"].hessian([0.0, 0.0, 0.0])
