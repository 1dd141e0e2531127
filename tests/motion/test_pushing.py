"""Parts pushed at one sticking point: least dissipation, and where it leads."""

import cvxpy as cp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.motion.pushing import push, push_along
from limitsurf.motion.rigid_motion import compose


def random_contacts(rng, kind, n=7):
    places, radius = rng.normal(size=(n, 2)), rng.uniform(0.1, 1.0, n)
    if kind == "disks":
        return ContactSet(places, radius)
    if kind == "ellipses":
        return ContactSet(places, radius, ellipse=rng.normal(size=(n, 2, 2)))
    return ContactSet(places, radius, 0.2 * rng.normal(size=(n, 2)))


KINDS = ("disks", "ellipses", "active")


def dissipated(contacts, r, u, omega):
    """Return ``h_L(-v)``: friction, less what active contacts give."""
    v = np.array([u[0] + omega * r[1], u[1] - omega * r[0], omega])
    return float(contacts.limit_surface().support(-v))


@pytest.mark.parametrize("kind", KINDS)
def test_dissipation_is_least(rng, kind):
    """Beside a search that only knows the support function."""
    for _ in range(30):
        contacts, (r, u) = random_contacts(rng, kind), rng.normal(size=(2, 2))
        found = push(contacts, r, u)
        omega = found.twist[2]
        slow = minimize_scalar(
            lambda w, c=contacts, r=r, u=u: dissipated(c, r, u, w),
            bracket=(-1.0, 1.0),
            options={"xtol": 1e-12},
        )
        assert dissipated(contacts, r, u, omega) <= slow.fun * (1 + 1e-14) + 1e-14
        assert omega == pytest.approx(slow.x, abs=1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_forces_prove_it(rng, kind):
    """A load of the limit surface without moment about the point, with the dissipated power."""
    for _ in range(50):
        contacts, (r, u) = random_contacts(rng, kind), rng.normal(size=(2, 2))
        found = push(contacts, r, u)
        fx, fy, m = found.load
        assert m - (r[0] * fy - r[1] * fx) == pytest.approx(0.0, abs=1e-13)
        assert contacts.limit_surface().distance(found.load) < 1e-10
        assert found.force == pytest.approx(-found.load[:2])
        assert found.force @ u == pytest.approx(
            dissipated(contacts, r, u, found.twist[2]), rel=1e-12, abs=1e-13
        )
        assert found.error_bound < 1e-13
        point = found.twist[:2] + found.twist[2] * np.array([-r[1], r[0]])
        assert point == pytest.approx(u, abs=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_the_conic_dual_agrees(rng, kind):
    """No load of the limit surface without moment about the point does more against the push."""
    contacts, (r, u) = random_contacts(rng, kind), rng.normal(size=(2, 2))
    F = cp.Variable(3)
    balanced = [F[2] - (r[0] * F[1] - r[1] * F[0]) == 0.0]
    program = cp.Problem(
        cp.Maximize(-F[:2] @ u), [*contacts.limit_surface().constraints(F), *balanced]
    )
    program.solve(solver=cp.CLARABEL)
    found = push(contacts, r, u)
    assert found.force @ u == pytest.approx(program.value, rel=1e-6)


def test_a_contact_can_be_the_center_of_rotation(rng):
    """A bar on two feet, pushed across beyond one of them, turns about the other; as it is."""
    for _ in range(50):
        far, near, r = -1.0, rng.uniform(0.2, 1.0), rng.uniform(1.0, 2.0)
        theta, speed = rng.uniform(-np.pi, np.pi), rng.uniform(0.1, 3.0)
        e, across = (
            np.array([np.cos(theta), np.sin(theta)]),
            np.array([-np.sin(theta), np.cos(theta)]),
        )
        bar = ContactSet([far * e, near * e], [1.0, 0.4])
        found = push(bar, r * e, speed * across)
        assert found.twist[2] == pytest.approx(speed / (r - far), rel=4e-15)
        # the far foot holds what balances the moment about the pushed point
        held = -0.4 * (r - near) / (r - far)
        assert found.force @ across == pytest.approx(0.4 + held, abs=1e-12)
        assert found.error_bound < 1e-14


def test_where_many_rates_are_minimal_the_least_is_taken():
    bar = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.5)
    for u in ([0.0, 0.3], [0.0, -0.3]):
        found = push(bar, [0.0, 0.0], u)  # any centre of rotation beyond the feet does as well
        assert found.twist == pytest.approx([*u, 0.0], abs=1e-15)
        assert found.force @ u == pytest.approx(0.3)
    under = push(ContactSet([[1.0, 2.0]], 0.5), [1.0, 2.0], [0.0, 2.0])
    assert under.twist.tolist() == [0.0, 2.0, 0.0]
    assert under.force == pytest.approx([0.0, 0.5])
    assert not push(bar, [0.3, 0.4], [0.0, 0.0]).twist.any()
    assert not push(ContactSet(np.empty((0, 2)), []), [0.3, 0.4], [1.0, 0.0]).force.any()


def test_active_contacts_help(rng):
    """A push of the contacts turns the part; more than friction can stop is refused."""
    places, radius = [[0.0, 1.0], [0.0, -1.0]], [0.5, 0.5]
    turn = [[-0.3, 0.0], [0.3, 0.0]]
    found = push(ContactSet(places, radius, turn), [0.0, 0.0], [1.0, 0.0])
    assert found.twist[2] > 0.1
    with pytest.raises(InputError, match=r"contacts: turn the part .* with 1 N m"):
        push(ContactSet(places, radius, [[-0.5, 0.0], [0.5, 0.0]]), [0.0, 0.0], [1.0, 0.0])


@pytest.mark.parametrize("kind", ["disks", "ellipses"])
def test_the_motion_scales(rng, kind):
    contacts, (r, u) = random_contacts(rng, kind), rng.normal(size=(2, 2))
    found = push(contacts, r, u)
    slower = push(contacts, r, -0.01 * u)
    slick = push(
        ContactSet(contacts.position, 0.1 * contacts.radius, ellipse=contacts.ellipse), r, u
    )
    assert slower.twist == pytest.approx(-0.01 * found.twist, abs=1e-14)
    assert slower.force == pytest.approx(-found.force, abs=1e-12)
    assert slick.twist == pytest.approx(found.twist, abs=1e-13)
    assert slick.force == pytest.approx(0.1 * found.force, abs=1e-13)


def tractrix(steps, segments=10):
    """Return the error of the angle of a caster pulled over three times its length."""
    path = np.linspace([0.0, 1.0], [3.0, 1.0], segments + 1)
    angle = push_along(ContactSet([[0.0, 0.0]], 2.0), path, steps=steps).poses[:, 2]
    exact = 2 * np.arctan(np.exp(-path[:, 0])) - np.pi / 2
    return np.abs(angle - exact).max()


def test_a_tractrix_converges_with_order_four():
    errors = np.array([tractrix(n) for n in (1, 2, 4, 8)])
    assert errors[-1] < 1e-8
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([4.0] * 3, abs=0.3)


def body_rate(contacts, r, theta, u):
    c, s = np.cos(theta), np.sin(theta)
    return push(contacts, r, [c * u[0] + s * u[1], c * u[1] - s * u[0]]).twist[2]


@pytest.mark.parametrize("kind", KINDS)
def test_paths_agree_with_integrated_rates(rng, kind):
    contacts = random_contacts(rng, kind)
    pose, r = np.array([0.2, -0.3, 0.8]), np.array([0.6, 1.1])
    begin = compose(pose, np.array([*r, 0.0]))[:2]
    path = begin + np.array([[0.0, 0.0], [0.4, 0.3], [0.5, 0.9], [0.1, 1.2]])
    found = push_along(contacts, path, pose, steps=400)
    theta = pose[2]
    for k, u in enumerate(np.diff(path, axis=0)):
        solved = solve_ivp(
            lambda _, q, u=u: [body_rate(contacts, r, q[0], u)],
            (0.0, 1.0),
            [theta],
            method="DOP853",
            rtol=1e-9,
            atol=1e-9,
        )
        theta = solved.y[0, -1]
        assert found.poses[k + 1, 2] == pytest.approx(theta, abs=2e-6)
    arms = compose(found.poses, np.broadcast_to([*r, 0.0], (4, 3)))[:, :2]
    assert arms == pytest.approx(path, abs=1e-14)  # the point follows its path


def test_kinks_lower_the_order_to_two():
    """A foot becomes the centre of rotation on the way; where in a step it does is chance."""
    feet = ContactSet([[1.0, 0.0], [-1.0, 0.5], [-0.2, -1.0]], [0.5, 1.0, 0.7])
    path = np.linspace([1.5, 0.0], [1.5, 3.0], 4)
    exact = push_along(feet, path, steps=20_000).final_pose[2]

    def spread(first):
        found = [push_along(feet, path, steps=n).final_pose[2] for n in range(first, 2 * first + 8)]
        return np.sqrt(np.mean((np.array(found) - exact) ** 2))

    coarse, fine = spread(8), spread(32)
    assert coarse < 1e-5
    assert np.log(coarse / fine) / np.log(4) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("kind", KINDS)
def test_energy_and_records_of_a_path(rng, kind):
    contacts = random_contacts(rng, kind)
    path = np.linspace([0.5, 0.5], [1.0, 1.5], 21)
    times = np.linspace(0.0, 3.0, 21) ** 1.5
    found = push_along(contacts, path, times=times, steps=8)
    energy = found.energy
    assert energy.friction[-1] > 0.1
    assert np.abs(energy.residual).max() < 1e-13 * energy.friction[-1]
    assert np.all(np.diff(energy.friction) > 0.0)
    assert found.worst_error < 1e-14
    # twists are those of the poses, and power that of friction against them
    slopes = np.diff(found.poses, axis=0) / np.diff(times)[:, None]
    middle = 0.5 * (found.twists[:-1] + found.twists[1:])
    duration = np.diff(times)
    speed_up = np.linalg.norm(np.diff(path, axis=0), axis=1) / duration
    assert np.abs(slopes - middle)[2:-1].max() < 0.3 * np.ptp(speed_up)
    for pose, twist, load in zip(found.poses, found.twists, found.loads, strict=True):
        c, s = np.cos(pose[2]), np.sin(pose[2])
        body = np.array([c * twist[0] + s * twist[1], c * twist[1] - s * twist[0], twist[2]])
        power = contacts.limit_surface().support(-body)
        assert -load @ twist == pytest.approx(power, rel=1e-11)


def test_paths_do_not_depend_on_frames_or_times(rng):
    contacts, g = random_contacts(rng, "disks"), np.array([2.0, 1.0, 2.5])
    path = np.array([[0.5, 0.5], [0.7, 0.8], [0.6, 1.2]])
    near = push_along(contacts, path)
    there = compose(g, np.column_stack([path, np.zeros(3)]))[:, :2]
    far = push_along(contacts, there, g, times=[0.0, 0.1, 5.0])
    assert far.poses == pytest.approx(compose(g, near.poses), abs=1e-12)
    assert near.times.tolist() == [0.0, 1.0, 2.0]
    finer = push_along(contacts, np.array([path[0], 0.5 * (path[0] + path[1]), *path[1:]]), steps=8)
    assert finer.final_pose == pytest.approx(near.final_pose, abs=1e-4)
    still = push_along(contacts, path[:1])
    assert still.final_pose == pytest.approx(np.zeros(3), abs=1e-15)


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"contacts": "feet"}, "contacts"),
        ({"contacts": ContactSet([[0.0, 0.0]], 1.0, sides=8)}, "contacts"),
        ({"path": np.empty((0, 2))}, "path"),
        ({"path": [[0.0, np.nan]]}, "path"),
        ({"pose": 1.0}, "pose"),
        ({"times": [0.0, 1.0, 2.0]}, "times"),
        ({"times": [0.0, 0.0]}, "times"),
        ({"steps": 0}, "steps"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    good = {"contacts": ContactSet([[0.0, 0.0]], 1.0), "path": [[0.0, 1.0], [1.0, 1.0]]}
    with pytest.raises(InputError) as found:
        push_along(**(good | changed))
    assert found.value.argument == argument


def test_points_and_velocities_are_checked():
    contacts = ContactSet([[0.0, 0.0]], 1.0)
    for point, velocity, argument in (([0.0], [1.0, 0.0], "point"), ([0.0, 0.0], "up", "velocity")):
        with pytest.raises(InputError) as found:
            push(contacts, point, velocity)
        assert found.value.argument == argument
