"""The conic twin itself: answers in closed form, and the optimality conditions."""

import numpy as np
import pytest

from limitsurf.conic.contact_sum import closest_contact_load


def test_one_disk_at_the_origin():
    load = closest_contact_load([(0, 0)], [2.0], [3.0, 4.0, 0.5])
    assert load == pytest.approx([1.2, 1.6, 0.0], abs=1e-6)


def test_a_couple_of_contacts():
    """Two contacts at (+-1, 0): the moment is bounded by the sum of the radii."""
    load = closest_contact_load([(1, 0), (-1, 0)], [0.5, 0.5], [0.0, 0.0, 3.0])
    assert load == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)


def test_inside_nothing_changes():
    inside = [0.1, -0.1, 0.05]
    assert closest_contact_load([(1, 0), (-1, 0)], [0.5, 0.5], inside) == pytest.approx(
        inside, abs=1e-6
    )


def test_the_residual_is_an_outer_normal(rng):
    position, radius = rng.normal(size=(12, 2)), rng.uniform(0.1, 1.0, 12)
    load = 30 * rng.normal(size=3)
    closest = closest_contact_load(position, radius, load)
    normal = load - closest
    x, y = position.T
    speeds = np.hypot(normal[0] - normal[2] * y, normal[1] + normal[2] * x)
    support = np.sum(radius * speeds)
    assert normal @ closest == pytest.approx(support, rel=1e-7)
