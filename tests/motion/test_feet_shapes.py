"""Rings, disks, carts and tripods on feet: what is known of them; stick near the limit."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.wheel import Wheel
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.trajectory import EventKind, Outcome
from tests.motion.feet_cases import GRIP, PLATE, RHO, on_feet, round_part

MU_G = 0.3 * 9.81


def shortly_before(part, feet, twist, share=1e-7):
    """Return when the part rests, and its motion until a share of that time before."""
    path = feet_motion(part, feet, duration=100.0, twist=twist, tolerance=1e-12, frames=1)
    assert path.outcome is Outcome.REST
    almost = feet_motion(
        part, feet, duration=path.duration * (1 - share), twist=twist, tolerance=1e-12, frames=1
    )
    return path.duration, almost


def assert_sliding_and_spinning_end_together(part, feet, twist):
    end, almost = shortly_before(part, feet, twist)
    v, F, now = almost.twists[-1], almost.loads[-1], almost.duration
    speed = np.hypot(*v[:2])
    assert 0 < speed < 1e-6 * twist[0]
    slowing = -F[:2] @ v[:2] / speed / part.mass
    assert now + speed / slowing == pytest.approx(end, abs=1e-8)
    assert now - v[2] / (F[2] / part.inertia) == pytest.approx(end, abs=1e-8)


def last_ratio(part, feet, radius, twist, again):
    """Return speed over rim speed near the end; what happens does not depend on the scale of it."""
    for _ in range(1 + again):
        v = shortly_before(part, feet, twist, 1e-6)[1].twists[-1]
        twist = 0.5 * v / np.hypot(*v[:2])
    return 0.5 / (radius * twist[2])


@pytest.fixture(scope="module")
def disk():
    """A disk on 2016 contacts: Gauss points of the squared radius, on turned circles."""
    part = round_part(0.0, 0.1)
    radius = np.sqrt(2 * part.inertia / part.mass)
    x, w = np.polynomial.legendre.leggauss(32)
    turn = (np.arange(63) + 0.618 * np.arange(32)[:, None]) * 2 * np.pi / 63
    r = radius * np.sqrt(0.5 * (1 + x))[:, None]
    place = np.column_stack([(r * np.cos(turn)).ravel(), (r * np.sin(turn)).ravel()])
    return part, ContactSet(place, np.repeat(w / 2 / 63, 63) * MU_G * part.mass), radius


@pytest.fixture(scope="module")
def ring():
    part = round_part(0.099, 0.101)
    radius = np.sqrt(part.inertia / part.mass)
    angle = 2 * np.pi * (np.arange(2000) + 0.5) / 2000
    place = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return part, ContactSet(place, MU_G * part.mass / 2000), radius


@pytest.mark.parametrize("ratio", [0.3, 1.0, 3.0])
def test_sliding_and_spinning_of_a_disk_end_together(disk, ratio):
    part, feet, radius = disk
    start = (0.5, 0.0, 0.5 / (ratio * radius))
    assert_sliding_and_spinning_end_together(part, feet, start)
    # Z. Farkas, G. Bartels, T. Unger, D. E. Wolf, Phys. Rev. Lett. 90, 248302 (2003)
    assert last_ratio(part, feet, radius, start, 1) == pytest.approx(0.6530, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.02, 0.05, 0.2, 20.0])
def test_far_starts_of_a_disk_end_alike(disk, ratio):
    part, feet, radius = disk
    start = (0.5, 0.0, 0.5 / (ratio * radius))
    assert last_ratio(part, feet, radius, start, 3) == pytest.approx(0.6530, abs=1e-3)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 3.0])
def test_sliding_and_spinning_of_a_ring_end_together(ring, ratio):
    part, feet, radius = ring
    start = (0.5, 0.0, 0.5 / (ratio * radius))
    assert_sliding_and_spinning_end_together(part, feet, start)
    assert last_ratio(part, feet, radius, start, 0) == pytest.approx(1.0, abs=1e-4)


def cart(steer=0.0, torque=0.0):
    """Return two parallel wheels on an axle behind, and one in front, steered."""
    wheels = [
        Wheel(at, (np.cos(a), np.sin(a)), 0.01, 0.6, 0.5, bearing_friction=0.02, torque=torque)
        for at, a in (((-0.03, 0.03), 0.0), ((-0.03, -0.03), 0.0), ((0.04, 0.0), steer))
    ]
    sets = [wheel.contact_set() for wheel in wheels]
    return ContactSet(
        np.vstack([s.position for s in sets]),
        np.concatenate([s.radius for s in sets]),
        np.vstack([s.offset for s in sets]),
        ellipse=np.vstack([s.ellipse for s in sets]),
    )


@pytest.mark.parametrize("method", ["events", "steps"])
def test_a_driven_cart_goes_where_its_wheels_roll(method):
    heading = np.array([np.cos(0.7), np.sin(0.7)])
    drive, bearing = 3 * 0.002 / 0.01, 3 * 0.02
    path = feet_motion(
        PLATE, cart(torque=0.002), (0, 0, 0.7), 0.5, method=method,
        time_step=1e-4 if method == "steps" else None,
    )  # fmt: skip
    expected = 0.5 * (drive - bearing) / PLATE.mass * 0.5**2 * heading
    assert path.final_pose[:2] == pytest.approx(expected, rel=3e-4 if method == "steps" else 1e-7)
    assert path.final_pose[2] == pytest.approx(0.7, abs=1e-12)


def test_a_cart_loses_its_sideways_velocity():
    path = feet_motion(PLATE, cart(), duration=0.4, twist=(1.0, 0.5, 1.0))
    v, theta = path.twists[-1], path.final_pose[2]
    along = v[0] * np.cos(theta) + v[1] * np.sin(theta)
    across = v[1] * np.cos(theta) - v[0] * np.sin(theta)
    assert along > 0.5
    assert abs(across) + RHO * abs(v[2]) < 1e-3


def test_a_steered_cart_turns_about_where_its_axles_meet():
    steer = 0.5
    path = feet_motion(
        PLATE, cart(steer, 0.002), duration=4.0, mode="quasi-static", drag=(1, 1, 1e-3)
    )
    center = np.array([-0.03, 0.07 / np.tan(steer)])
    turned = path.poses[:, 2]
    cos, sin = np.cos(turned), np.sin(turned)
    place = path.poses[:, :2] + np.column_stack(
        [cos * center[0] - sin * center[1], sin * center[0] + cos * center[1]]
    )
    assert turned[-1] > 1.0
    # wheels with bearing friction slip a little: the centre is near, and it stays
    body = path.twists[-1]
    u = np.array([cos[-1] * body[0] + sin[-1] * body[1], cos[-1] * body[1] - sin[-1] * body[0]])
    seen = np.array([-u[1], u[0]]) / body[2]
    assert seen == pytest.approx(center, abs=0.01)
    assert np.ptp(path.twists[1:, 2]) < 1e-9 * turned[-1]
    assert np.abs(place - place[0]).max() < 0.02


@pytest.mark.parametrize("mode", ["inertial", "quasi-static"])
def test_a_tripod_is_pushed_about_one_foot(mode):
    feet, drag = on_feet(3), np.array([0.4, 0.4, 1e-3])
    p = np.array([feet.position[0, 1], -feet.position[0, 0], 1.0])  # twist about foot 0
    arms = feet.position[1:] - feet.position[0]
    friction = np.zeros(3)
    for r, arm, m in zip(feet.position[1:], arms, feet.radius[1:], strict=True):
        f = -m * np.array([-arm[1], arm[0]]) / np.hypot(*arm)
        friction += [*f, r[0] * f[1] - r[1] * f[0]]
    f0 = 0.3 * feet.radius[0] * np.array([0.6, -0.8])
    held = np.array([*f0, feet.position[0, 0] * f0[1] - feet.position[0, 1] * f0[0]])
    turn = 0.2
    load = drag * p * turn - friction - held
    path = feet_motion(PLATE, feet, duration=0.05, load=load, mode=mode, drag=drag)
    assert path.twists[-1][2] > 0.0
    if mode == "quasi-static":
        assert path.twists[0] == pytest.approx(turn * p, rel=1e-9)
    else:
        inertia = PLATE.inertia + PLATE.mass * (p[0] ** 2 + p[1] ** 2)
        damping = drag @ p**2 / inertia
        expected = turn * (1 - np.exp(-0.01 * damping))
        early = feet_motion(PLATE, feet, duration=0.01, load=load, drag=drag)
        assert early.twists[-1][2] == pytest.approx(expected, rel=1e-3)
    cos, sin = np.cos(path.poses[:, 2]), np.sin(path.poses[:, 2])
    x, y = feet.position[0]
    foot = path.poses[:, :2] + np.column_stack([cos * x - sin * y, sin * x + cos * y])
    assert np.abs(foot - feet.position[0]).max() < 1e-10
    assert path.final_pose[2] > 1e-4


def test_quasi_static_speed_is_load_less_friction_over_drag():
    drag, F = (2.0, 2.0, 1e-3), 1.5 * GRIP
    path = feet_motion(
        PLATE, on_feet(10), duration=1.0, load=(F, 0, 0), mode="quasi-static", drag=drag
    )
    assert path.final_pose == pytest.approx([(F - GRIP) / 2.0, 0, 0], abs=1e-10)
    swing = feet_motion(
        PLATE, on_feet(10), duration=0.5, mode="quasi-static", drag=drag,
        load=lambda t: (F * np.sin(2 * np.pi * t), 0, 0),
    )  # fmt: skip
    t0 = np.arcsin(1 / 1.5) / (2 * np.pi)
    assert [e.kind for e in swing.events] == [EventKind.START, EventKind.REST]
    assert [e.time for e in swing.events] == pytest.approx([t0, 0.5 - t0], abs=1e-7)
    expected = (F * np.cos(2 * np.pi * t0) / np.pi - GRIP * (0.5 - 2 * t0)) / 2.0
    assert swing.final_pose[0] == pytest.approx(expected, rel=1e-7)


def test_quasi_static_events_agree_with_steps():
    def load(t):
        s = np.sin(10 * np.pi * t)
        return GRIP * 1.5 * s, 0.4 * GRIP * np.sin(20 * np.pi * t + 0.3), 0.01 * GRIP * s

    arguments = {"duration": 0.25, "load": load, "mode": "quasi-static", "drag": (2, 2, 2e-3)}
    path = feet_motion(PLATE, on_feet(3), **arguments)
    coarse, steps = (
        feet_motion(PLATE, on_feet(3), method="steps", time_step=h, **arguments)
        for h in (1e-4, 1e-5)
    )
    limit = (10 * steps.final_pose - coarse.final_pose) / 9  # first order
    assert path.final_pose == pytest.approx(limit, abs=1e-6)
    assert np.abs(coarse.final_pose - limit).max() > 1e-5
    assert np.abs(path.energy.residual).max() < 1e-7 * path.energy.friction[-1]
    assert np.abs(steps.energy.residual).max() < 1e-10 * steps.energy.friction[-1]


def limit_of(feet, direction):
    """Return the factor with which a load in a direction is just held."""
    low, high = 0.0, 1e3
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        if feet.project(-middle * direction).distance > 0.0:
            high = middle
        else:
            low = middle
    return low


@pytest.mark.parametrize("method", ["events", "steps"])
@pytest.mark.parametrize("n", [3, 10, 100])
def test_a_plate_sticks_up_to_its_limit_and_not_beyond(n, method):
    feet, pose = on_feet(n), np.array([0.1, 0.2, 0.3])
    cos, sin = np.cos(0.3), np.sin(0.3)
    body = GRIP * np.array([0.8, 0.5, 0.02])  # a tilt, and a torque
    world = np.array([cos * body[0] - sin * body[1], sin * body[0] + cos * body[1], body[2]])
    limit = limit_of(feet, body)
    more = {"method": method, "frames": 10}
    held = feet_motion(PLATE, feet, pose, 10.0, load=(1 - 1e-4) * limit * world, **more)
    assert (held.poses == pose).all()
    assert not held.twists.any()
    swell = feet_motion(
        PLATE, feet, pose, 10.0, **more,
        load=lambda t: (1 - 1e-4) * limit * np.sin(2 * np.pi * t / 5) * world,
    )  # fmt: skip
    assert (swell.poses == pose).all()
    assert swell.duration == 10.0
    slips = feet_motion(PLATE, feet, pose, 1.0, load=(1 + 1e-4) * limit * world, **more)
    assert np.abs(slips.final_pose - pose).max() > 1e-6
    if method == "events":  # short steps would find it too
        over = feet_motion(
            PLATE, feet, pose, 10.0, **more,
            load=lambda t: (1 + 1e-4) * limit * np.sin(2 * np.pi * t / 5) * world,
        )  # fmt: skip
        assert [e.kind for e in over.events] == 4 * [EventKind.START, EventKind.REST]
        times = np.array([e.time for e in over.events]).reshape(2, 2, 2)
        start = 5 / (2 * np.pi) * np.arcsin(1 / (1 + 1e-4))
        assert times[0, 0, 0] == pytest.approx(start, abs=1e-7)
        assert np.abs(np.ptp(over.poses, axis=0)).max() > 1e-9
