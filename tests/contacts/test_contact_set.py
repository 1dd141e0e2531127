"""Contact sets: disks, ellipses, polygons, offsets, and what is refused."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.coulomb import contact_map
from limitsurf.errors import InputError
from limitsurf.sets.arguments import read_metric
from limitsurf.sets.contact_sum import ContactSum
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.linear_image import LinearImage, transport
from limitsurf.sets.minkowski_sum import MinkowskiSum
from limitsurf.sets.v_polytope import VPolytope

W = np.array([[1.0, 0.2, 0.1], [0.2, 2.0, -0.3], [0.1, -0.3, 0.7]])


def contacts(rng, n=6, **more):
    return ContactSet(rng.normal(size=(n, 2)), rng.uniform(0.1, 1.0, n), **more)


def one_by_one(C, ellipses=None):
    """Return the sum of the images of the contacts' own sets, as the definition says."""
    E = np.tile(np.eye(2), (len(C), 1, 1)) if ellipses is None else ellipses
    parts = [
        LinearImage(contact_map(r), Ellipsoid(a, m * e))
        for r, m, a, e in zip(C.position, C.radius, C.offset, E, strict=True)
    ]
    return MinkowskiSum(*parts)


@pytest.mark.parametrize("elliptic", [False, True])
def test_the_definition(rng, elliptic):
    E = rng.normal(size=(6, 2, 2)) if elliptic else None
    C = contacts(rng, offset=rng.normal(size=(6, 2)), ellipse=E)
    surface, twin = C.limit_surface(), one_by_one(C, E)
    d = rng.normal(size=(50, 3))
    assert surface.support(d) == pytest.approx(twin.support(d), rel=1e-12, abs=1e-12)
    for p in C.offset_load + rng.normal(size=(4, 3)) * [[10], [5], [2], [0.1]]:
        P = C.project(p, W)
        slow = ConvexSet._project(twin, p[None], read_metric(W, 3))
        e = P.point - slow.point[0]
        assert np.sqrt(e @ W @ e) <= P.error_bound + slow.error_bound[0] + 1e-9
        assert slow.error_bound[0] < 1e-3


def test_offsets_shift_the_set(rng):
    passive = contacts(rng)
    push = rng.normal(size=(6, 2))
    active = ContactSet(passive.position, passive.radius, push)
    expected = sum(contact_map(r) @ f for r, f in zip(passive.position, push, strict=True))
    assert active.offset_load == pytest.approx(expected)
    assert active.active
    assert not passive.active
    for p in 5 * rng.normal(size=(4, 3)):
        moved, still = active.project(p + expected), passive.project(p)
        assert moved.point == pytest.approx(still.point + expected, abs=1e-11)
        assert moved.twist == pytest.approx(still.twist, abs=1e-11)
        forces = moved.contact_forces()
        assert forces - push == pytest.approx(still.contact_forces(), abs=1e-9)
        loads = [contact_map(r) @ f for r, f in zip(active.position, forces, strict=True)]
        assert np.sum(loads, axis=0) == pytest.approx(moved.point, abs=1e-9)


def test_a_field_of_force_has_no_friction(rng):
    push = rng.normal(size=(5, 2))
    field = ContactSet(rng.normal(size=(5, 2)), 0.0, push)
    P = field.project([0.0, 0.0, 0.0], W)
    assert P.point == pytest.approx(field.offset_load)
    assert P.twist == pytest.approx(W @ field.offset_load)
    assert np.array_equal(P.contact_forces(), push)


def test_no_contacts():
    C = ContactSet(np.empty((0, 2)), [])
    P = C.project([1.0, 2.0, 3.0], W)
    assert len(C) == 0
    assert np.array_equal(P.point, np.zeros(3))
    assert P.twist == pytest.approx(-W @ [1.0, 2.0, 3.0])
    assert P.distance == pytest.approx(np.sqrt([1, 2, 3] @ W @ [1, 2, 3]))
    assert C.project([0.0, 0.0, 0.0]).inside
    assert ContactSet([], 1.0).project([0.0, 0.0, 1.0]).distance == 1.0
    polygons = ContactSet(np.empty((0, 2)), [], sides=4)
    assert polygons.project([1.0, 2.0, 3.0]).point == pytest.approx(np.zeros(3))


def test_turned_disks_are_disks(rng):
    angle = rng.uniform(0.0, 6.0, 6)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    disks = contacts(rng)
    same = ContactSet(disks.position, disks.radius, ellipse=turn.transpose(2, 0, 1))
    for p in rng.normal(size=(5, 3)) * [[10], [5], [3], [2], [0.1]]:
        a, b = disks.project(p, W), same.project(p, W)
        e = a.point - b.point
        assert np.sqrt(e @ W @ e) <= a.error_bound + b.error_bound + 1e-14
        assert np.array_equal(a.inside, b.inside)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_wheels_that_push_along_one_line(rng, n):
    """Each a segment of loads: their sum is a zonotope, here by its vertices."""
    for _ in range(12):
        position, m = rng.normal(size=(n, 2)), rng.uniform(0.1, 1.0, n)
        angle = rng.uniform(0.0, 6.0, n)
        E = np.zeros((n, 2, 2))
        E[:, 0, 0], E[:, 1, 0] = np.cos(angle), np.sin(angle)
        C = ContactSet(position, m, ellipse=E)
        segments = np.array(
            [contact_map(r) @ e[:, 0] * k for r, e, k in zip(position, E, m, strict=True)]
        )
        signs = np.array(np.meshgrid(*[[-1, 1]] * n)).reshape(n, -1).T
        exact = VPolytope(signs @ segments)
        d = rng.normal(size=(9, 3))
        assert C.limit_surface().support(d) == pytest.approx(exact.support(d), rel=1e-12)
        for p in rng.normal(size=(3, 3)) * m.sum() * [[2], [0.5], [0.1]]:
            P, truth = C.project(p, W, throw=False), exact.project(p, W)
            e = P.point - truth.point
            assert np.sqrt(e @ W @ e) <= P.error_bound + truth.error_bound + 1e-14 * m.sum()
            assert P.error_bound <= 1e-6 * (m.sum() + np.linalg.norm(p)) * 2
            if n == 1:
                assert P.error_bound <= 1e-13 * (m.sum() + np.linalg.norm(p))


def test_polygons_tend_to_the_disks_from_inside(rng):
    disks = contacts(rng, 3, offset=rng.normal(size=(3, 2)))
    d = rng.normal(size=(400, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    missing = []
    for sides in (12, 24, 48, 96):
        C = ContactSet(disks.position, disks.radius, disks.offset, sides=sides)
        gap = disks.limit_surface().support(d) - C.limit_surface().support(d)
        assert np.all(gap >= -1e-12)
        missing.append(gap.max())
    order = np.log2(np.array(missing[:-1]) / missing[1:])
    assert order == pytest.approx(np.full(3, 2.0), abs=0.3)
    polygons = ContactSet(disks.position, disks.radius, disks.offset, sides=96)
    p = disks.offset_load + np.array([5.0, 1.0, 2.0])
    assert np.linalg.norm(polygons.project(p).point - disks.project(p).point) < 0.02
    assert polygons.project(p).distance >= disks.project(p).distance


def test_seen_from_another_point(rng):
    push, E, r = rng.normal(size=(4, 2)), rng.normal(size=(4, 2, 2)), np.array([0.7, -1.3])
    d = rng.normal(size=(20, 3))
    for more in ({}, {"ellipse": E}, {"sides": 5}):
        C = ContactSet(rng.normal(size=(4, 2)), rng.uniform(0.1, 1.0, 4), push, **more)
        there = C.seen_from(r)
        T = transport(-r)
        assert there.offset_load == pytest.approx(T @ C.offset_load)
        expected = C.limit_surface().support(d @ T)
        assert there.limit_surface().support(d) == pytest.approx(expected, rel=1e-12)
        assert there.sides == C.sides
        assert there.active


def test_one_radius_for_all_and_repr(rng):
    C = ContactSet(rng.normal(size=(3, 2)), 0.25)
    assert np.array_equal(C.radius, [0.25] * 3)
    assert repr(C) == "ContactSet(3 contacts, disks)"
    assert "active" in repr(contacts(rng, offset=np.ones((6, 2))))
    assert "5-gons" in repr(contacts(rng, sides=5))
    assert isinstance(C.limit_surface(), ContactSum)
    assert C.limit_surface() is C.limit_surface()
    assert np.array_equal(C.offset, np.zeros((3, 2)))


@pytest.mark.parametrize(
    ("argument", "given"),
    [
        ("position", {"position": [[0.0, np.nan], [0.0, 1.0]]}),
        ("position", {"position": [[0.0, 1.0, 2.0], [0.0, 1.0, 2.0]]}),
        ("position", {"position": [0.0, 1.0]}),
        ("radius", {"radius": [1.0, -1e-300]}),
        ("radius", {"radius": -1.0}),
        ("radius", {"radius": np.inf}),
        ("radius", {"radius": [1.0]}),
        ("radius", {"radius": "rough"}),
        ("offset", {"offset": [[1.0, 0.0]]}),
        ("offset", {"offset": [[1.0, 0.0], [np.nan, 0.0]]}),
        ("ellipse", {"ellipse": np.eye(2)}),
        ("ellipse", {"ellipse": np.full((2, 2, 2), np.inf)}),
        ("sides", {"sides": 2}),
        ("sides", {"sides": 4.5}),
        ("sides", {"sides": np.nan}),
        ("sides", {"sides": np.inf}),
        ("sides", {"sides": "many"}),
        ("sides", {"sides": 4, "ellipse": np.tile(np.eye(2), (2, 1, 1))}),
    ],
)
def test_bad_contacts_are_named(argument, given):
    good = {"position": [[0.0, 1.0], [0.0, 2.0]], "radius": 1.0}
    with pytest.raises(InputError) as caught:
        ContactSet(**(good | given))
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    "more", [{}, {"sides": 6}, {"ellipse": np.tile(np.diag([1.0, 0.3]), (2, 1, 1))}]
)
@pytest.mark.parametrize(
    ("argument", "given"),
    [
        ("p", {"p": [0.0, np.nan, 1.0]}),
        ("p", {"p": [0.0, np.inf, 1.0]}),
        ("p", {"p": [0.0, 1.0]}),
        ("metric", {"metric": np.diag([1.0, 1.0, 0.0])}),
        ("metric", {"metric": np.eye(2)}),
    ],
)
def test_bad_queries_are_named(more, argument, given):
    C = ContactSet([[0.0, 1.0], [0.0, 2.0]], 1.0, **more)
    with pytest.raises(InputError) as caught:
        C.project(**({"p": [1.0, 2.0, 3.0]} | given))
    assert caught.value.argument == argument
