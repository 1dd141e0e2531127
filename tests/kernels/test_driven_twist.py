"""The twist of a driven part against the library's projection on a contact sum."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.friction_load import friction_load
from limitsurf.kernels.contact_problem import new_best
from limitsurf.kernels.driven_twist import driven_twist


@pytest.mark.parametrize("size", [0.2, 1.0, 3.0])
def test_twist_and_friction_are_those_of_the_closest_point(rng, size):
    best = new_best()
    for _ in range(20):
        place, radius = rng.normal(size=(12, 2)), rng.uniform(0.0, 0.2, 12)
        load, Q = size * rng.normal(size=3), np.array([2.0, 2.0, 0.7])
        out = np.empty(6)
        contacts = np.vstack([place.T, radius])
        sticks, bound = driven_twist(contacts, load, Q, 1e-12, best, out)
        answer = friction_load(ContactSet(place, radius), load, 1 / Q)
        assert sticks == answer.sticks
        assert bound < 1e-10
        assert out[3:] == pytest.approx(answer.friction, abs=1e-9)
        assert out[:3] == pytest.approx(answer.twist, abs=1e-9)
        assert sticks == (not out[:3].any())
