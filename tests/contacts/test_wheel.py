"""Wheels and soft contacts: the paper's Figure 7, and what other contacts they agree with."""

import numpy as np
import pytest
import shapely

from limitsurf.contacts.coulomb import coulomb_contact, elliptic_contact
from limitsurf.contacts.friction_load import friction_load
from limitsurf.contacts.soft_contact import SoftContact
from limitsurf.contacts.wheel import Wheel
from limitsurf.errors import InputError
from limitsurf.sets.minkowski_sum import MinkowskiSum

GIVEN = {
    "position": [0.0, 0.0],
    "direction": [0.0, 2.0],
    "radius": 0.01,
    "normal_force": 2.0,
    "mu": 0.5,
    "bearing_friction": 0.1,
}


def test_the_limit_curve_is_long_and_narrow():
    """Figure 7a: bearing friction along the rolling direction, traction across."""
    curve = Wheel(**GIVEN).limit_curve()
    assert shapely.bounds(curve.outline) == pytest.approx([-1.0, -0.1, 1.0, 0.1], abs=2e-4)
    assert curve.outline.area == pytest.approx(np.pi * 0.1, rel=1e-3)


@pytest.mark.parametrize("torque", [0.0005, 0.004, 0.009, -0.004])
def test_a_torque_shifts_the_curve(torque):
    """Figure 7b: by tau/r; the nearest load is that less the bearing friction."""
    wheel = Wheel(**GIVEN, torque=torque)
    passive, shifted = Wheel(**GIVEN).limit_curve().outline, wheel.limit_curve().outline
    shift = np.array([0.0, torque / 0.01])
    moved = shapely.transform(passive, lambda p: p + shift)
    assert shapely.hausdorff_distance(moved, shifted) < 1e-3
    nearest = wheel.limit_surface().project(np.zeros(3)).point
    push = np.sign(torque) * max(abs(torque) / 0.01 - 0.1, 0.0)
    assert nearest == pytest.approx([0.0, push, 0.0], abs=1e-12)


def test_the_shift_is_capped_by_traction():
    for torque in (0.01, 0.5):
        wheel = Wheel(**GIVEN, torque=torque)
        assert wheel.drive == pytest.approx([0.0, 1.0])
        nearest = wheel.limit_surface().project(np.zeros(3)).point
        assert nearest == pytest.approx([0.0, 0.9, 0.0])


def test_a_driven_cart_accelerates_along_its_wheels():
    wheels = [Wheel(**(GIVEN | {"position": p}), torque=0.004) for p in ([0.1, 0.0], [-0.1, 0.0])]
    surface = MinkowskiSum(*[w.limit_surface() for w in wheels])
    found = friction_load(surface, np.zeros(3))
    assert found.net == pytest.approx([0.0, 0.6, 0.0], abs=1e-5)  # a conic solve
    assert not found.sticks
    parked = MinkowskiSum(
        *[Wheel(**(GIVEN | {"position": w.position})).limit_surface() for w in wheels]
    )
    assert friction_load(parked, [1.5, 0.0, 0.0]).sticks
    assert friction_load(parked, [1.5, 0.0, 0.0], np.ones(3)).net == pytest.approx([0.0] * 3)
    assert not friction_load(parked, [0.0, 0.25, 0.0]).sticks


def test_a_wheel_as_a_contact_set_has_the_same_limit_surface(rng):
    d = rng.normal(size=(50, 3))
    for changed in ({}, {"torque": 0.004}, {"bearing_friction": 0.0}, {"mu": 0.0}):
        wheel = Wheel(**(GIVEN | {"position": [0.3, -0.2], "direction": [3.0, 1.0]} | changed))
        found = wheel.contact_set().limit_surface().support(d)
        assert found == pytest.approx(wheel.limit_surface().support(d), abs=1e-14)


def test_a_blocked_wheel_is_a_coulomb_contact(rng):
    d = rng.normal(size=(50, 3))
    wheel = Wheel(**(GIVEN | {"position": [0.3, -0.2], "bearing_friction": 7.0}))
    assert wheel.limit_surface().support(d) == pytest.approx(
        coulomb_contact([0.3, -0.2], 1.0).support(d)
    )
    passive = Wheel(**GIVEN).limit_surface().support(d)
    assert passive == pytest.approx(elliptic_contact([0, 0], [0.1, 1.0], [0, 1]).support(d))


def test_a_soft_contact_adds_spin_torque(rng):
    soft = SoftContact([0.5, 1.0], 2.0, 0.5, 0.3)
    assert soft.limit_surface().support([1.0, -0.5, 1.0]) == pytest.approx(0.3)  # spin alone
    assert soft.limit_curve().outline.area == pytest.approx(np.pi, rel=1e-3)
    d = rng.normal(size=(50, 3))
    hard = SoftContact([0.5, 1.0], 2.0, 0.5, 0.0).limit_surface().support(d)
    assert hard == pytest.approx(coulomb_contact([0.5, 1.0], 1.0).support(d))
    assert (soft.limit_surface().support(d) >= hard).all()


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"direction": [0, 0]}, "direction"),
        ({"radius": 0.0}, "radius"),
        ({"normal_force": -1.0}, "normal_force"),
        ({"mu": np.nan}, "mu"),
        ({"bearing_friction": -0.1}, "bearing_friction"),
        ({"torque": np.inf}, "torque"),
        ({"position": [0, 0, 0]}, "position"),
    ],
)
def test_bad_wheels_are_named(changed, argument):
    with pytest.raises(InputError) as found:
        Wheel(**(GIVEN | changed))
    assert found.value.argument == argument


def test_bad_soft_and_elliptic_contacts_are_named():
    for args, argument in (
        (([0, 0], -1.0, 0.5, 0.1), "normal_force"),
        (([0, 0], 1.0, -0.5, 0.1), "mu"),
        (([0, 0], 1.0, 0.5, np.nan), "spin_torque"),
    ):
        with pytest.raises(InputError) as found:
            SoftContact(*args)
        assert found.value.argument == argument
    with pytest.raises(InputError, match="half_axes"):
        elliptic_contact([0, 0], [1.0, -1.0])
    with pytest.raises(InputError, match="direction"):
        elliptic_contact([0, 0], [1.0, 1.0], [0.0, 0.0])
