"""Flat ellipsoids of loads are contacts: sums of them are solved as such."""

import numpy as np
import pytest

from limitsurf.sets.contact_sum import ContactSum
from limitsurf.sets.contact_terms import sum_of_contacts
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.minkowski_sum import MinkowskiSum
from tests.sets.specimens import box, contact

MAP = {
    "disk": np.array([[1.0, 0.0], [0.0, 1.0], [0.4, -0.7]]),
    "ellipse": np.array([[2.0, 0.3], [0.1, 0.5], [0.4, 0.3]]),
    "three axes": np.array([[1.0, 0.0], [0.0, 1.0], [-1.4, 0.5]]) @ [[1, 0.2, 0.5], [0, 1, -1]],
    "segment": np.array([[1.0], [2.0], [-1.0]]),
    "point": np.empty((3, 0)),
}


@pytest.mark.parametrize("name", MAP)
def test_a_flat_ellipsoid_is_a_contact(name, rng):
    ellipsoid = Ellipsoid(rng.normal(size=3), MAP[name])
    same = sum_of_contacts([ellipsoid])
    assert isinstance(same, ContactSum)
    d = rng.normal(size=(50, 3))
    assert same.support(d) == pytest.approx(ellipsoid.support(d), abs=1e-13)
    p = 4 * rng.normal(size=(20, 3))
    assert same.project(p).point == pytest.approx(ellipsoid.project(p).point, abs=1e-11)


@pytest.mark.parametrize("moment", [[-1.4, 0.5], [0.4, -0.7]])
def test_sums_are_the_conic_twins_and_certified(rng, moment):
    """Several contacts stand still at once; with the second moment two share their place."""
    axes = {**MAP, "three axes": np.vstack([MAP["three axes"][:2], moment @ MAP["three axes"][:2]])}
    total = MinkowskiSum(*[Ellipsoid(rng.normal(size=3), A) for A in axes.values()], contact(1, 2))
    assert isinstance(total.closed_form, ContactSum)
    p = 6 * rng.normal(size=(20, 3))
    projection = total.project(p)
    twin = np.array([ConvexSet.distance(SlowSum(total), q) for q in p])
    assert projection.distance == pytest.approx(twin, abs=1e-6)
    assert projection.error_bound.max() <= 1e-10
    assert total.support(p - projection.point) == pytest.approx(
        np.einsum("ij,ij->i", p - projection.point, projection.point), abs=1e-9
    )


class SlowSum(ConvexSet):
    """A sum that knows only its conic form."""

    def __init__(self, total):
        self._total = total

    dim = 3

    def conic_form(self):
        return self._total.conic_form()

    def face(self, d, tol=1e-9):
        raise NotImplementedError


def test_what_is_no_contact(rng):
    ball = Ellipsoid([0, 0, 0], np.eye(3))
    upright = Ellipsoid([0, 0, 0], [[1, 0], [0, 0], [0, 1]])  # a plane with the moment axis
    for term in (ball, upright, box(1, 1, 1)):
        assert sum_of_contacts([contact(0, 0), term]) is None
    assert sum_of_contacts([contact(0, 0), contact(1, 0)]).stretch is None
