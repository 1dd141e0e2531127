"""Offset and friction of one actuator, from pushes on a part over many."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.fitting.actuator_model import ActuatorModel

TIPS = np.stack(np.meshgrid(*[np.linspace(-1e-3, 1e-3, 5)] * 2), axis=-1).reshape(-1, 2)  # m
HEADINGS = np.linspace(0.0, 3.0, 25)
OFFSET, RADIUS, RHO = np.array([2e-8, -5e-9]), 6e-8, 7e-4  # N, N, m


def pushes(n, noise, seed=0):
    """Return loads and motions of a part over the driven array, with noise in both."""
    c, s = np.cos(HEADINGS), np.sin(HEADINGS)
    offsets = np.column_stack([c * OFFSET[0] - s * OFFSET[1], s * OFFSET[0] + c * OFFSET[1]])
    surface = ContactSet(TIPS, RADIUS, offsets).limit_surface()
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(n, 3)) / [1.0, 1.0, RHO]
    errors = noise * rng.normal(size=(2, n, 3))
    loads = -surface.support_point(-v) + errors[0] * len(TIPS) * RADIUS * [1.0, 1.0, RHO]
    return loads, v + errors[1] / [1.0, 1.0, RHO], surface


def test_exact_pushes_give_offset_and_friction():
    loads, v, surface = pushes(20, 0.0)
    model = ActuatorModel(TIPS, HEADINGS, RHO).fit(loads, v)
    assert model.offset_ == pytest.approx(OFFSET, rel=1e-4)
    assert model.radius_ == pytest.approx(RADIUS, rel=1e-4)
    assert model.surface_.support(v) == pytest.approx(surface.support(v), rel=1e-4)
    assert -np.degrees(model.score(loads, v)) < 0.05


def test_errors_grow_with_noise_and_fall_with_pushes():
    def error(n, noise):
        found = [
            ActuatorModel(TIPS, HEADINGS, RHO).fit(*pushes(n, noise, s)[:2]) for s in range(20)
        ]
        return np.mean([np.linalg.norm(model.offset_ - OFFSET) / RADIUS for model in found])

    assert error(30, 0.01) == pytest.approx(error(30, 0.1) / 10.0, rel=0.5)
    assert error(120, 0.1) == pytest.approx(error(30, 0.1) / 2.0, rel=0.5)
    assert error(30, 0.01) < 0.02


def test_headings_matter():
    loads, v, _ = pushes(20, 0.0)
    blind = ActuatorModel(TIPS, rho=RHO).fit(loads, v)
    assert np.linalg.norm(blind.offset_ - OFFSET) > 0.2 * np.linalg.norm(OFFSET)


def test_bad_arguments_are_refused():
    loads, v, _ = pushes(5, 0.0)
    for options, name in (
        ({"positions": np.empty((0, 2))}, "positions"),
        ({"positions": TIPS, "headings": [0.0]}, "headings"),
        ({"positions": TIPS, "huber": -1.0}, "huber"),
    ):
        with pytest.raises(InputError, match=name):
            ActuatorModel(rho=RHO, **options).fit(loads, v)
