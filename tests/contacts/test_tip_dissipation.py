"""Tips under a rigid part: derivatives in the twist, and the part that they move."""

import numpy as np
import pytest

from limitsurf.contacts.friction_load import friction_load
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.contacts.tip_dissipation import TipDissipation
from limitsurf.errors import InputError

PHASE = np.arange(32) / 32


@pytest.fixture
def tips(rng):
    """Twelve tips, some of which rest half of the time, one always."""
    w = rng.normal(size=(12, 1)) * np.sin(2 * np.pi * PHASE) + 0.3 * np.cos(4 * np.pi * PHASE)
    w[:4, 16:] = 0.0
    w[0] = 0.0
    tips = OscillatingContact(0.4, rng.normal(size=(12, 2)), w, rng.uniform(0.1, 1, (12, 32)))
    return TipDissipation(rng.uniform(-1.0, 1.0, (12, 2)), tips)


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


def test_the_number_of_tips_must_fit():
    tip = OscillatingContact(0.5, [1.0, 0.0], [1.0, -1.0], 1.0)
    with pytest.raises(InputError, match="tips"):
        TipDissipation([[0.0, 0.0]], tip)
