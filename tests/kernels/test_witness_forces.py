"""Forces that follow from a twist, a width, and the force at the kink."""

import numpy as np
import pytest

from limitsurf.kernels.contact_pass import Contacts
from limitsurf.kernels.contact_problem import EPS, KINK, KINK_FORCE, WITNESS, new_best
from limitsurf.kernels.contact_sum import witness_forces


def forces_of(contacts, v, eps=0.0, kink=-1, force=(0.0, 0.0)):
    best, forces = new_best(), np.full((contacts.data.shape[1], 2), np.nan)
    best[WITNESS : WITNESS + 3], best[EPS], best[KINK] = v, eps, kink
    best[KINK_FORCE : KINK_FORCE + 2] = force
    witness_forces(contacts, best, forces)
    return forces


def test_forces_along_the_velocities(rng):
    (x, y), m = rng.normal(size=(2, 30)), rng.uniform(0.1, 1.0, 30)
    contacts, v = Contacts(np.array([x, y, m]), 1, None), rng.normal(size=3)
    u = np.column_stack([v[0] - v[2] * y, v[1] + v[2] * x])
    speed = np.linalg.norm(u, axis=1)
    assert forces_of(contacts, v) == pytest.approx(m[:, None] * u / speed[:, None])
    soft = m[:, None] * u / np.hypot(speed, 0.5)[:, None]
    assert forces_of(contacts, v, 0.5) == pytest.approx(soft)


def test_contacts_at_the_kink_share_its_force():
    data = np.array([[1.0, 1.0, 0.0, 1.0], [2.0, 2.0, 0.0, 2.0], [1.0, 3.0, 1.0, 0.0]])
    forces = forces_of(Contacts(data, 1, None), [2.0, -1.0, 1.0], kink=1, force=(0.8, -0.4))
    assert forces[[0, 1, 3]] == pytest.approx(np.array([[0.2, -0.1], [0.6, -0.3], [0, 0]]))
    assert forces[2] == pytest.approx(np.array([2.0, -1.0]) / np.sqrt(5.0))


def test_other_ellipses_there_do_not():
    data = np.zeros((6, 3))
    data[2] = [1.0, 2.0, 3.0]
    data[3:] = np.array([[1.0, 0.0, 0.5], [0.5, 0.0, 1.0], [1.0, 0.0, 0.5]]).T
    forces = forces_of(Contacts(data, 1, None), [0.0, 0.0, 1.0], kink=0, force=(0.8, 0.4))
    assert forces == pytest.approx(np.array([[0.2, 0.1], [0.0, 0.0], [0.6, 0.3]]))
