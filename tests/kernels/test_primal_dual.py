"""The last resort alone: from anywhere, with crowded kinks, and with the forces it reports."""

import numpy as np
import pytest

from limitsurf.kernels.contact_pass import Contacts
from limitsurf.kernels.contact_problem import (
    BOUND,
    LOAD,
    TWIST,
    Problem,
    new_best,
    new_setting,
    second_moments,
)
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.primal_dual import primal_dual
from tests.kernels.test_symmetric3 import three
from tests.sets.contact_cases import cases, clouds, load_of, norm

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def solved_alone(position, radius, load, v=(0.1, 0.2, 0.3), eps=1.0, tol=1e-12):
    contacts = Contacts(np.array([*position.T, radius]), 1, None)
    n = len(radius)
    setting = new_setting(n, second_moments(contacts), IDENTITY, three(load), 1.0, tol)
    best, room = new_best(), np.zeros((n, 2))
    primal_dual(Problem(contacts, new_table(n), setting), best, v, eps, room)
    return best, room, setting


@pytest.mark.parametrize("n", [2, 5, 30])
def test_errors_are_within_bounds(rng, n):
    within = []
    for name, position, radius in clouds(rng, n):
        if name in ("far origin", "tiny and far") or radius.sum() == 0.0:
            continue
        known = cases(rng, position, radius, None)
        for i in rng.choice(len(known.names), 12, replace=False):
            best, forces, setting = solved_alone(position, radius, known.loads[i])
            F = best[LOAD : LOAD + 3]
            error = norm(None, F - known.closest[i])[0]
            bound = best[BOUND] + setting.rounding + known.slack[i]
            assert error <= bound, (name, known.names[i])
            assert np.all(np.linalg.norm(forces, axis=1) <= radius * (1 + 1e-14))
            off = norm(None, load_of(position, forces) - F)[0]
            assert off <= 1e-14 * radius.sum() * (1 + np.abs(position).max()), known.names[i]
            within.append(best[BOUND] <= 1e-6 * setting.scale)
    assert np.mean(within) > 0.9


def test_any_start_and_width(rng):
    position, radius = rng.normal(size=(20, 2)), rng.uniform(0.1, 1.0, 20)
    load = np.array([9.0, 4.0, 3.0])
    found = []
    for eps in (1e-6, 1.0, 1e3):
        for v in (1e-3 * rng.normal(size=3), rng.normal(size=3), 1e2 * rng.normal(size=3)):
            best, _, setting = solved_alone(position, radius, load, three(v), eps)
            assert best[BOUND] <= 1e-11 * setting.scale
            found.append(best[LOAD : LOAD + 3].copy())
    assert np.ptp(found, axis=0).max() <= 1e-10 * setting.scale


def test_a_load_inside_is_held(rng):
    position, radius = rng.normal(size=(20, 2)), rng.uniform(0.1, 1.0, 20)
    best, forces, setting = solved_alone(position, radius, np.array([1.0, -2.0, 3.0]))
    assert best[BOUND] <= setting.target
    assert not best[TWIST : TWIST + 3].any()
    assert load_of(position, forces).astype(float) == pytest.approx([1.0, -2.0, 3.0], abs=1e-11)
