"""What drives a part on an array: schedules, functions of time, loads, tilt, drag."""

from dataclasses import replace

import numpy as np
import pytest
import xarray
from scipy.constants import g

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.actuators.carrying import carry
from limitsurf.actuators.force_fields import squeeze_field
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part
from limitsurf.kernels.slide import slide
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.load_table import LoadTable
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.simulate import simulate
from limitsurf.motion.trajectory import EventKind, Outcome

SYMMETRIC_Y = (-5e-5, 0.0)


def all_towards(array, direction):
    return Activation(array, array.site_directions @ np.array(direction) > 0.5)


def with_pixel(array, **changes):
    return replace(array, pixel=replace(array.pixel, **changes))


@pytest.fixture(scope="module")
def square():
    return Part([(0, 0), (2e-3, 0), (2e-3, 2e-3), (0, 2e-3)], "80 g/m^2")


@pytest.fixture(scope="module")
def gripping(array64):
    """An array of which running tips also hold: push 0.1, grip 0.05 of mu N."""
    return with_pixel(array64, residual_fraction=0.05)


def test_a_schedule_goes_there_and_back(gripping, square):
    right, left = all_towards(gripping, (1, 0)), all_towards(gripping, (-1, 0))
    plan = Schedule([(0.0, right), (0.1, left)])
    path = simulate(square, plan, (0.0, *SYMMETRIC_Y), 0.2, mode="quasi-static", time_step=1e-3)
    turn = path.at(0.1)
    assert turn[0] > 1e-4
    assert path.final_pose[0] == pytest.approx(0.0, abs=2e-6)
    assert [e.kind for e in path.events] == [EventKind.SWITCH]
    assert path.events[0].time == pytest.approx(0.1)
    there = simulate(square, right, (0.0, *SYMMETRIC_Y), 0.1, mode="quasi-static", time_step=1e-3)
    assert turn == pytest.approx(there.final_pose, abs=1e-12)


def test_a_function_of_time_is_the_schedule_it_says(gripping, square):
    right, up = all_towards(gripping, (1, 0)), all_towards(gripping, (0, 1))
    plan = Schedule([(0.0, right), (0.05, up)])
    start = (0.0, *SYMMETRIC_Y)
    one = simulate(square, plan, start, 0.1, time_step=1e-3)
    other = simulate(square, plan.at, start, 0.1, time_step=1e-3)
    assert other.final_pose == pytest.approx(one.final_pose, abs=1e-12)
    assert [e.kind for e in other.events] == [EventKind.SWITCH]
    assert np.abs(other.energy.residual).max() < 1e-10 * other.energy.work.max()


def test_a_part_that_rests_waits_for_the_next_activation(array64, square):
    strong = with_pixel(array64, offset_fraction=0.1, residual_fraction=0.2)
    hold = all_towards(strong, (1, 0))
    move = all_towards(with_pixel(strong, residual_fraction=0.0), (1, 0))
    plan = Schedule([(0.0, hold), (0.05, move)])
    path = simulate(square, plan, (0.0, *SYMMETRIC_Y), 0.1)
    kinds = [EventKind.REST, EventKind.SWITCH, EventKind.START]
    assert [e.kind for e in path.events] == kinds
    assert [e.time for e in path.events] == [0.0, 0.05, 0.05]
    assert path.at(0.05) == pytest.approx(path.poses[0], abs=0.0)
    assert path.outcome is Outcome.TIME_LIMIT


def test_a_tilted_array_holds_up_to_its_grip(array64, square):
    """Tips that grip hold a part up to tan(tilt) = grip; beyond, it slides at the drag's speed."""
    array = with_pixel(array64, offset_fraction=0.0, residual_fraction=1.0)
    drive, mu = all_towards(array, (1, 0)), array64.pixel.friction
    for share, outcome in ((1 - 1e-4, Outcome.REST), (1 + 1e-4, Outcome.TIME_LIMIT)):
        angle = np.arctan(mu * share)
        tilt = (-angle, 0.0)
        path = simulate(square, drive, (0, *SYMMETRIC_Y), 0.1, mode="quasi-static", tilt=tilt)
        assert path.outcome is outcome
    speed = square.mass * g * (np.sin(angle) - mu * np.cos(angle))
    speed /= air_film_drag(square, array)[0]
    assert path.twists[0, :2] == pytest.approx([-speed, 0.0], rel=1e-2, abs=1e-12)


def test_an_external_load_adds_to_the_push(gripping, square):
    drive = all_towards(gripping, (1, 0))
    start, weight = (-1e-3, *SYMMETRIC_Y), square.mass * g
    free = simulate(square, drive, start, 0.05, mode="quasi-static")
    pulled = simulate(
        square, drive, start, 0.05, mode="quasi-static", load=(-0.3 * 0.03 * weight, 0, 0)
    )
    grip = 0.05 * gripping.pixel.friction
    assert free.twists[0, 0] / pulled.twists[0, 0] == pytest.approx((0.03 - grip) / (0.021 - grip))


def test_a_load_that_swings_drags_a_held_part_along(array64, square):
    """Stick-slip: at rest bit for bit while the load is below the grip, and it moves above."""
    array = with_pixel(array64, offset_fraction=0.0, residual_fraction=1.0)
    limit = array.pixel.friction * square.mass * g

    def swing(t):
        return (1.5 * limit * np.sin(40 * np.pi * t), 0.0, 0.0)

    path = simulate(
        square, all_towards(array, (1, 0)), (0, *SYMMETRIC_Y), 0.05, load=swing, time_step=5e-5
    )
    x = path.poses[:, 0]
    slips = np.abs(1.5 * np.sin(40 * np.pi * (path.times + 5e-5))) > 1.01
    rests = path.times < np.arcsin(1 / 1.5) / (40 * np.pi) - 1e-4
    assert np.all(x[rests] == 0.0)
    assert np.ptp(x[slips]) > 1e-5
    assert path.outcome is Outcome.TIME_LIMIT
    assert np.abs(path.energy.residual).max() < 1e-10 * np.abs(path.energy.work).max()


def test_the_energies_add_up_with_the_dissipation_of_the_support_function(gripping, paper_t):
    """The discrete identity, with friction by ``h_L(-v)`` of every step computed here."""
    drive, start, dt = all_towards(gripping, (0, 1)), (3e-4, -2e-4, 0.9), 1e-3
    for mode in ("inertial", "quasi-static"):
        path = simulate(
            paper_t, drive, start, 0.05, mode=mode, time_step=dt, frames=1000, load=(1e-8, 0, 1e-11)
        )
        assert path.times[:-1] == pytest.approx(dt * np.arange(len(path.times) - 1))
        steps = zip(path.poses[:-1], path.twists[:-1], strict=True)
        lost = [friction_power(drive, paper_t, pose, v) * dt for pose, v in steps]
        assert path.energy.friction[1:] == pytest.approx(np.cumsum(lost), rel=1e-9)
        size = path.energy.work.max()
        assert np.abs(path.energy.residual).max() < 1e-12 * size
        assert path.energy.numerical[-1] > 0.0 if mode == "inertial" else True


def friction_power(drive, part, pose, v):
    """Return h_L(-v) of the tips' friction disks, shares at the outline by distance."""
    import shapely

    array, pixel = drive.array, drive.array.pixel
    rows, columns = np.nonzero(drive.active)
    points = np.array(array.first_site) + array.site_pitch * np.column_stack([columns, rows])
    outline = part.at(pose)
    distance = shapely.distance(shapely.boundary(outline), shapely.points(points))
    inside = shapely.contains_xy(outline, points)
    share = np.clip(0.5 + np.where(inside, distance, -distance) / pixel.tip_width, 0, 1)
    arms = points - pose[:2]
    speed = np.hypot(v[0] - v[2] * arms[:, 1], v[1] + v[2] * arms[:, 0])
    grip = pixel.friction * pixel.residual_fraction * part.mass * g / share.sum()
    return grip * share @ speed


def test_adaptive_steps_converge_with_the_tolerance(array64, paper_t):
    drive, start = squeeze_activation(array64, 0.0), (2e-4, 8e-4, 1.2)
    exact = simulate(paper_t, drive, start, 0.4, time_step=2e-5, frames=1).final_pose
    errors = []
    tolerances = (1e-4, 1e-5, 1e-6, 1e-7)
    for tolerance in tolerances:
        end = simulate(paper_t, drive, start, 0.4, tolerance=tolerance, frames=1).final_pose
        errors.append(np.abs((end - exact) / [1e-3, 1e-3, 1.0]).max())
    order = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert errors[3] < 1e-4
    assert 0.4 < order < 0.7  # first-order steps: local errors h^2, global ones their root


def test_tips_of_the_first_activation_are_those_of_carry(gripping, paper_t):
    drive, start = squeeze_activation(with_pixel(gripping, tip_width=0.0), 0.3), (1e-4, 2e-4, 0.5)
    path = simulate(paper_t, drive, start, 0.01, mode="quasi-static", frames=1)
    assert path.tips[0] == carry(drive, paper_t, start).active


def test_no_drag_is_for_inertial_motion_only(array64, square):
    drive = all_towards(array64, (1, 0))
    free = simulate(square, drive, (-2e-3, *SYMMETRIC_Y), 0.02, drag=(0, 0, 0), time_step=1e-4)
    pixel = array64.pixel
    acceleration = g * pixel.friction * (pixel.offset_fraction - pixel.residual_fraction)
    assert free.twists[-1, 0] == pytest.approx(acceleration * 0.02, rel=1e-6)
    with pytest.raises(InputError, match="drag: must be positive in quasi-static mode"):
        simulate(square, drive, mode="quasi-static", drag=(0, 0, 0))


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"load": lambda t: (0, 0, 0)}, "duration"),
        ({"load": (0, 0)}, "load"),
        ({"tilt": (2.0, 0.0)}, "tilt"),
        ({"drag": (-1, 1, 1)}, "drag"),
        ({"method": "magic"}, "method"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"drive": 3}, "drive"),
        ({"drive": lambda t: None}, "drive"),
        ({"drive": squeeze_field(0.0)}, "drive"),
        ({"load": LoadTable(lambda t: (1e-9 * t, 0, 0), 0.1)}, "duration"),
        ({"load": LoadTable(lambda t: (1e-9 * t, 0, 0), 0.1), "tilt": (0.01, 0.0)}, "duration"),
        ({"load": LoadTable(lambda t: (1e-9 * t, 0, 0), 0.1), "duration": 0.2}, "load"),
        ({"duration": [1.0, 2.0]}, "duration"),
        ({"tip": "resonator"}, "tip"),
    ],
)
def test_bad_arguments_are_named(array64, paper_t, arguments, name):
    arguments = {"drive": squeeze_activation(array64, 0.0)} | arguments
    with pytest.raises(InputError) as caught:
        simulate(paper_t, **arguments)
    assert caught.value.argument == name


def test_a_schedule_that_goes_back_in_time_is_named():
    with pytest.raises(InputError, match="goes back in time"):
        Schedule([(0.0, "a"), (2.0, "b"), (1.0, "c")])
    with pytest.raises(InputError, match="goes back in time"):
        Schedule([(0.0, "a"), (2.0, "b")], period=2.0)
    with pytest.raises(InputError, match="must start at 0"):
        Schedule([(1.0, "a")])
    with pytest.raises(InputError, match="no entries"):
        Schedule([])


def test_an_activation_of_the_wrong_shape_is_named(array64):
    with pytest.raises(InputError, match="active: must be bool of shape"):
        Activation(array64, np.ones((3, 3), bool))


def test_an_interrupted_motion_leaves_a_readable_file(array64, paper_t, tmp_path):
    drive, file = squeeze_activation(array64, 0.0), tmp_path / "run.nc"

    def interrupt(t):
        if t > 0.05:
            raise KeyboardInterrupt
        return drive

    with pytest.raises(KeyboardInterrupt):
        simulate(paper_t, interrupt, (2e-4, 8e-4, 1.2), 1.0, save=file)
    with xarray.open_dataset(file, engine="scipy") as data:
        assert data.attrs["outcome"] == "interrupted"
        assert 0.04 < float(data.time[-1]) <= 0.06
        assert np.isfinite(data.poses.values).all()
    whole = simulate(paper_t, drive, (2e-4, 8e-4, 1.2), 0.1, save=file, progress=True)
    with xarray.open_dataset(file, engine="scipy") as data:
        assert data.poses.values == pytest.approx(whole.poses)
        assert data.attrs["outcome"] == "still moving at the time limit"


def test_poses_between_frames_do_not_overshoot(array64, paper_t):
    path = simulate(paper_t, squeeze_activation(array64, 0.0), (2e-4, 8e-4, 1.2))
    assert path.at(path.times) == pytest.approx(path.poses, abs=1e-15)
    y = path.at(np.linspace(0, path.duration, 500))[:, 1]
    assert y.min() >= path.poses[:, 1].min()
    with pytest.raises(InputError, match="times: must lie in"):
        path.at(path.duration + 1.0)


def test_drives_that_turn_out_to_be_none_are_named(array64, paper_t):
    drive = squeeze_activation(array64, 0.0)
    for wrong in (lambda t: drive if t < 0.01 else None, Schedule([(0.0, drive), (0.01, "on")])):
        with pytest.raises(InputError) as found:
            simulate(paper_t, wrong, (0.0, 1e-3, 1.0), 0.05)
        assert found.value.argument == "drive"


def test_equal_activations_are_no_switch(array64, paper_t):
    drive, start = squeeze_activation(array64, 0.0), (0.0, 1e-3, 1.0)
    same = simulate(paper_t, lambda t: Activation(array64, drive.active.copy()), start, 0.05)
    assert same.events == ()
    alone = simulate(paper_t, drive, start, 0.05)
    assert same.final_pose == pytest.approx(alone.final_pose, abs=1e-9)


@pytest.mark.parametrize("tolerance", [None, 1e-4])
def test_frames_rise_through_rests_and_switches(gripping, paper_t, tolerance):
    one, other = squeeze_activation(gripping, 0.0), squeeze_activation(gripping, np.pi / 2)
    start, strong = (0.0, 1e-3, 1.0), squeeze_activation(with_pixel(gripping), 1.0)
    alone = simulate(paper_t, one, start, 4.0, tolerance=tolerance)
    assert alone.outcome is Outcome.REST
    plan = Schedule([(0.0, one), (4.0, strong), (4.1, one), (4.2, other)])
    path = simulate(paper_t, plan, start, 4.5, tolerance=tolerance)
    assert (np.diff(path.times) > 0.0).all()
    assert path.at(3.999999) == pytest.approx(alone.final_pose, abs=1e-9)
    asked = simulate(paper_t, lambda t: one, start, 8.0, tolerance=tolerance)
    assert (np.diff(asked.times) > 0.0).all()
    assert asked.outcome is Outcome.REST
    assert asked.times[-2] < 4.0  # it waits without frames
    late = simulate(paper_t, lambda t: one if t < 7.0 else strong, start, 7.5, tolerance=tolerance)
    held = late.at(np.linspace(alone.duration + 0.5, 7.0, 20))
    assert held == pytest.approx(np.tile(held[0], (20, 1)), abs=1e-9)


def test_loads_of_frames_at_a_switch_are_those_that_follow(gripping, square):
    right, left = all_towards(gripping, (1, 0)), all_towards(gripping, (-1, 0))
    plan = Schedule([(0.0, right), (0.05, left)])
    path = simulate(
        square, plan, (0.0, *SYMMETRIC_Y), 0.1, mode="quasi-static", time_step=1e-3, frames=2
    )
    assert path.times == pytest.approx([0.0, 0.05, 0.1])
    assert np.sign(path.loads[:, 0]).tolist() == [1, -1, -1]


def test_two_tips_a_pixel_carry_what_one_cannot(square):
    per_pixel = square.areal_density * g * load_array("resonator64").pixel.pitch ** 2
    volts = load_array("resonator64").pixel.lifting_voltage(0.75 * per_pixel)
    array = load_array("resonator64", voltage=volts)
    right, up = all_towards(array, (1, 0)), all_towards(array, (0, 1))
    with pytest.raises(PartTooHeavy):
        simulate(square, right, duration=0.01)
    both = Activation(array, right.active | up.active)
    path = simulate(square, both, duration=0.01)
    assert path.outcome is Outcome.TIME_LIMIT
    assert (path.twists[-1, :2] > 0.0).all()


def test_layouts_of_arrays_do_not_compile_anew(array64, paper_t):
    drive = squeeze_activation(array64, 0.0)
    simulate(paper_t, drive, duration=0.01)
    compiled = len(slide.signatures)
    wide = np.zeros((drive.active.shape[0], 2 * drive.active.shape[1]), bool)
    wide[:, ::2] = drive.active
    read_only = drive.active.copy()
    read_only.setflags(write=False)
    for active in (wide[:, ::2], np.asfortranarray(drive.active), read_only):
        simulate(paper_t, Activation(array64, active), duration=0.01, drag=[1e-6, 1e-6, 1e-12])
    assert len(slide.signatures) == compiled


def test_dead_tips_carry_nothing(array64, paper_t):
    array, start = array64.with_spread(strength=0.2, dead=0.1, seed=1), (1e-4, 2e-4, 0.5)
    array = with_pixel(array, tip_width=0.0)
    everything = Activation(array, np.ones_like(array.alive))
    path = simulate(paper_t, everything, start, 0.01, mode="quasi-static", frames=1)
    assert path.tips[0] == carry(everything, paper_t, start).active
    alive = simulate(paper_t, Activation(array, array.alive), start, 0.01, mode="quasi-static")
    assert np.array_equal(path.final_pose, alive.final_pose)
    tip = OscillatingContact(0.3, [1.0, 0.0], [1.0, 1.0, -2.0], 1.0)
    slow = simulate(paper_t, everything, start, 0.01, time_step=5e-3, frames=1, tip=tip)
    assert slow.tips[0] == path.tips[0]
