"""Random feet, loads and starts: tolerances are kept, energy balances, steps agree."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.trajectory import EventKind
from tests.motion.feet_cases import GRIP, PLATE, RHO

SIZES = np.array([GRIP, GRIP, 0.03 * GRIP])


def a_motion(rng):
    """Return feet and arguments: feet that coincide, lie in a row, are weak, push, or are oval."""
    n = int(rng.integers(1, 7))
    place = rng.uniform(-0.06, 0.06, (n, 2))
    if n > 1 and rng.random() < 0.3:
        place[-1] = place[0] + rng.choice([0.0, 1e-9])
    if rng.random() < 0.15:
        place[0] = 0.0
    if rng.random() < 0.15:
        place[:, 1] = 0.0
    radius = rng.dirichlet(np.ones(n) * rng.choice([0.3, 1.0, 10.0])) * GRIP
    oval = rng.normal(0, 0.3, (n, 2, 2)) + np.eye(2) if rng.random() < 0.3 else None
    if oval is not None and np.abs(np.linalg.det(oval)).min() < 0.05:
        oval = None
    offset = rng.normal(0, 0.05, (n, 2)) if rng.random() < 0.2 else None
    twist = rng.normal(size=3) * [0.3, 0.3, 5.0] if rng.random() < 0.7 else np.zeros(3)
    if rng.random() < 0.2:
        twist = 4.0 * np.array([place[0, 1], -place[0, 0], 1.0])
    A, B = rng.normal(size=3) * SIZES, 0.3 * rng.normal(size=3) * SIZES
    w, phase = rng.uniform(5, 60), rng.uniform(0, 6, 3)
    load = (lambda t: A * np.sin(w * t + phase) + B) if rng.random() < 0.6 else B
    d = rng.uniform(0, 1)
    drag = (d, d, 1e-3 * d) if rng.random() < 0.4 else None
    feet = ContactSet(place, radius, offset, ellipse=oval)
    return feet, {"duration": 0.4, "twist": twist, "load": load, "drag": drag}


def off(path, exact):
    """Return how far the ends of two motions are apart, over the distance travelled."""
    size = np.ptp(exact.poses, axis=0) @ [1, 1, RHO] + 1e-4
    return np.abs((path.final_pose - exact.final_pose) * [1, 1, RHO]).max() / size


def test_tolerances_are_kept_and_energy_balances(rng):
    seen = set()
    for _ in range(60):
        feet, arguments = a_motion(rng)
        exact = feet_motion(PLATE, feet, tolerance=1e-10, **arguments)
        seen |= {event.kind for event in exact.events}
        for tolerance, allowed in ((1e-6, 1e-4), (1e-8, 1e-6)):
            path = feet_motion(PLATE, feet, tolerance=tolerance, **arguments)
            assert off(path, exact) < allowed
            energy = path.energy
            size = np.abs(energy.work).max() + energy.friction[-1] + energy.kinetic[0]
            assert np.abs(energy.residual).max() <= allowed * size
            assert (np.diff(path.times) > 0).all()
    assert seen == {EventKind.STICK, EventKind.SLIP, EventKind.START, EventKind.REST}


def test_weak_feet_hold_nothing_back(rng):
    """Starts about one of many feet, which does not stick."""
    for _ in range(10):
        place = rng.uniform(-0.06, 0.06, (200, 2))
        feet = ContactSet(place, rng.dirichlet(np.full(200, 0.3)) * GRIP)
        twist = 4.0 * np.array([place[0, 1], -place[0, 0], 1.0])
        exact = feet_motion(PLATE, feet, twist=twist, tolerance=1e-10)
        assert off(feet_motion(PLATE, feet, twist=twist, tolerance=1e-6), exact) < 2e-6
        assert off(feet_motion(PLATE, feet, twist=twist, tolerance=1e-8), exact) < 2e-8


@pytest.mark.parametrize("seed", range(6))
def test_events_are_the_limit_of_steps(seed):
    rng = np.random.default_rng(seed)
    feet, arguments = a_motion(rng)
    exact = feet_motion(PLATE, feet, **arguments)
    coarse, fine = (
        feet_motion(PLATE, feet, method="steps", time_step=h, **arguments) for h in (1e-3, 1e-4)
    )
    assert off(fine, exact) < 0.02
    assert off(fine, exact) < 0.3 * off(coarse, exact) + 1e-5
