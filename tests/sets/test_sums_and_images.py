"""Sums and images: algebra of support functions, equivalent representations."""

import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.linear_image import LinearImage, transport
from limitsurf.sets.minkowski_sum import MinkowskiSum
from limitsurf.sets.v_polytope import VPolytope
from limitsurf.sets.zonotope import Zonotope
from tests.sets.specimens import SPECIMENS, box, contact, polygon_contact

THREE_D = {name: S for name, S in SPECIMENS.items() if S.dim == 3}


@pytest.mark.parametrize("name", THREE_D)
def test_sums_commute_and_support_functions_add(name, rng):
    S, T = THREE_D[name], contact(0.3, 0.7)
    d = rng.normal(size=(10, 3))
    both, reverse = MinkowskiSum(S, T), MinkowskiSum(T, S)
    assert both.support(d) == pytest.approx(S.support(d) + T.support(d))
    assert both.support(d) == pytest.approx(reverse.support(d))
    p = both.support_point(d) + d
    assert both.distance(p) == pytest.approx(reverse.distance(p), abs=1e-6)


def test_sums_of_balls_are_balls(rng):
    ball = Ellipsoid([1.0, 0.0, 0.0], np.eye(3))
    total, big = MinkowskiSum(ball, ball, ball), Ellipsoid([3.0, 0.0, 0.0], 3 * np.eye(3))
    p = 8 * rng.normal(size=(5, 3))
    assert total.project(p).point == pytest.approx(big.project(p).point, abs=1e-4)
    assert total.distance(p) == pytest.approx(big.distance(p), abs=1e-6)


def test_sums_of_polytopes_are_explicit(rng):
    A, B = VPolytope(rng.normal(size=(15, 3))), box(0.5, 0.3, 0.2)
    total = MinkowskiSum(A, B)
    slow = VPolytope((A.vertices[:, None] + B.to_v().vertices[None]).reshape(-1, 3))
    assert isinstance(total.explicit, VPolytope)
    d = rng.normal(size=(300, 3))
    assert total.explicit.support(d) == pytest.approx(slow.support(d), abs=1e-12)
    p = 4 * rng.normal(size=(30, 3))
    assert total.project(p).point == pytest.approx(slow.project(p).point, abs=1e-12)


def test_zonotopes_are_sums_of_segments(rng):
    generators = rng.normal(size=(6, 3))
    Z = Zonotope([0, 0, 0], generators)
    segments = MinkowskiSum(*[VPolytope([-g, g]) for g in generators])
    p = 6 * rng.normal(size=(20, 3))
    assert Z.project(p).point == pytest.approx(segments.project(p).point, abs=1e-10)


def test_sums_with_a_set_that_is_no_polytope_stay_implicit():
    assert MinkowskiSum(box(1, 1, 1), contact(0.0, 0.0)).explicit is None


def test_the_polygonal_bar_tends_to_the_bar(rng):
    """The error falls with the square of the number of sides."""
    bar = MinkowskiSum(contact(1.0, 0.0), contact(-1.0, 0.0))
    d = rng.normal(size=(4000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    errors = []
    for sides in (8, 32, 128):
        polygonal = MinkowskiSum(
            polygon_contact(1.0, 0.0, sides), polygon_contact(-1.0, 0.0, sides)
        )
        errors.append(np.abs(polygonal.support(d) - bar.support(d)).max())
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(16.0, rel=0.1)


@pytest.mark.parametrize("name", THREE_D)
def test_images_map_support_functions_and_compose(name, rng):
    S = THREE_D[name]
    M, N = rng.normal(size=(3, 3)), rng.normal(size=(2, 3))
    c = rng.normal(size=3)
    once = LinearImage(M, S, c)
    d = rng.normal(size=(8, 3))
    assert once.support(d) == pytest.approx(S.support(d @ M) + d @ c, rel=1e-9, abs=1e-9)
    twice, direct = LinearImage(N, once), LinearImage(N @ M, S, N @ c)
    d = rng.normal(size=(8, 2))
    assert twice.support(d) == pytest.approx(direct.support(d), rel=1e-9, abs=1e-9)


def test_transport_there_and_back(rng):
    S = polygon_contact(0.3, 0.2)
    there_and_back = LinearImage(transport([1, 2]), LinearImage(transport([-1, -2]), S))
    p = 2 * rng.normal(size=(10, 3))
    assert there_and_back.project(p).point == pytest.approx(S.project(p).point, abs=1e-12)


def test_bad_arguments():
    with pytest.raises(InputError, match="sets: are missing"):
        MinkowskiSum()
    with pytest.raises(InputError, match=r"different dimensions \[3, 2\]"):
        MinkowskiSum(contact(0, 0), Ellipsoid([0, 0], np.eye(2)))
    with pytest.raises(InputError, match="matrix: has shape"):
        LinearImage(np.eye(2), contact(0, 0))
    with pytest.raises(InputError, match="offset: has shape"):
        LinearImage(np.eye(3), contact(0, 0), [1.0])
    with pytest.raises(InputError, match="r: has shape"):
        transport([1, 2, 3])


def test_adding_contacts_one_by_one_is_the_sum_of_all(rng):
    """The paper's cell update: an explicit surface plus one more contact."""
    contacts = [polygon_contact(*rng.normal(size=2)) for _ in range(5)]
    total = contacts[0]
    for one in contacts[1:]:
        total = MinkowskiSum(total, one).explicit
    at_once = MinkowskiSum(*contacts).explicit
    d = rng.normal(size=(200, 3))
    assert total.support(d) == pytest.approx(at_once.support(d), abs=1e-11)
    assert total.support(d) == pytest.approx(sum(c.support(d) for c in contacts), abs=1e-11)
    p = 10 * rng.normal(size=(20, 3))
    assert total.project(p).point == pytest.approx(at_once.project(p).point, abs=1e-10)
