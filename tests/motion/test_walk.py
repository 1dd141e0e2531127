"""Walkers: lines and circles in closed form, and what holds them."""

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.motion.rigid_motion import compose, displacement, to_body, to_world
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.steady_walk import steady_walk
from limitsurf.motion.trajectory import EventKind, Outcome
from limitsurf.motion.walk import walk
from limitsurf.sets.projection import Status

DRAG = np.array([2.0, 2.0, 0.5])


def walker(rng, n=12, friction=0.3):
    """Return feet of which every other one pushes, mostly forwards."""
    places = rng.normal(size=(n, 2))
    pushes = np.zeros((n, 2))
    pushes[::2] = [1.0, 0.1] + 0.2 * rng.normal(size=(n // 2, 2))
    return ContactSet(places, friction * rng.uniform(0.1, 1.0, n), pushes)


def in_world(feet, pose):
    """Return the feet in world axes, with the body at a pose."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    R = np.array([[c, -s], [s, c]])
    return ContactSet(feet.position @ R.T, feet.radius, feet.offset @ R.T)


def world_twist(feet, pose, drag=DRAG, load=(0.0, 0.0, 0.0)):
    """Return the twist in world axes from a projection there: the slow way."""
    R = np.eye(3)
    R[:2, :2] = [[np.cos(pose[2]), -np.sin(pose[2])], [np.sin(pose[2]), np.cos(pose[2])]]
    W = R @ np.diag(1.0 / drag) @ R.T
    return in_world(feet, pose).project(-R @ load, 0.5 * (W + W.T)).twist


@pytest.mark.parametrize(
    ("drag", "load"),
    [(DRAG, np.zeros(3)), (np.array([1.0, 3.0, 0.7]), np.array([0.2, -0.4, 0.3]))],
)
def test_closed_form_agrees_with_an_integrated_twist(rng, drag, load):
    feet, start = walker(rng), np.array([0.3, -0.2, 0.7])
    path = walk(feet, 3.0, drag=drag, pose=start, load=load, frames=10)
    solved = solve_ivp(
        lambda _, pose: world_twist(feet, pose, drag, load),
        (0.0, 3.0),
        start,
        method="DOP853",
        t_eval=path.times,
        rtol=1e-12,
        atol=1e-13,
    )
    assert abs(path.final_pose[2] - start[2]) > 0.5
    assert np.abs(solved.y.T - path.poses).max() < 1e-10
    for pose, twist in zip(path.poses, path.twists, strict=True):
        assert twist == pytest.approx(world_twist(feet, pose, drag, load), abs=1e-11)


def test_implicit_steps_converge_to_the_closed_form_with_order_one(rng):
    feet, exact = walker(rng), None
    errors = []
    for n in (50, 100, 200):
        pose = np.zeros(3)
        for _ in range(n):
            pose = pose + 2.0 / n * world_twist(feet, pose)
        exact = walk(feet, 2.0, drag=DRAG).final_pose
        errors.append(np.linalg.norm(pose - exact))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[-1] < 0.02
    assert orders == pytest.approx([1.0, 1.0], abs=0.05)


def test_the_load_does_maximum_work_and_balances_drag(rng):
    feet, load = walker(rng), np.array([0.1, 0.2, -0.3])
    found = steady_walk(feet, DRAG, load)
    assert DRAG * found.twist == pytest.approx(load + found.load, abs=1e-11)
    assert -found.twist @ found.load == pytest.approx(feet.limit_surface().support(-found.twist))
    assert found.projection.status == Status.OUTSIDE
    assert found.error_bound < 1e-10
    assert 0.0 <= found.relative_error < 1e-11


def test_the_origin_decides_what_the_paper_says():
    """Drag (1, 1, 1): the twist is the point of L nearest to the origin, the load itself."""
    feet = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.4, [[0.0, 3.0], [0.0, 1.0]])
    found = steady_walk(feet, (1.0, 1.0, 1.0))
    assert found.twist == pytest.approx(found.load, abs=1e-12)
    assert found.load == pytest.approx(feet.project([0.0, 0.0, 0.0]).point, abs=1e-12)
    assert found.load[1] == pytest.approx(4.0 - 0.8)  # both feet slip forwards
    assert found.load[2] == pytest.approx(2.0)


def test_a_circle(rng):
    feet, start = walker(rng), np.array([1.0, 2.0, 0.4])
    found = steady_walk(feet, DRAG)
    path = walk(feet, 9.0, drag=DRAG, pose=start, frames=50)
    center = compose(start, np.array([*found.center, 0.0]))[:2]
    arms = path.poses[:, :2] - center
    assert np.hypot(*arms.T) == pytest.approx(np.full(51, found.radius), rel=1e-12)
    assert path.twists[:, 2] == pytest.approx(np.full(51, found.twist[2]))
    whole = found.poses(2 * np.pi / abs(found.twist[2]), start)
    assert whole[:2] == pytest.approx(start[:2], abs=1e-12)
    assert abs(whole[2] - start[2]) == pytest.approx(2 * np.pi)


def test_a_straight_line():
    feet = ContactSet([[0, 1], [0, -1], [1, 0]], [0.1, 0.1, 0.3], [[1, 0], [1, 0], [0, 0]])
    found = steady_walk(feet, DRAG)
    assert found.twist == pytest.approx([(2.0 - 0.5) / 2.0, 0.0, 0.0], abs=1e-14)
    path = walk(feet, 4.0, drag=DRAG, pose=(0.0, 0.0, np.pi / 6), frames=8)
    along = path.times * 0.75
    assert path.poses[:, :2] == pytest.approx(along[:, None] * [np.sqrt(0.75), 0.5], abs=1e-13)
    assert "0.75 m/s" in repr(found)


@pytest.mark.parametrize("omega", [0.0, 1e-300, -1e-12, 1e-8, -1e-4, 1e-2, 1.0, -7.0])
def test_the_exponential_has_no_small_angles(omega):
    """Beside 50 digits: no error grows as the turn vanishes."""
    vx, vy, t = 0.3, -1.1, 2.7
    with mpmath.workdps(350):
        phi = mpmath.mpf(omega) * mpmath.mpf(t)
        s = mpmath.sin(phi) / phi if phi else mpmath.mpf(1)
        c = (1 - mpmath.cos(phi)) / phi if phi else mpmath.mpf(0)
        exact = [float(t * (s * vx - c * vy)), float(t * (c * vx + s * vy))]
    found = displacement(np.array([vx, vy, omega]), np.array(t))
    assert np.abs(found[:2] - exact).max() < 4e-15 * (1.0 + abs(omega))


@pytest.mark.parametrize(
    ("margin", "outcome"), [(1.0 - 1e-9, Outcome.TIME_LIMIT), (1.0 + 1e-9, Outcome.REST)]
)
def test_friction_above_the_push_holds_the_walker(margin, outcome):
    """Two feet push 1 N each; passive feet hold 2 N in all from their friction radii on."""
    places = [[0, 1], [0, -1], [1, 1], [1, -1]]
    feet = ContactSet(places, [0, 0, margin, margin], [[1, 0], [1, 0], [0, 0], [0, 0]])
    path = walk(feet, 2.0, drag=DRAG)
    assert path.outcome is outcome
    found = steady_walk(feet, DRAG)
    if outcome is Outcome.REST:
        assert path.times.tolist() == [0.0]
        assert [e.kind for e in path.events] == [EventKind.REST]
        assert not path.twists.any()
        assert found.held
        assert found.projection.status == Status.INSIDE
        assert np.isnan(found.radius)
        assert found.center is None
        assert found.load == pytest.approx(np.zeros(3), abs=1e-12)
        assert repr(found) == "SteadyWalk(held)"
    else:
        assert found.twist[0] == pytest.approx(1e-9, rel=1e-3)
        assert path.duration == 2.0


def legs(side, push=1.0):
    """Return a left (1) or right (-1) leg that pushes forwards, and passive feet."""
    places = [[0.0, side], [0.5, 1.0], [0.5, -1.0]]
    return ContactSet(places, [0.1, 0.05, 0.05], [[push, 0.0], [0.0, 0.0], [0.0, 0.0]])


def test_a_gait_of_alternating_legs_is_a_chain_of_arcs():
    left, right = legs(1.0), legs(-1.0)
    gait = Schedule([(0.0, left), (0.4, right)], period=0.8)
    path = walk(gait, 8.0, drag=DRAG, pose=(0.1, 0.2, 0.3), frames=160)
    one = displacement(steady_walk(left, DRAG).twist, np.array(0.4))
    two = displacement(steady_walk(right, DRAG).twist, np.array(0.4))
    cycle, pose = compose(one, two), np.array([0.1, 0.2, 0.3])
    assert abs(one[2]) > 0.05
    assert cycle[2] == pytest.approx(0.0, abs=1e-14)  # mirrored legs turn the body back
    for k in range(10):
        row = np.argmin(np.abs(path.times - 0.8 * k))
        assert path.poses[row] == pytest.approx(pose, abs=1e-13)
        pose = compose(pose, cycle)
    assert path.final_pose == pytest.approx(pose, abs=1e-12)
    assert [e.kind for e in path.events] == [EventKind.SWITCH] * 19
    assert [e.time for e in path.events] == pytest.approx(0.4 * np.arange(1, 20))
    assert np.all(np.diff(path.times) > 0.0)


def test_a_gait_agrees_with_integration_through_its_switches():
    gait = Schedule([(0.0, legs(1.0)), (0.3, legs(-1.0, 2.0))], period=0.5)
    path = walk(gait, 1.2, drag=DRAG, frames=12)
    pose = np.zeros(3)
    for begin, end, feet in gait.pieces(1.2):
        solved = solve_ivp(
            lambda _, q, feet=feet: world_twist(feet, q),
            (begin, end),
            pose,
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
        )
        pose = solved.y[:, -1]
    assert path.final_pose == pytest.approx(pose, abs=1e-11)


def test_held_phases_of_a_gait():
    held = ContactSet([[0.0, 0.0]], 1.0)
    go = legs(1.0)
    halts = walk(Schedule([(0.0, held), (1.0, go), (2.0, held), (3.0, held)]), 9.0, drag=DRAG)
    assert halts.outcome is Outcome.REST
    assert halts.duration == 2.0
    assert [(e.time, e.kind.name) for e in halts.events] == [
        (0.0, "REST"),
        (1.0, "SWITCH"),
        (1.0, "START"),
        (2.0, "SWITCH"),
        (2.0, "REST"),
    ]
    assert not halts.twists[-1].any()
    assert halts.final_pose == pytest.approx(walk(go, 1.0, drag=DRAG).final_pose, abs=1e-14)
    again = walk(Schedule([(0.0, go), (1.0, held)], period=2.0), 3.5, drag=DRAG)
    assert again.outcome is Outcome.TIME_LIMIT  # it would go on
    assert again.duration == 3.5
    assert again.poses[-1] == pytest.approx(walk(go, 2.0, drag=DRAG).final_pose, abs=1e-13)
    early = walk(Schedule([(0.0, go), (1.0, held)]), 0.5, drag=DRAG)
    assert early.outcome is Outcome.TIME_LIMIT
    assert not early.events
    never = walk(Schedule([(0.0, held), (1.0, held)], period=2.0), 5.0, drag=DRAG)
    assert never.outcome is Outcome.REST
    assert never.duration == 0.0


def test_frames_do_not_matter(rng):
    feet, shift = walker(rng), np.array([3.0, -1.0, 2.2])
    near = walk(feet, 2.0, drag=DRAG, frames=7)
    far = walk(feet, 2.0, drag=DRAG, pose=shift, frames=7)
    assert far.poses == pytest.approx(compose(shift, near.poses), abs=1e-12)
    assert far.loads == pytest.approx(to_world(near.loads, 2.2), abs=1e-12)
    # other body axes, turned by 0.9: the same motion of the same body
    turned = walk(in_world(feet, [0, 0, 0.9]), 2.0, drag=DRAG, pose=(0, 0, -0.9), frames=7)
    assert turned.poses[:, :2] == pytest.approx(near.poses[:, :2], abs=1e-12)
    assert turned.poses[:, 2] + 0.9 == pytest.approx(near.poses[:, 2], abs=1e-12)


def test_energy_adds_up(rng):
    feet, load = walker(rng), np.array([0.1, -0.2, 0.1])
    gait = Schedule([(0.0, feet), (0.7, legs(1.0))], period=1.1)
    path = walk(gait, 3.0, drag=DRAG, load=load, frames=30)
    energy = path.energy
    assert energy.friction[-1] > 0.1
    assert np.abs(energy.residual).max() < 1e-11 * energy.work[-1]
    v = steady_walk(feet, DRAG, load).twist
    x, y = feet.position.T
    slip = feet.radius @ np.hypot(v[0] - v[2] * y, v[1] + v[2] * x)
    row = np.argmin(np.abs(path.times - 0.7))
    assert energy.friction[row] == pytest.approx(0.7 * slip, rel=1e-11)
    drag = quad(lambda _: DRAG @ v**2, 0.0, 0.7)[0]
    assert energy.drag[row] == pytest.approx(drag, rel=1e-11)


def test_wheels_and_polygons_walk_too():
    """A narrow ellipse across the way, a wheel, lets the body roll; polygons approach disks."""
    places, pushes = [[0, 1], [0, -1], [1, 0]], [[1, 0], [1, 0], [0, 0]]
    wheel = np.array([np.eye(2), np.eye(2), np.diag([0.01, 1.0])])
    rolls = steady_walk(ContactSet(places, [0.1, 0.1, 5.0], pushes, ellipse=wheel), DRAG)
    assert rolls.twist == pytest.approx([(2.0 - 0.2 - 0.05) / 2.0, 0.0, 0.0], abs=1e-12)
    assert steady_walk(ContactSet(places, [0.1, 0.1, 5.0], pushes), DRAG).held
    round_feet, many = legs(1.0), 200
    sides = ContactSet(round_feet.position, round_feet.radius, round_feet.offset, sides=many)
    gap = np.abs(steady_walk(sides, DRAG).twist - steady_walk(round_feet, DRAG).twist).max()
    assert 0.0 < gap < 1e-3


def test_there_and_back(rng):
    poses, moves = rng.normal(size=(2, 20, 3))
    assert to_body(to_world(moves, poses[:, 2]), poses[:, 2]) == pytest.approx(moves)
    assert compose(poses, np.zeros(3)) == pytest.approx(poses)


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"contacts": [[0.0, 0.0]]}, "contacts"),
        ({"contacts": Schedule([(0.0, legs(1.0)), (1.0, "left")])}, "contacts"),
        ({"duration": 0.0}, "duration"),
        ({"duration": np.inf}, "duration"),
        ({"duration": "long"}, "duration"),
        ({"drag": (1.0, 1.0, 0.0)}, "drag"),
        ({"drag": 1.0}, "drag"),
        ({"pose": (0.0, 0.0)}, "pose"),
        ({"load": (0.0, np.nan, 0.0)}, "load"),
        ({"frames": 0}, "frames"),
        ({"frames": 2.5}, "frames"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    good = {"contacts": legs(1.0), "duration": 1.0, "drag": DRAG}
    with pytest.raises(InputError) as found:
        walk(**(good | changed))
    assert found.value.argument == argument


def test_whole_numbers_of_numpy_are_whole_numbers():
    assert len(walk(legs(1.0), 1.0, drag=DRAG, frames=np.int64(3)).times) == 4


def test_the_papers_rule_is_the_default():
    feet = ContactSet([[0.0, 1.0], [0.0, -1.0]], 0.1, [[1.0, 0.0], [0.6, 0.0]])
    path, steady = walk(feet, 2.0), steady_walk(feet)
    assert path.twists[0] == pytest.approx(steady.load)
    assert path.final_pose == pytest.approx(walk(feet, 2.0, drag=(1, 1, 1)).final_pose)
