"""Slopes of loads and motions in the friction of contacts, by finite differences."""

import numpy as np
import pytest

from limitsurf.fitting import contact_slopes
from limitsurf.fitting.contact_slopes import load_slopes, motion_slopes, motions_under, unit_rows
from limitsurf.sets.contact_sum import ContactSum


@pytest.fixture
def scene(monkeypatch):
    monkeypatch.setattr(contact_slopes, "_LIFT", 1e-10)  # which bounds slopes, and so bends them
    rng = np.random.default_rng(3)
    return rng.normal(size=(12, 2)), rng.uniform(0.2, 1.0, 12), rng.normal(size=(8, 3))


def test_loads_are_the_support_points_of_the_contacts(scene):
    places, m, v = scene
    expected = ContactSum(places, m).support_point(v)
    assert load_slopes(v, places, 0.0) @ m == pytest.approx(expected)


def test_slopes_in_friction(scene):
    places, m, loads = scene
    unit, in_m, _ = motion_slopes(loads, places, m, 0.1)
    assert unit == pytest.approx(unit_rows(motions_under(loads, places, m, 0.1)))
    for k in range(3):
        step = 1e-4 * np.eye(12)[k]
        after, before = (unit_rows(motions_under(loads, places, m + s, 0.1)) for s in (step, -step))
        assert in_m[:, :, k] == pytest.approx((after - before) / 2e-4, rel=1e-3, abs=1e-4)


def test_slopes_in_the_load(scene):
    places, m, loads = scene
    _, _, in_load = motion_slopes(loads, places, m, 0.1)
    for k in range(3):
        step = 1e-4 * np.eye(3)[k]
        after, before = (unit_rows(motions_under(loads + s, places, m, 0.1)) for s in (step, -step))
        assert in_load[:, :, k] == pytest.approx((after - before) / 2e-4, rel=1e-3, abs=1e-4)


def test_no_load_no_motion(scene):
    places, m, _ = scene
    assert not motions_under(np.zeros((1, 3)), places, m).any()
