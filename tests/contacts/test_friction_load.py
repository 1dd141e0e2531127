"""Frictional loads: signs, sticking, any convex set, and rate-dependent contacts."""

import numpy as np
import pytest
from scipy.optimize import minimize

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.friction_load import friction_load
from limitsurf.errors import InputError, SolveFailed
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.v_polytope import VPolytope

W = np.array([[1.0, 0.2, 0.1], [0.2, 2.0, -0.3], [0.1, -0.3, 0.7]])
BLOCK = ContactSet([[0.1, 0.1], [0.1, -0.1], [-0.1, 0.1], [-0.1, -0.1]], 0.5)


def surfaces(rng):
    return {
        "contacts": ContactSet(rng.normal(size=(8, 2)), rng.uniform(0.1, 0.5, 8)),
        "active contacts": ContactSet(
            rng.normal(size=(8, 2)), rng.uniform(0.1, 0.5, 8), rng.normal(size=(8, 2))
        ),
        "ellipsoid": Ellipsoid(np.zeros(3), np.diag([1.0, 0.8, 0.5])),
        "polytope": VPolytope(rng.normal(size=(30, 3))),
    }


def limit(surface):
    return surface.limit_surface() if isinstance(surface, ContactSet) else surface


@pytest.mark.parametrize("name", surfaces(np.random.default_rng(0)))
def test_signs(rng, name):
    """Net load, twist and friction of section 1 of the conventions: minus v is an outer normal."""
    surface = surfaces(rng)[name]
    for F in rng.normal(size=(8, 3)) * 20:
        load = friction_load(surface, F, W)
        assert not load.sticks
        assert load.net == pytest.approx(F + load.friction)
        assert load.twist == pytest.approx(W @ load.net, abs=1e-10)
        power = -load.twist @ load.friction  # dissipated
        assert power == pytest.approx(limit(surface).support(-load.twist), rel=1e-9)
        assert load.projection.point == pytest.approx(load.friction)
        assert load.rate is None


def test_friction_opposes_the_motion():
    slides = friction_load(BLOCK, [3.0, 0.0, 0.0])
    assert slides.friction == pytest.approx([-2.0, 0.0, 0.0])
    assert slides.twist == pytest.approx([1.0, 0.0, 0.0])
    turns = friction_load(BLOCK, [0.0, 0.0, 1.0])
    assert turns.friction[2] == pytest.approx(-2 * 0.1 * np.sqrt(2))
    assert turns.twist[2] > 0


@pytest.mark.parametrize("name", surfaces(np.random.default_rng(0)))
def test_it_sticks_iff_minus_the_load_is_in_the_set(rng, name):
    surface = surfaces(rng)[name]
    inner = limit(surface).support_point(rng.normal(size=(5, 3)))
    held = friction_load(surface, -(rng.dirichlet(np.ones(5)) * 0.999 + 0.0002) @ inner)
    assert held.sticks
    assert np.array_equal(held.net, np.zeros(3))
    assert np.array_equal(held.twist, np.zeros(3))
    edge = limit(surface).support_point([1.0, 0.3, 0.2])
    assert not friction_load(surface, -1.001 * edge - [1.0, 0.3, 0.2]).sticks


def test_no_load_and_active_contacts():
    """The paper's motion prediction: driven by the point of L nearest to the origin."""
    driven = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.1, [[1.0, 0.0], [1.0, 0.0]])
    load = friction_load(driven, np.zeros(3))
    assert load.friction == pytest.approx([1.8, 0.0, 0.0])
    assert load.twist == pytest.approx([1.8, 0.0, 0.0])


def test_batches(rng):
    loads = rng.normal(size=(4, 5, 3)) * 2
    together = friction_load(BLOCK, loads, W)
    assert together.friction.shape == together.net.shape == (4, 5, 3)
    assert together.sticks.shape == (4, 5)
    assert 0 < together.sticks.sum() < 20
    for i, j in np.ndindex(4, 5):
        one = friction_load(BLOCK, loads[i, j], W)
        assert np.array_equal(one.friction, together.friction[i, j])
        assert np.array_equal(one.net, together.net[i, j])
        assert one.sticks == together.sticks[i, j]
    assert repr(together) == f"FrictionLoad(20 loads, {int(together.sticks.sum())} stick)"
    assert "slides" in repr(friction_load(BLOCK, [5.0, 0.0, 0.0]))


def test_one_contact_sticks_under_a_load_at_the_contact():
    peg = ContactSet([[0.3, 0.7]], 1.0)
    f = np.array([0.1, 0.2])
    assert friction_load(peg, [*f, 0.3 * f[1] - 0.7 * f[0]]).sticks
    assert not friction_load(peg, [*f, 0.5]).sticks


class Viscous:
    def __init__(self, D):
        self.D = np.asarray(D)

    def potential(self, v):
        return 0.5 * v @ self.D @ v

    def gradient(self, v):
        return self.D @ v

    def hessian(self, v):
        return self.D


class Smooth:
    """``sum k sqrt(|A v|^2 + e^2)``, and an offset that drives."""

    def __init__(self, rng):
        self.A, self.k, self.e = rng.normal(size=(5, 3)), rng.uniform(0.1, 1.0, 5), 0.3
        self.drive = rng.normal(size=3)

    def potential(self, v):
        return self.k @ np.sqrt((self.A @ v) ** 2 + self.e**2) - self.drive @ v

    def gradient(self, v):
        u = self.A @ v
        return self.A.T @ (self.k * u / np.sqrt(u**2 + self.e**2)) - self.drive

    def hessian(self, v):
        u = self.A @ v
        return (self.A.T * (self.k * self.e**2 / (u**2 + self.e**2) ** 1.5)) @ self.A


@pytest.mark.parametrize("name", surfaces(np.random.default_rng(0)))
def test_viscous_drag_is_another_metric(rng, name):
    surface = surfaces(rng)[name]
    D = np.diag([0.5, 0.5, 2.0])
    both = np.linalg.inv(np.linalg.inv(W) + D)
    for F in rng.normal(size=(6, 3)) * 4:
        load = friction_load(surface, F, W, dissipation=Viscous(D))
        exact = limit(surface).project(-F, both)
        assert load.friction == pytest.approx(exact.point, abs=1e-10)
        assert load.twist == pytest.approx(exact.twist, abs=1e-10)
        assert load.rate == pytest.approx(-D @ load.twist, abs=1e-10)
        assert load.net == pytest.approx(F + load.friction + load.rate, abs=1e-10)
        assert load.net == pytest.approx(np.linalg.solve(W, load.twist), abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_nonlinear_drag(seed):
    rng = np.random.default_rng(seed)
    surface = surfaces(rng)["contacts"]
    smooth, F = Smooth(rng), 3 * rng.normal(size=3)
    load = friction_load(surface, F, W, dissipation=smooth)
    v, Q = load.twist, np.linalg.inv(W)

    def value(v):
        own = 0.5 * v @ Q @ v + smooth.potential(v) - F @ v
        return own + float(limit(surface).support(-v))

    slow = minimize(
        value,
        v + 0.1 * rng.normal(size=3),
        method="Nelder-Mead",
        tol=1e-12,
        options={"maxiter": 5000, "maxfev": 5000},
    )
    assert value(v) <= slow.fun + 1e-9
    assert slow.x == pytest.approx(v, abs=1e-4)
    assert load.net == pytest.approx(Q @ v, abs=1e-9)
    assert load.rate == pytest.approx(-smooth.gradient(v), abs=1e-12)
    assert -v @ load.friction == pytest.approx(limit(surface).support(-v), abs=1e-9)


def test_a_drive_that_is_too_weak_does_not_move_the_part(rng):
    smooth = Smooth(rng)
    smooth.drive = np.array([0.1, 0.0, 0.0])
    load = friction_load(BLOCK, [0.2, 0.0, 0.0], W, dissipation=smooth)
    assert load.sticks
    assert np.array_equal(load.twist, np.zeros(3))
    assert load.rate == pytest.approx([0.1, 0.0, 0.0])
    assert load.friction == pytest.approx([-0.3, 0.0, 0.0])
    assert load.net == pytest.approx(np.zeros(3), abs=1e-12)


def test_a_dissipation_that_is_not_convex_is_refused():
    class Hill(Viscous):
        def hessian(self, v):
            return np.eye(3)

    with pytest.raises((SolveFailed, InputError)):
        friction_load(BLOCK, [5.0, 1.0, 0.5], dissipation=Hill(-3 * np.eye(3)))
    with pytest.raises((SolveFailed, InputError)):
        friction_load(BLOCK, [5.0, 1.0, 0.5], dissipation=Viscous(-3 * np.eye(3)))


@pytest.mark.parametrize(
    ("argument", "external", "metric", "dissipation"),
    [
        ("external", [0.0, 1.0], None, None),
        ("external", [0.0, 1.0, np.nan], None, None),
        ("external", [[0.0, 1.0, np.inf]], None, None),
        ("external", "push", None, None),
        ("external", [[0.0, 1.0, 2.0]], None, Viscous(np.eye(3))),
        ("external", [0.0, 1.0, np.nan], None, Viscous(np.eye(3))),
        ("metric", [0.0, 1.0, 2.0], -np.eye(3), None),
        ("metric", [0.0, 1.0, 2.0], np.eye(2), Viscous(np.eye(3))),
    ],
)
def test_bad_arguments_are_named(argument, external, metric, dissipation):
    with pytest.raises(InputError) as caught:
        friction_load(BLOCK, external, metric, dissipation=dissipation)
    assert caught.value.argument == argument
