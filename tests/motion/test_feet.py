"""Parts on feet: exact motions, the slow twin, energy, frames of reference, bad arguments."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.trajectory import EventKind, Outcome
from tests.motion.feet_cases import GRIP, PLATE, RHO, on_feet, twin

MOVING = (0.3, 0.1, 4.0)


def kinds(path):
    return [event.kind for event in path.events]


def swinging(t):
    s = np.sin(10 * np.pi * t)
    return GRIP * (0.5 + 0.8 * s), 0.3 * GRIP * np.sin(20 * np.pi * t + 0.3), 0.01 * GRIP * s


@pytest.mark.parametrize("n", [1, 4, 100])
def test_a_block_slides_to_rest(n):
    feet = ContactSet(on_feet(n).position if n > 1 else [[0.0, 0.0]], GRIP / n)
    path = feet_motion(PLATE, feet, (1, 2, 0.5), 3.0, twist=(0.6, 0.8, 0.0))
    braking = GRIP / PLATE.mass
    travelled = np.array([0.6, 0.8, 0.0]) / (2 * braking)
    assert path.outcome is Outcome.REST
    assert path.final_pose == pytest.approx(np.array([1, 2, 0.5]) + travelled, abs=1e-8)
    assert kinds(path) == [EventKind.REST]
    assert path.events[0].time == pytest.approx(1.0 / braking, rel=1e-9)
    assert not path.twists[-1].any()


def test_a_spin_about_a_heavy_foot_slows_down_evenly():
    place = np.array([[0.04, 0.01], [-0.03, 0.04], [-0.02, -0.05]])
    feet = ContactSet(place, [5.0, 0.3, 0.2])
    x, y = place[0]
    inertia = PLATE.inertia + PLATE.mass * (x * x + y * y)
    slowing = (feet.radius * np.hypot(*(place - place[0]).T)).sum() / inertia
    path = feet_motion(PLATE, feet, (0, 0, 0), 2.0, twist=(3 * y, -3 * x, 3.0))
    assert kinds(path) == [EventKind.REST]
    assert path.events[0].time == pytest.approx(3 / slowing, rel=1e-10)
    assert path.final_pose[2] == pytest.approx(9 / (2 * slowing), rel=1e-10)
    cos, sin = np.cos(path.poses[:, 2]), np.sin(path.poses[:, 2])
    foot = path.poses[:, :2] + np.column_stack([cos * x - sin * y, sin * x + cos * y])
    assert np.abs(foot - place[0]).max() < 1e-16


def test_without_feet_a_part_flies_straight():
    nothing = ContactSet(np.empty((0, 2)), np.empty(0))
    path = feet_motion(PLATE, nothing, (1, 2, 3), 2.0, twist=(0.5, -0.4, 30.0))
    assert path.final_pose == pytest.approx([2.0, 1.2, 63.0], rel=1e-7)
    assert path.outcome is Outcome.TIME_LIMIT
    slides = ContactSet([[0.01, 0.02]], 0.0)
    path = feet_motion(PLATE, slides, duration=1.0, twist=(1, 0, 2), drag=(0.4, 0.4, 1e-3))
    rate, turn = 0.4 / PLATE.mass, 1e-3 / PLATE.inertia
    expected = [(1 - np.exp(-rate)) / rate, 0.0, 2 * (1 - np.exp(-turn)) / turn]
    assert path.final_pose == pytest.approx(expected, rel=1e-7, abs=1e-9)


def test_a_swinging_load_starts_a_block_where_it_exceeds_friction():
    feet, F = ContactSet(on_feet(4).position, GRIP / 4), 1.25 * GRIP
    path = feet_motion(PLATE, feet, duration=1.0, load=lambda t: (F * np.sin(2 * np.pi * t), 0, 0))
    assert kinds(path) == 2 * [EventKind.START, EventKind.REST]
    start = np.arcsin(0.8) / (2 * np.pi)
    assert path.events[0].time == pytest.approx(start, rel=1e-10)
    assert path.events[2].time == pytest.approx(start + 0.5, rel=1e-10)
    w, t0 = 2 * np.pi, start

    def speed(t):
        return (F * (np.cos(w * t0) - np.cos(w * t)) / w - GRIP * (t - t0)) / PLATE.mass

    assert abs(speed(path.events[1].time)) < 1e-8 * speed(0.25)
    assert path.final_pose == pytest.approx([0, 0, 0], abs=1e-8)  # and back


CASES = {
    "one foot": (on_feet(3).seen_from(on_feet(3).position[0]), {}),
    "three feet": (on_feet(3), {}),
    "ten feet": (on_feet(10), {}),
    "three hundred": (on_feet(300), {}),
    "drag": (on_feet(3), {"drag": (0.5, 0.5, 1e-3)}),
    "uneven": (ContactSet([[0.04, 0.01], [-0.03, 0.04], [-0.02, -0.05]], [0.5, 0.06, 0.03]), {}),
    "one weak foot": (ContactSet([[0.03, 0.01], [-0.05, 0.02]], [0.5, 0.02]), {}),
    "pushed": (ContactSet([[0.04, 0], [-0.03, 0.04]], 0.3, [[0.1, 0.05], [0, -0.1]]), {}),
    "ellipses": (
        ContactSet(
            [[0.04, 0.0], [-0.03, 0.04], [-0.03, -0.04]],
            0.2,
            ellipse=[[[1, 0], [0, 0.3]], [[0.5, 0.2], [0.2, 1]], [[1, 0.4], [0.1, 0.6]]],
        ),
        {},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_events_agree_with_the_regularised_law(name):
    feet, more = CASES[name]
    path = feet_motion(PLATE, feet, (0, 0, 0.4), 0.25, twist=MOVING, **more)
    slow = twin(PLATE, feet, 0.25, pose=(0, 0, 0.4), twist=MOVING, eps=1e-7, **more)
    assert path.final_pose == pytest.approx(slow, abs=3e-7)


@pytest.mark.parametrize("n", [2, 3, 10])
def test_driven_events_agree_with_the_regularised_law(n):
    path = feet_motion(PLATE, on_feet(n), duration=0.45, load=swinging)
    assert {EventKind.START, EventKind.REST} <= set(kinds(path))
    rough, fine = (twin(PLATE, on_feet(n), 0.45, load=swinging, eps=eps) for eps in (1e-7, 1e-8))
    # near a start the regularised speed is eps / sqrt(t*-t), then (t-t*)^2: they meet at eps^(2/5),
    # and what is left of it later on is the square of that
    share = 10**0.8
    assert path.final_pose == pytest.approx((share * fine - rough) / (share - 1), abs=2e-8)
    assert np.abs(path.final_pose - fine).max() > 1e-7


def test_a_foot_sticks_and_slips_again():
    def load(t):
        s, c = np.sin(10 * np.pi * t), np.sin(20 * np.pi * t + 0.3)
        return 1.5 * GRIP * s, 0.4 * GRIP * c, 0.01 * GRIP * np.sin(10 * np.pi * t + 1)

    path = feet_motion(PLATE, on_feet(2), duration=0.25, load=load)
    assert kinds(path)[-2:] == [EventKind.STICK, EventKind.SLIP]
    slow = twin(PLATE, on_feet(2), 0.25, load=load, eps=1e-8)
    assert path.final_pose == pytest.approx(slow, abs=1e-6)


def test_loads_of_feet_are_what_moves_the_part():
    path = feet_motion(PLATE, on_feet(3), duration=0.4, load=swinging, frames=4000)
    mass = np.array([PLATE.mass, PLATE.mass, PLATE.inertia])
    net = path.loads + np.array([swinging(t) for t in path.times])
    t, v = path.times, path.twists
    gained = np.cumsum(0.5 * (net[1:] + net[:-1]) * np.diff(t)[:, None], axis=0)
    assert np.abs(gained - mass * v[1:]).max() < 1e-4 * GRIP
    still = ~v.any(axis=1)
    assert still.any()
    assert np.abs(net[still]).max() < 1e-9 * GRIP


def test_steps_are_of_first_order():
    exact = feet_motion(PLATE, on_feet(3), duration=0.1, twist=MOVING).final_pose
    wrong = []
    for step in (1e-3, 5e-4, 2.5e-4):
        path = feet_motion(
            PLATE, on_feet(3), duration=0.1, twist=MOVING, method="steps", time_step=step, frames=1
        )
        wrong.append(np.linalg.norm(path.final_pose - exact))
    orders = np.log2(np.array(wrong[:-1]) / wrong[1:])
    assert orders == pytest.approx([1.0, 1.0], abs=0.05)


def test_controlled_steps_are_as_accurate_as_asked():
    exact = feet_motion(PLATE, on_feet(3), duration=0.4, load=swinging).final_pose
    wrong = []
    for tol in (1e-2, 1e-4):
        path = feet_motion(
            PLATE, on_feet(3), duration=0.4, load=swinging, method="steps", tolerance=tol
        )
        wrong.append(np.abs((path.final_pose - exact) * [1, 1, RHO]).max() / np.hypot(*exact[:2]))
    assert wrong[0] < 0.2
    assert wrong[1] < 0.02
    assert wrong[1] < 0.3 * wrong[0]


@pytest.mark.parametrize("feet", [on_feet(3), CASES["pushed"][0], CASES["ellipses"][0]])
def test_each_step_balances_energy(feet):
    drag, steps = np.array([0.3, 0.3, 1e-3]), 100
    path = feet_motion(
        PLATE,
        feet,
        (0, 0, 0.3),
        0.1,
        twist=MOVING,
        load=swinging,
        drag=drag,
        method="steps",
        time_step=1e-3,
        frames=steps,
    )
    mass = np.array([PLATE.mass, PLATE.mass, PLATE.inertia])
    passive = ContactSet(feet.position, feet.radius, ellipse=feet.ellipse).limit_surface()
    size = 0.5 * mass @ (np.array(MOVING) ** 2)
    for k in range(steps):
        v0, v1, theta = path.twists[k], path.twists[k + 1], path.poses[k, 2]
        cos, sin = np.cos(theta), np.sin(theta)
        R = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
        F = np.array(swinging(path.times[k + 1])) + R @ feet.offset_load
        kinetic = 0.5 * mass @ (v1**2 - v0**2 + (v1 - v0) ** 2)
        loss = 1e-3 * (passive.support(-R.T @ v1) + drag @ v1**2 - F @ v1)
        assert kinetic + loss == pytest.approx(0.0, abs=1e-10 * size)
    assert np.abs(path.energy.residual).max() < 1e-10 * size
    assert path.energy.numerical[-1] > 0.0


def test_events_balance_energy():
    for load, v in ((None, MOVING), (swinging, (0, 0, 0))):
        path = feet_motion(PLATE, on_feet(3), duration=0.4, load=load, twist=v)
        assert path.energy.friction[-1] > 0.0
        assert np.abs(path.energy.residual).max() < 1e-7 * path.energy.friction[-1]
        assert (np.diff(path.energy.friction) >= -1e-15).all()
        assert not path.energy.numerical.any()


def test_tolerances_are_kept():
    exact = feet_motion(PLATE, on_feet(10), duration=0.4, load=swinging, tolerance=1e-12).final_pose
    for tol in (1e-3, 1e-5, 1e-7, 1e-9):
        path = feet_motion(PLATE, on_feet(10), duration=0.4, load=swinging, tolerance=tol)
        assert np.linalg.norm(path.final_pose - exact) < 10 * tol * np.hypot(*exact[:2])


def test_coincident_feet_are_one():
    feet = on_feet(3)
    place = np.vstack([feet.position, feet.position[::-1]])
    twice = ContactSet(place, 0.5 * GRIP / 3)
    one, two = (feet_motion(PLATE, f, duration=1.0, twist=MOVING) for f in (feet, twice))
    assert EventKind.STICK in kinds(one)
    assert kinds(two) == kinds(one)
    assert two.final_pose == pytest.approx(one.final_pose, abs=1e-12)


def test_frames_of_reference_do_not_matter():
    feet, angle, shift = on_feet(3), 2.0, np.array([3.0, -1.0])
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    path = feet_motion(PLATE, feet, (0, 0, 0.1), 0.3, load=swinging, twist=MOVING)
    moved = feet_motion(
        PLATE,
        feet,
        (*shift, 0.1 + angle),
        0.3,
        load=lambda t: (*(R @ swinging(t)[:2]), swinging(t)[2]),
        twist=(*(R @ MOVING[:2]), MOVING[2]),
    )
    assert kinds(moved) == kinds(path)
    expected = np.array([*(R @ path.final_pose[:2] + shift), path.final_pose[2] + angle])
    assert moved.final_pose == pytest.approx(expected, abs=1e-9)


def test_units_do_not_matter():
    length, time, weight = 2.0**-10, 2.0**-3, 2.0**-12
    force = weight * length / time**2
    small = Part(PLATE.edges[:, :2] * length, 20.0 * weight / length**2)
    feet, little = on_feet(3), ContactSet(on_feet(3).position * length, GRIP / 3 * force)
    path = feet_motion(PLATE, feet, duration=0.5, twist=MOVING)
    v = np.array(MOVING) * [length / time, length / time, 1 / time]
    scaled = feet_motion(small, little, duration=0.5 * time, twist=v)
    assert kinds(scaled) == kinds(path)
    assert scaled.duration == pytest.approx(path.duration * time, rel=1e-11)
    assert scaled.final_pose == pytest.approx(path.final_pose * [length, length, 1], rel=1e-10)


def test_frames_and_events_are_recorded():
    path = feet_motion(PLATE, on_feet(3), duration=0.4, load=swinging, frames=8)
    assert (np.diff(path.times) > 0).all()
    for time in 0.05 * np.arange(9):
        assert np.abs(path.times - time).min() < 1e-15
    for event in path.events:
        assert np.abs(path.times - event.time).min() == 0.0


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"duration": 0.0}, "duration: must be positive"),
        ({"duration": np.nan}, "duration"),
        ({"twist": (1, 2)}, "twist: has shape"),
        ({"pose": (0, 0, np.inf)}, "pose: has entries"),
        ({"mode": "static"}, "mode: is unknown"),
        ({"method": "magic"}, "method: is unknown"),
        ({"frames": 0}, "frames"),
        ({"tolerance": 2.0}, "tolerance"),
        ({"time_step": 1e-3}, "time_step: is for steps"),
        ({"time_step": -1.0, "method": "steps"}, "time_step: must be positive"),
        ({"time_step": 1e-9, "method": "steps"}, "needs 1e"),
        ({"drag": (1, 2, 1)}, "drag: must be at least 0 and the same"),
        ({"mode": "quasi-static"}, "drag: must be positive"),
        ({"contacts": ContactSet([[0, 0]], 1.0, sides=8)}, "polygons"),
        (
            {"contacts": ContactSet([[0, 0]], 1.0, ellipse=[[[1, 0], [0, 0]]])},
            "segments.*steps",
        ),
    ],
)
def test_bad_arguments(change, problem):
    arguments = {"contacts": on_feet(3), "duration": 1.0, **change}
    with pytest.raises(InputError, match=problem):
        feet_motion(PLATE, **arguments)
