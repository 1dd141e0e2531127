"""Kernels of feet: friction and its curvature, the step's order, exits, forces at a pivot."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.kernels.feet_hold import closest, new_holder, set_quadratic
from limitsurf.kernels.feet_rates import FREE, Freedom, curvature, friction, new_feet, rate
from limitsurf.kernels.feet_rest import exit_time
from limitsurf.kernels.feet_rosenbrock import rosenbrock_step
from limitsurf.motion.load_table import LoadTable

BODY = np.array([0.2, 3e-4, 0.3, 0.3, 1e-3, 0.1, -0.05, 1e-3])
PLACES = np.array([[0.04, -0.03, 0.01, 0.0], [0.01, 0.03, -0.05, 0.02], [0.2, 0.1, 0.15, 0.1]])
STRETCHES = np.array([[1.0, 0.5, 0.8, 1.0], [0.0, 0.2, -0.3, 0.1], [1.0, 1.0, 0.4, 0.3]])
ELLIPSES = np.vstack([PLACES, STRETCHES])
V = (0.3, -0.2, 4.0)


def swinging(t):
    return 0.5 * np.sin(20 * t), 0.3 * np.cos(31 * t), 0.01 * np.sin(11 * t)


def surface_of(places):
    a, b, d = places[3:] if len(places) > 3 else (np.ones(4), np.zeros(4), np.ones(4))
    S = np.array([[a, b], [b, d]]).transpose(2, 0, 1)
    return ContactSet(places[:2].T, places[2], ellipse=S).limit_surface()


@pytest.mark.parametrize("places", [PLACES, ELLIPSES], ids=["disks", "ellipses"])
def test_friction_is_the_support_point_and_its_slope_the_curvature(places):
    g = friction(places, V)
    assert g == pytest.approx(surface_of(places).support_point(np.array(V)), rel=1e-13)
    xx, xy, yy, xw, yw, ww = curvature(places, V)
    H = np.array([[xx, xy, xw], [xy, yy, yw], [xw, yw, ww]])
    slopes = []
    for e in 1e-5 * np.eye(3):
        ahead, behind = (np.array(friction(places, tuple(V + s * e))) for s in (1, -1))
        slopes.append((ahead - behind) / 2e-5)
    assert np.array(slopes) == pytest.approx(H, rel=1e-6, abs=1e-8)


def test_contacts_at_rest_count_for_nothing():
    x, y = PLACES[:2, 0]
    v = (2 * y, -2 * x, 2.0)
    others = PLACES[:, 1:].copy()
    assert friction(PLACES, v) == pytest.approx(friction(others, v), rel=1e-13)
    assert curvature(PLACES, v) == pytest.approx(curvature(others, v), rel=1e-13)


@pytest.mark.parametrize("freedom", [FREE, Freedom(0, *PLACES[:2, 0])], ids=["free", "pivot"])
@pytest.mark.parametrize("places", [PLACES, ELLIPSES], ids=["disks", "ellipses"])
def test_steps_are_of_fourth_order(freedom, places):
    feet, load = new_feet(places, BODY), LoadTable(swinging, 1.0).kernel
    start = V
    if freedom.pivot == 0:
        feet.data[2, 0] = 0.0
        start = (4.0 * freedom.y, -4.0 * freedom.x, 4.0)

    def end(n):
        v, theta, h, room = start, 0.2, 0.02 / n, np.empty((6, 4))
        for k in range(n):
            now = rate(feet, freedom, load, k * h, v, theta)
            v, theta, _ = rosenbrock_step(feet, freedom, load, k * h, v, theta, now, h, room)
        return np.array([*v, theta])

    exact = end(128)
    wrong = [np.abs((end(n) - exact) * [1, 1, 0.04, 0.04]).max() for n in (2, 4, 8)]
    orders = np.log2(np.array(wrong[:-1]) / wrong[1:])
    assert (orders > 3.6).all()


def test_the_rate_at_a_pivot_is_that_of_a_rod_on_a_hinge():
    feet, load = new_feet(PLACES, BODY), LoadTable(swinging, 1.0).kernel
    x, y = PLACES[:2, 0]
    feet.data[2, 0] = 0.0
    v = np.array([3 * y, -3 * x, 3.0])
    now = rate(feet, Freedom(0, x, y), load, 0.3, tuple(v), 0.2)
    Q = np.array(now.load) - np.array(now.friction) - BODY[2:5] * v
    about = Q[2] - x * Q[1] + y * Q[0]
    assert now.v[2] == pytest.approx(about / (BODY[1] + BODY[0] * (x * x + y * y)), rel=1e-13)
    assert now.v[:2] == pytest.approx([now.v[2] * y, -now.v[2] * x], rel=1e-13)


def holder_of(places):
    holder = new_holder(places)
    set_quadratic(holder, BODY[0], BODY[1])
    return holder


@pytest.mark.parametrize("places", [PLACES, ELLIPSES], ids=["disks", "ellipses"])
def test_what_is_held_is_what_a_projection_says(places, rng):
    holder, surface = holder_of(places), surface_of(places)
    metric = 1 / np.array([BODY[0], BODY[0], BODY[1]])
    found = set()
    for F in rng.normal(size=(40, 3)) * [0.4, 0.4, 0.01]:
        v, f, bound = closest(holder, tuple(F))
        projection = surface.project(F, metric)
        held = projection.distance == 0.0
        found.add(bool(held))
        assert (v == (0, 0, 0)) == held
        assert f == pytest.approx(-projection.point, abs=1e-9)
        assert v == pytest.approx(metric * (F - projection.point), abs=1e-9 / BODY[1])
        assert 0 <= bound < 1e-10
    assert found == {True, False}


@pytest.mark.parametrize("places", [PLACES, ELLIPSES], ids=["disks", "ellipses"])
def test_loads_in_the_ball_are_held(places, rng):
    holder = holder_of(places)
    radius, rho = holder.numbers[8], np.sqrt(BODY[1] / BODY[0])
    assert radius > 0.02 * PLACES[2].sum()
    for d in rng.normal(size=(100, 3)):
        F = 0.9999 * radius * d / np.linalg.norm(d) * [1, 1, rho]
        assert closest(holder, tuple(F))[0] == (0, 0, 0)


@pytest.mark.parametrize("seed", range(8))
def test_exits_are_the_first_ones(seed):
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(2, 3)) * [0.3, 0.3, 0.01], rng.uniform(5, 40, (2, 3))
    holder, theta, push = holder_of(PLACES), 0.7, (0.02, -0.01, 1e-3)

    def load(t, A=A, B=B):
        return A[0] * np.sin(B[0] * t) + A[1] * (1 - np.cos(B[1] * t))

    table = LoadTable(load, 2.0).kernel
    found = exit_time(holder, table, push, theta, 0.0)
    cos, sin = np.cos(theta), np.sin(theta)

    def held(t):
        x, y, m = load(t)
        F = (cos * x + sin * y + push[0], cos * y - sin * x + push[1], m + push[2])
        return closest(holder, F)[0] == (0, 0, 0)

    times = np.linspace(0, 2, 4001)
    first = next((t for t in times if not held(t)), np.inf)
    if first == np.inf:
        assert found == np.inf
    else:
        assert first - times[1] < found <= first
        assert held(found - 1e-9)
        assert not held(found + 1e-9)
