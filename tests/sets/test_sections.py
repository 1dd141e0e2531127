"""Sections of every specimen beside the same section as a conic program, and known ones."""

import cvxpy as cp
import numpy as np
import pytest
import shapely

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.sections import limit_curve, section
from limitsurf.sets.v_polytope import VPolytope
from tests.sets.specimens import SPECIMENS

SOLID = {name: S for name, S in SPECIMENS.items() if S.dim == 3}
CUBE = VPolytope([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])


def size_of(S):
    h = S.support(np.vstack([np.eye(3), -np.eye(3)]))
    return max(np.abs(h).max(), 1e-3)


def twin_support(S, n, c, d):
    """Return the support of the section along d in space, by Clarabel."""
    x = cp.Variable(3)
    program = cp.Problem(cp.Maximize(d @ x), [*S.constraints(x), n @ x == c])
    return program.solve(solver=cp.CLARABEL)


@pytest.mark.parametrize("name", SOLID)
def test_sections_are_those_of_the_conic_form(name, rng):
    S, size = SOLID[name], size_of(SOLID[name])
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    share = rng.uniform(0.2, 0.8)
    c = float(share * S.support(n) - (1 - share) * S.support(-n))
    cut = section(S, n, c)
    corners = cut.in_space()
    assert corners @ n == pytest.approx(np.full(len(corners), c), abs=1e-12 * size)
    assert S.contains(corners[:: max(len(corners) // 4, 1)], tol=1e-6 * size).all()
    for d in rng.normal(size=(3, 2)) @ cut.axes:
        reached, wanted = (corners @ d).max(), twin_support(S, n, c, d)
        lacking = cut.error * np.linalg.norm(d)
        assert -1e-6 * size <= wanted - reached <= lacking + 1e-6 * size


@pytest.mark.parametrize("name", SOLID)
def test_planes_that_touch_or_miss(name, rng):
    S, n = SOLID[name], rng.normal(size=3)
    top = float(S.support(n))
    touching = section(S, n, top)
    assert touching.outline.geom_type == "Point"
    expected = S.support_point(n)
    assert touching.in_space()[0] == pytest.approx(expected, abs=2e-6 * size_of(S))
    missing = section(S, n, top + 0.01 * size_of(S) * np.linalg.norm(n))
    assert missing.outline.is_empty
    assert repr(missing) == "Section(empty)"


def test_sections_of_a_cube_are_exact():
    assert section(CUBE, [0, 0, 1], 0.3).outline.area == pytest.approx(1.0, rel=1e-15)
    assert section(CUBE, [1, 1, 1], 1.5).outline.area == pytest.approx(0.75 * np.sqrt(3.0))
    assert section(CUBE, [0, 0, 1], 1.0).outline.area == pytest.approx(1.0, rel=1e-15)
    assert section(CUBE, [1, 1, 0], 0.0).outline.length == pytest.approx(1.0)
    assert section(CUBE, [1, 1, 1], 0.0).outline.geom_type == "Point"
    assert section(CUBE, [-2, 0, 0], -1.0).in_space()[:, 0] == pytest.approx([0.5] * 5)


def test_the_error_of_a_ball_is_kept_and_falls_with_the_tolerance():
    ball = Ellipsoid([0.0, 0.0, 0.0], np.eye(3))
    for tol in (1e-2, 1e-4, 1e-6):
        cut = section(ball, [0.0, 0.6, 0.8], 0.6, tol=tol)
        r = np.linalg.norm(shapely.get_coordinates(cut.outline), axis=1)
        assert r == pytest.approx(np.full(len(r), 0.8), abs=1e-12)
        assert 0.8**2 * np.pi - cut.outline.area <= 2 * np.pi * 0.8 * cut.error
        assert cut.error <= 1.6 * tol
    assert section(ball, [0, 0, 1], 1.0).outline.geom_type == "Point"


def test_a_flat_set_in_and_across_the_plane():
    disk = Ellipsoid([1.0, 2.0, 3.0], [[2.0, 0.0], [0.0, 2.0], [0.0, 0.0]])
    assert section(disk, [0, 0, 1], 3.0).outline.area == pytest.approx(4 * np.pi, rel=1e-3)
    across = section(disk, [1, 0, 0], 1.0)
    assert across.outline.geom_type == "LineString"
    assert across.outline.length == pytest.approx(4.0, rel=1e-12)
    assert across.error <= 1e-12


def test_limit_curves_of_contacts():
    """A contact off the reference point gives no force without moment but along its radius."""
    one = limit_curve(ContactSet([[1.0, 1.0]], 2.0).limit_surface())
    assert one.outline.geom_type == "LineString"
    assert one.outline.length == pytest.approx(4.0)
    square = ContactSet([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]], 0.25)
    curve = limit_curve(square.limit_surface(), tol=1e-5)
    assert curve.outline.area == pytest.approx(np.pi, abs=2 * np.pi * curve.error)
    four_sided = limit_curve(ContactSet([[0.0, 0.0]], 1.0, sides=4).limit_surface())
    assert four_sided.outline.area == pytest.approx(2.0)
    assert four_sided.error == 0.0


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"normal": [0, 0, 0]}, "normal"),
        ({"normal": [0, 1]}, "normal"),
        ({"offset": np.nan}, "offset"),
        ({"tol": 0.0}, "tol"),
        ({"axes": [[1, 0, 0], [0, 0, 1]]}, "axes"),
        ({"surface": SPECIMENS["ellipse"]}, "surface"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    with pytest.raises(InputError) as found:
        section(**({"surface": CUBE, "normal": [0.0, 0.0, 1.0]} | changed))
    assert found.value.argument == argument
