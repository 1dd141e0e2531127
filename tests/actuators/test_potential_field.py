"""Sums of fields, and what fields say about themselves: convexity, flat directions, bounds."""

import numpy as np
import pytest

from limitsurf.actuators.density_field import DensityField
from limitsurf.actuators.density_piece import DensityPiece
from limitsurf.actuators.potential_field import ConvexField, FieldSum
from limitsurf.actuators.radial_density import RadialField
from limitsurf.errors import InputError
from tests.actuators.test_density_field import parts, star

K = np.array([[2.0, 0.3], [0.3, 1.0]])
FIELDS = {
    "uniform": DensityField.uniform(0.4, 2.0),
    "squeeze": DensityField.squeeze(0.3, 2.0, 0.1),
    "elliptic": DensityField.linear(K, [1.0, 2.0]),
    "isotropic": DensityField.linear(0.7, [-1.0, 0.3]),
    "radial": RadialField(1.5, [0.2, -0.4]),
    "feeder": RadialField(1.5, [0.2, -0.4]) + DensityField.uniform(0.4, 0.3),
    "sum": DensityField.squeeze(0.3, 2.0, 0.1) + RadialField(1.0) + DensityField.linear(K),
}


def test_sums_add_everything(rng):
    part, q = star(rng, 9), rng.normal(size=(4, 3))
    for one, two in (("squeeze", "radial"), ("feeder", "elliptic"), ("uniform", "sum")):
        a, b = FIELDS[one], FIELDS[two]
        total = a + b
        assert total.load(part, q) == pytest.approx(a.load(part, q) + b.load(part, q))
        assert total.jacobian(part, q) == pytest.approx(a.jacobian(part, q) + b.jacobian(part, q))
        expected = a.potential(part, q) + b.potential(part, q)
        assert total.potential(part, q) == pytest.approx(expected)
        assert total(q[:, :2]) == pytest.approx(a(q[:, :2]) + b(q[:, :2]))
        assert total.scaled(2.0).load(part, q) == pytest.approx(2.0 * total.load(part, q))
        assert all(not isinstance(term, FieldSum) for term in total.fields)
        assert total.has_potential
        assert isinstance(total, ConvexField)
    assert "RadialField" in repr(FIELDS["feeder"])


def test_a_sum_with_a_skew_has_no_potential(rng):
    field = RadialField(1.0) + DensityField.skewed_squeeze(0.0, 0.1, 1.0)
    assert not field.has_potential
    assert not field.convex
    with pytest.raises(InputError, match="no potential"):
        field.potential(star(rng, 5), np.zeros(3))


def test_sums_of_something_else_are_refused():
    with pytest.raises(InputError) as found:
        FieldSum(RadialField(1.0), "wind")
    assert found.value.argument == "fields"
    with pytest.raises(InputError):
        FieldSum()


@pytest.mark.parametrize("name", FIELDS)
def test_convex_fields_are_convex_in_position(name, rng):
    """Midpoints lie below chords, at any orientation."""
    field = FIELDS[name]
    assert field.convex
    for part in parts(rng):
        p = rng.normal(size=(200, 3)) * [2.0, 2.0, 3.0]
        q = np.column_stack([2.0 * rng.normal(size=(200, 2)), p[:, 2]])
        ends = 0.5 * (field.potential(part, p) + field.potential(part, q))
        middle = field.potential(part, 0.5 * (p + q))
        assert (middle <= ends + 1e-11 * (1.0 + np.abs(ends))).all()


def test_fields_that_are_not_convex_do_not_say_so():
    A = np.diag([1.0, -0.1])
    wedge = DensityPiece([0.0, 1.0], normals=[[0, 1], [1, 0]], bounds=[0.0, 0.0], level=0.0)
    for field in (
        DensityField.linear(A),
        DensityField.squeeze(0.3, -1.0),
        DensityField.skewed_squeeze(0.3, 0.1, 1.0),
        DensityField([wedge, wedge]),
        DensityField([wedge]),
        DensityField([*DensityField.squeeze(0.3, 1.0).pieces[:1], wedge]),
        RadialField(1.0) + DensityField.linear(A),
    ):
        assert not field.convex


@pytest.mark.parametrize("name", FIELDS)
def test_nothing_changes_along_flat_directions(name, rng):
    field, part = FIELDS[name], star(rng, 9)
    assert len(field.flat) == {"uniform": 2, "squeeze": 1}.get(name, 0)
    for way in field.flat:
        q = rng.normal(size=(20, 3))
        shifted = q + 3.0 * np.array([*way, 0.0])
        assert field.load(part, shifted) == pytest.approx(field.load(part, q), abs=1e-12)


def second_turn(field, part, q, center, h=1e-3):
    """Return the second derivative of the potential under turns about a point."""
    turned = []
    for angle in (-h, 0.0, h):
        c, s = np.cos(angle), np.sin(angle)
        arm = (q[:, :2] - center) @ np.array([[c, s], [-s, c]])
        turned.append(field.potential(part, np.column_stack([center + arm, q[:, 2] + angle])))
    return (turned[0] - 2.0 * turned[1] + turned[2]) / h**2


@pytest.mark.parametrize("name", FIELDS)
def test_turning_bounds_hold(name, rng):
    """About fixed points, and about the centre of mass: minus the last entry of the Jacobian."""
    field = FIELDS[name]
    for part in parts(rng):
        for center in (np.zeros(2), np.array([0.2, -0.4]), np.array([1.0, 2.0])):
            for reach in (0.1, 2.0):
                way = rng.normal(size=(300, 2))
                way *= reach * rng.uniform(size=(300, 1)) / np.hypot(*way.T)[:, None]
                q = np.column_stack([center + way, rng.uniform(0.0, 6.3, 300)])
                bound = field.turning_bound(part, center, reach)
                noise = 1e-8 * np.abs(field.potential(part, q)).max()  # rounding over h^2
                assert second_turn(field, part, q, center).max() <= bound + noise
        q = rng.normal(size=(300, 3)) * [2.0, 2.0, 3.0]
        curvature = -field.jacobian(part, q)[:, 2, 2]
        assert curvature.max() <= field.turning_bound(part, None, 0.0) * (1.0 + 1e-12) + 1e-12


def test_a_radial_field_does_not_turn_a_part_about_its_center():
    radial = RadialField(1.0, [0.2, -0.4])
    assert radial.turning_bound(star(np.random.default_rng(1), 5), [0.2, -0.4], 3.0) == 0.0


def test_slopes_within_borders_have_no_known_bound(rng):
    piece = DensityPiece([0, 1.0], -np.eye(2), normals=[[0, 1]], bounds=[0.0], level=0.0)
    assert DensityField([piece]).turning_bound(star(rng, 5), [0.0, 0.0], 1.0) == np.inf


def test_centers_lie_on_the_borders():
    squeeze = DensityField.squeeze(0.3, 1.0, 0.7)
    n = np.array([-np.sin(0.3), np.cos(0.3)])
    assert squeeze.centers @ n == pytest.approx(np.full(len(squeeze.centers), 0.7))
    away = DensityField([DensityPiece([0, -1], normals=[[0, -1]], bounds=[-2.0], level=0.0)])
    assert away.centers == pytest.approx(np.array([[0.0, 2.0]]))
    assert DensityField.uniform(0.3, 1.0).centers.shape == (0, 2)
    assert DensityField.linear(1.0, [1.0, 2.0]).centers == pytest.approx(np.array([[1.0, 2.0]]))
