"""Tips under a rigid part: derivatives in the twist, and the part that they move."""

import numpy as np
import pytest

from limitsurf.contacts.friction_load import friction_load
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.contacts.tip_dissipation import TipDissipation
from limitsurf.errors import InputError, SolveFailed

PHASE = np.arange(32) / 32


@pytest.fixture
def tips(rng):
    """Twelve tips, some of which rest half of the time, one always."""
    w = rng.normal(size=(12, 1)) * np.sin(2 * np.pi * PHASE) + 0.3 * np.cos(4 * np.pi * PHASE)
    w[:4, 16:] = 0.0
    w[0] = 0.0
    tips = OscillatingContact(0.4, rng.normal(size=(12, 2)), w, rng.uniform(0.1, 1, (12, 32)))
    return TipDissipation(rng.uniform(-1.0, 1.0, (12, 2)), tips, blur=0.0)


def test_sums_over_tips_and_their_derivatives(tips, rng):
    v, h = rng.normal(size=3), 1e-5
    x, y = tips.position.T
    u = np.column_stack([v[0] - v[2] * y, v[1] + v[2] * x])
    whole = tips.tips.potential(u).sum()
    rest = tips.resting.limit_surface().support(-v)
    assert tips.potential(v) + rest == pytest.approx(whole, rel=1e-14)
    for k, step in enumerate(h * np.eye(3)):
        slope = (tips.potential(v + step) - tips.potential(v - step)) / (2 * h)
        assert slope == pytest.approx(tips.gradient(v)[k], abs=1e-8)
        bend = (tips.gradient(v + step) - tips.gradient(v - step)) / (2 * h)
        assert bend == pytest.approx(tips.hessian(v)[k], abs=1e-6)


def test_at_rest_their_load_is_that_of_the_offsets(tips):
    offset = tips.tips.contact_set(tips.position).offset_load
    assert -tips.gradient(np.zeros(3)) == pytest.approx(offset, abs=1e-15)


@pytest.mark.parametrize("load", [(0.0, 0.0, 0.0), (0.5, 0.1, 0.2), (10.0, -5.0, 3.0)])
def test_the_frictional_load_meets_its_equation(tips, load):
    W = np.array([1.0, 1.0, 3.0])
    found = friction_load(tips.resting, load, W, dissipation=tips)
    assert found.net * W == pytest.approx(found.twist, abs=1e-11)
    if not found.sticks:
        v = found.twist
        power = -found.friction @ v
        assert power == pytest.approx(tips.resting.limit_surface().support(-v), rel=1e-9)


def test_a_part_on_driving_tips_reaches_their_drift():
    """All tips alike, no external load, a light part: it moves at their drift velocity."""
    w = np.interp(PHASE, [0.0, 0.1, 0.6, 0.7, 0.9, 1.0], [0.2, 1.0, 0.8, -1.5, -1.5, 0.2])
    tips = OscillatingContact(np.full(4, 0.5), [0.6, 0.8], w, 1.0)
    corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]
    d = TipDissipation(corners, tips)
    found = friction_load(d.resting, np.zeros(3), np.full(3, 1e4), dissipation=d)
    assert found.twist[:2] == pytest.approx(tips.drift_velocity[0], abs=1e-3)
    assert found.twist[2] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("mobility", [1.0, 1e2, 1e4])
@pytest.mark.parametrize("w", [[1.0, 1.0, 1.0, -3.0], [1.0, 1.0, 1.0, 1.0, -2.0, -2.0]])
def test_a_part_can_move_along_with_a_sawtooth(w, mobility):
    """At the tips' constant speed the potential has a kink; blurred it has not."""
    tips = OscillatingContact(np.full(4, 0.5), [0.6, 0.8], w, 1.0)
    d = TipDissipation([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]], tips)
    for load in (np.zeros(3), np.array([0.01, 0.0, 0.0])):
        found = friction_load(d.resting, load, np.full(3, mobility), dissipation=d)
        assert found.net == pytest.approx(found.twist / mobility, abs=1e-9)
    if mobility == 1e4:
        assert found.twist[:2] == pytest.approx(tips.drift_velocity[0], abs=2e-4)


def test_without_blur_a_kink_is_reported_not_passed_over():
    tips = OscillatingContact(np.full(4, 0.5), [0.6, 0.8], [1.0, 1.0, 1.0, -3.0], 1.0)
    d = TipDissipation([[1, 1], [1, -1], [-1, 1], [-1, -1]], tips, blur=0.0)
    with pytest.raises(SolveFailed):
        friction_load(d.resting, [0.01, 0.0, 0.0], np.full(3, 1e4), dissipation=d)


def test_blur_is_small_and_consistent(tips, rng):
    blurred = TipDissipation(tips.position, tips.tips)
    assert blurred.blur == pytest.approx(1e-6 * tips.tips.fastest)
    soft = TipDissipation(tips.position, tips.tips, blur=0.1)
    h = 1e-5
    for v in rng.normal(size=(10, 3)):
        assert blurred.gradient(v) == pytest.approx(tips.gradient(v), abs=1e-5)
        assert soft.potential(v) >= tips.potential(v)
        assert soft.potential(v) <= tips.potential(v) + 0.1 * tips.tips.passive_radius.sum()
        for k, step in enumerate(h * np.eye(3)):
            slope = (soft.potential(v + step) - soft.potential(v - step)) / (2 * h)
            assert slope == pytest.approx(soft.gradient(v)[k], abs=1e-8)
            bend = (soft.gradient(v + step) - soft.gradient(v - step)) / (2 * h)
            assert bend == pytest.approx(soft.hessian(v)[k], abs=1e-6)


def test_bad_arguments_are_named():
    tip = OscillatingContact(0.5, [1.0, 0.0], [1.0, -1.0], 1.0)
    with pytest.raises(InputError, match="tips"):
        TipDissipation([[0.0, 0.0]], tip)
    both = OscillatingContact([0.5, 0.5], [1.0, 0.0], [1.0, -1.0], 1.0)
    with pytest.raises(InputError, match="blur"):
        TipDissipation(np.zeros((2, 2)), both, blur=-1.0)
