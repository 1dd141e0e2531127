"""The contact-sum kernel: against Clarabel, against made-up solutions, and its certificate."""

import numpy as np
import pytest

from limitsurf.conic.contact_sum import closest_contact_load
from limitsurf.kernels.contact_sum import solve_contact_sum

TOL = 1e-9


def contact_map(x, y, f):
    return np.array([f[:, 0].sum(), f[:, 1].sum(), (x * f[:, 1] - y * f[:, 0]).sum()])


def cloud(rng, n):
    x, y = rng.normal(size=(2, n))
    return x, y, rng.uniform(0.2, 1.0, n) / n


def friction_at(x, y, m, v):
    """Return ``sum G_i m_i u_i/|u_i|``, contacts at rest left out."""
    u = np.column_stack([v[0] - v[2] * y, v[1] + v[2] * x])
    speed = np.hypot(*u.T)
    speed[speed == 0.0] = np.inf
    return contact_map(x, y, m[:, None] * u / speed[:, None])


def solve(x, y, m, c, tol=TOL):
    return solve_contact_sum(x, y, m, np.asarray(c, dtype=float), np.zeros(3), tol)


@pytest.mark.parametrize("n", [1, 2, 3, 10, 60])
def test_matches_clarabel(rng, n):
    for size in (0.3, 1.0, 5.0):
        x, y, m = cloud(rng, n)
        c = size * rng.normal(size=3)
        twist, friction, bound, _, _ = solve(x, y, m, c)
        twin = closest_contact_load(np.column_stack([x, y]), m, c)
        assert np.linalg.norm(c + friction) == pytest.approx(np.linalg.norm(c - twin), abs=1e-8)
        # an interior point solver's point is off by the square root of its gap
        assert -friction == pytest.approx(twin, abs=1e-4)
        assert twist == pytest.approx(c + friction, abs=bound)


def sliding_twist(rng, kind, x, y):
    j = rng.integers(len(x))
    angle = rng.uniform(0, 2 * np.pi)
    return {
        "fast": lambda: rng.normal(size=3),
        "slow": lambda: 1e-5 * rng.normal(size=3),
        "translation": lambda: np.array([np.cos(angle), np.sin(angle), 0.0]),
        "rotation": lambda: np.array([0.0, 0.0, 0.3]),
        "about a contact": lambda: 0.3 * np.array([y[j], -x[j], 1.0]),
        "near a contact": lambda: (
            0.3 * np.array([y[j] + 1e-6 * np.cos(angle), -x[j] + 1e-6 * np.sin(angle), 1.0])
        ),
    }[kind]()


@pytest.mark.parametrize(
    "kind", ["fast", "slow", "translation", "rotation", "about a contact", "near a contact"]
)
def test_recovers_a_known_slide_within_its_bound(rng, kind):
    for _ in range(20):
        x, y, m = cloud(rng, 200)
        v = sliding_twist(rng, kind, x, y)
        load = friction_at(x, y, m, v)
        twist, friction, bound, sticks, _ = solve(x, y, m, v + load)
        scale = m.sum() + np.linalg.norm(v + load)
        error = np.linalg.norm(friction + load)
        assert error <= bound
        assert bound <= 2 * TOL * scale
        assert not sticks
        assert twist == pytest.approx(v, abs=2 * TOL * scale)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_a_load_inside_sticks_with_a_certificate(rng, share):
    for _ in range(20):
        x, y, m = cloud(rng, 200)
        c = share * friction_at(x, y, m, rng.normal(size=3))
        twist, friction, bound, sticks, _ = solve(x, y, m, c)
        assert sticks
        assert np.array_equal(twist, np.zeros(3))
        assert np.linalg.norm(friction + c) <= bound <= 2 * TOL * (m.sum() + np.linalg.norm(c))


def test_a_load_just_outside_slides(rng):
    x, y, m = cloud(rng, 200)
    direction = rng.normal(size=3)
    c = 1.001 * friction_at(x, y, m, direction)
    twist, _, _, sticks, _ = solve(x, y, m, c)
    assert not sticks
    assert np.linalg.norm(twist) > 1e-5


def test_a_load_on_the_boundary(rng):
    for _ in range(30):
        x, y, m = cloud(rng, 100)
        c = friction_at(x, y, m, rng.normal(size=3))
        _, friction, bound, _, _ = solve(x, y, m, c)
        assert np.linalg.norm(friction + c) <= bound <= 2 * TOL * (m.sum() + np.linalg.norm(c))


def test_certificate_holds_for_every_tolerance(rng):
    x, y, m = cloud(rng, 50)
    v = rng.normal(size=3)
    load = friction_at(x, y, m, v)
    for tol in (1e-1, 1e-3, 1e-6, 1e-9):
        _, friction, bound, _, _ = solve(x, y, m, v + load, tol)
        assert np.linalg.norm(friction + load) <= bound


def test_forces_are_admissible(rng):
    """Minus the frictional load lies in the sum: no direction separates it."""
    x, y, m = cloud(rng, 30)
    _, friction, _, _, _ = solve(x, y, m, 3 * rng.normal(size=3))
    for direction in rng.normal(size=(200, 3)):
        ux, uy = direction[0] - direction[2] * y, direction[1] + direction[2] * x
        assert -friction @ direction <= np.sum(m * np.hypot(ux, uy)) * (1 + 1e-12)


def test_warm_start_gives_the_same_answer_in_fewer_passes(rng):
    x, y, m = cloud(rng, 200)
    v = rng.normal(size=3)
    c = v + friction_at(x, y, m, v)
    cold = solve(x, y, m, c)
    warm = solve_contact_sum(x, y, m, c, 1.01 * v, TOL)
    assert warm[0] == pytest.approx(cold[0], abs=1e-8)
    assert warm[4] <= cold[4]


def test_no_contacts_and_no_friction_leave_the_load_alone():
    c = np.array([1.0, 2.0, 3.0])
    none = np.empty(0)
    for m in (none, np.zeros(4)):
        x = np.ones(len(m))
        twist, friction, bound, sticks, _ = solve(x, x, m, c)
        assert np.array_equal(twist, c)
        assert np.array_equal(friction, np.zeros(3))
        assert bound == 0.0
        assert not sticks
    assert solve(none, none, none, np.zeros(3))[3]
