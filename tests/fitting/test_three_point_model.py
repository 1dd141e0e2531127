"""Friction of three known feet."""

import numpy as np
import pytest
from sklearn.base import clone

from limitsurf.errors import InputError, OutsideSupports
from limitsurf.fitting.three_point_model import ThreePointModel
from limitsurf.sets.contact_sum import ContactSum

FEET = np.array([[0.06, 0.0], [-0.03, 0.05], [-0.03, -0.05]])


def pairs(radii, n=30, noise=0.0):
    rng = np.random.default_rng(0)
    v = rng.normal(size=(n, 3)) * [1.0, 1.0, 20.0]
    load = ContactSum(FEET, radii).support_point(v)
    return load * (1.0 + noise * rng.normal(size=(n, 1))), v


def test_three_frictions_come_back():
    model = ThreePointModel(FEET).fit(*pairs([1.0, 2.0, 1.5]))
    assert model.radii_ == pytest.approx([1.0, 2.0, 1.5], rel=0.01)
    assert -np.degrees(model.score(*pairs([1.0, 2.0, 1.5]))) < 0.1


def test_a_foot_without_friction_has_none():
    model = ThreePointModel(FEET).fit(*pairs([1.0, 0.0, 1.5]))
    assert model.radii_ == pytest.approx([1.0, 0.0, 1.5], abs=0.01)


def test_one_friction_is_shared_as_statics_says():
    model = ThreePointModel(FEET, one_friction=True).fit(*pairs([1.0, 1.0, 1.0], noise=0.05))
    assert model.radii_ == pytest.approx([1.0, 1.0, 1.0], rel=0.05)
    assert np.ptp(model.radii_) < 1e-12
    off = ThreePointModel(FEET + np.array([0.1, 0.0]), one_friction=True)
    with pytest.raises(OutsideSupports):
        off.fit(*pairs([1.0, 1.0, 1.0]))


def test_its_length_is_that_of_the_feet_unless_given():
    loads, twists = pairs([1.0, 2.0, 1.5])
    own, given = (ThreePointModel(FEET, rho).fit(loads, twists) for rho in (None, 0.2))
    rms = np.sqrt((FEET**2).sum(axis=1).mean())
    for model, rho in ((own, rms), (given, 0.2)):
        expected = twists * [1.0, 1.0, rho]
        expected /= np.linalg.norm(expected, axis=1, keepdims=True)
        assert model.predict(loads) == pytest.approx(expected, abs=0.02)
    assert clone(own).rho is None


def test_feet_that_are_no_three_feet_are_refused():
    with pytest.raises(InputError, match="positions"):
        ThreePointModel(FEET[:2]).fit(*pairs([1.0, 2.0, 1.5]))
    with pytest.raises(InputError, match="all the reference point"):
        ThreePointModel(np.zeros((3, 2))).fit(*pairs([1.0, 2.0, 1.5]))
