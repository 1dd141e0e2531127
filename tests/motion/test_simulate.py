"""Simulation: analytic motions, agreement with a slow twin, certificates, outcomes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.constants import g

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.conic.contact_sum import closest_contact_load
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.simulate import simulate
from limitsurf.motion.time_scales import time_scales
from limitsurf.motion.trajectory import Outcome

#: y and theta at which tips that push along x lie symmetrically: no moment, no rotation
SYMMETRIC_Y = (-5e-5, 0.0)


def all_towards(array, direction):
    """Return the activation in which every pixel pushes one way."""
    return Activation(array, array.site_directions @ np.array(direction) > 0.5)


@pytest.fixture(scope="module")
def square():
    return Part([(0, 0), (2e-3, 0), (2e-3, 2e-3), (0, 2e-3)], "80 g/m^2")


def with_pixel(array, **changes):
    return replace(array, pixel=replace(array.pixel, **changes))


def test_quasi_static_speed_is_push_minus_grip_over_drag(array64, square):
    drive = all_towards(array64, (1.0, 0.0))
    path = simulate(square, drive, (-2e-3, *SYMMETRIC_Y), 0.2, mode="quasi-static")
    pixel = array64.pixel
    force = pixel.friction * (pixel.offset_fraction - pixel.residual_fraction) * square.mass * g
    speed = force / air_film_drag(square, array64)[0]
    assert path.outcome is Outcome.TIME_LIMIT
    assert path.twists[:, 0] == pytest.approx(np.full(len(path.times), speed), rel=1e-6)
    assert path.final_pose[0] == pytest.approx(-2e-3 + speed * path.duration, rel=1e-5)
    assert np.ptp(path.poses[:, 1:], axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_inertial_start_approaches_terminal_speed_at_the_drag_rate(array64, square):
    """m v' = F - d v, so v = (F/d)(1 - exp(-d t/m)); implicit Euler, first order in the step."""
    drive = all_towards(array64, (0.0, 1.0))
    pixel = array64.pixel
    force = pixel.friction * (pixel.offset_fraction - pixel.residual_fraction) * square.mass * g
    drag = air_film_drag(square, array64)[0]
    errors = []
    for step in (2e-4, 1e-4):
        path = simulate(square, drive, (5e-5, -2e-3, 0), 0.1, time_step=step)
        # the recorded twist is that of the step that follows
        exact = force / drag * (1 - np.exp(-drag * (path.times[:-1] + step) / square.mass))
        errors.append(np.abs(path.twists[:-1, 1] - exact).max() / (force / drag))
    assert errors[0] < 0.01
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)


def test_sliding_block_stops_where_coulomb_says(array64, square):
    """No push, no air: a block at v0 stops after v0 / (mu g), at rest exactly."""
    array = replace(with_pixel(array64, offset_fraction=1e-12, residual_fraction=1.0), air_film=1e9)
    drive = all_towards(array, (1.0, 0.0))
    speed, step = 0.05, 1e-5
    path = simulate(
        square, drive, (-2e-3, *SYMMETRIC_Y), 0.1, twist=(speed, 0, 0), time_step=step, frames=1
    )
    deceleration = array.pixel.friction * g
    assert path.outcome is Outcome.REST
    assert path.duration == pytest.approx(speed / deceleration, abs=3 * step)
    distance = path.final_pose[0] + 2e-3
    assert distance == pytest.approx(speed**2 / (2 * deceleration), abs=2 * speed * step)
    assert np.array_equal(path.twists[-1], np.zeros(3))


def test_every_step_is_the_closest_point(array64, paper_t):
    """The slow twin: contacts by point-in-polygon, closest point by Clarabel, at recorded poses."""
    array = with_pixel(array64, residual_fraction=0.05, tip_width=0.0)
    drive = squeeze_activation(array, 0.4)
    path = simulate(paper_t, drive, (3e-4, -2e-4, 0.9), 0.3, mode="quasi-static", frames=4)
    drag = air_film_drag(paper_t, array)
    rho = np.sqrt(drag[2] / drag[0])
    for pose, twist, load in zip(path.poses, path.twists, path.loads, strict=True):
        points, directions = tips_under(paper_t, drive, pose)
        normal = paper_t.mass * g / len(points)
        push = array.pixel.friction * array.pixel.offset_fraction * normal * directions
        total = load_of(points, push)
        radius = np.full(len(points), array.pixel.friction * 0.05 * normal)
        scale = paper_t.mass * g
        closest = closest_contact_load(points / rho, radius / scale, total / scale / [1, 1, rho])
        net = total - closest * scale * [1, 1, rho]
        assert load / scale == pytest.approx(net / scale, abs=2e-6 * array.pixel.friction)
        assert twist == pytest.approx(load / drag, rel=1e-6, abs=1e-10)


def tips_under(part, drive, pose):
    import shapely

    array = drive.array
    rows, columns = np.nonzero(drive.active)
    points = np.array(array.first_site) + array.site_pitch * np.column_stack([columns, rows])
    inside = shapely.contains_xy(part.at(pose), points)
    return points[inside] - pose[:2], array.site_directions[rows, columns][inside]


def load_of(points, forces):
    moments = points[:, 0] * forces[:, 1] - points[:, 1] * forces[:, 0]
    return np.array([*forces.sum(axis=0), moments.sum()])


def test_steps_converge(array64, paper_t):
    drive = squeeze_activation(array64, 0.0)
    pose = (2e-4, 8e-4, 1.2)
    ends = [
        simulate(paper_t, drive, pose, 0.4, time_step=step, frames=1).final_pose
        for step in (2e-3, 1e-3, 5e-4, 2.5e-4, 2e-6)
    ]
    errors = [np.abs((end - ends[-1]) / [1e-3, 1e-3, 1.0]).max() for end in ends[:-1]]
    assert errors[0] > errors[1] > errors[2] > errors[3]
    assert errors[3] < 2e-4
    order = np.polyfit(np.log([2e-3, 1e-3, 5e-4, 2.5e-4]), np.log(errors), 1)[0]
    assert order == pytest.approx(1.0, abs=0.15)


def test_a_squeezed_part_comes_to_rest_on_the_line(array64, paper_t):
    for line in (0.0, np.pi / 4):
        path = simulate(paper_t, squeeze_activation(array64, line), (5e-4, 7e-4, line + 1.0))
        assert path.outcome is Outcome.REST
        relative = np.degrees(np.mod(path.final_pose[2] - line, np.pi))
        assert min(abs(relative - 90.0), relative, 180.0 - relative) < 6.0
        assert path.worst_error < 1e-7


def test_a_part_at_rest_stays_exactly(array64, paper_t):
    drive = squeeze_activation(array64, 0.0)
    array = with_pixel(array64, residual_fraction=0.2)
    strong = Activation(array, drive.active)
    for mode in ("inertial", "quasi-static"):
        path = simulate(paper_t, strong, (0.0, 0.0, 0.0), mode=mode)
        again = simulate(paper_t, strong, path.final_pose, mode=mode)
        assert again.outcome is Outcome.REST
        assert again.duration == 0.0
        assert again.held
        assert np.array_equal(again.final_pose, path.final_pose)


def test_mirrored_drives_mirror_the_motion(array64, square):
    right = simulate(square, all_towards(array64, (1, 0)), (0, 0, 0), 0.1, mode="quasi-static")
    left = simulate(square, all_towards(array64, (-1, 0)), (0, 0, 0), 0.1, mode="quasi-static")
    assert right.final_pose[0] == pytest.approx(-left.final_pose[0], rel=1e-4)


def test_a_part_that_leaves_the_array_says_so(array64, square):
    path = simulate(square, all_towards(array64, (1.0, 0.0)), (5e-3, *SYMMETRIC_Y), 10.0)
    assert path.outcome is Outcome.LEFT_ARRAY
    assert path.final_pose[0] == pytest.approx(5.4e-3, abs=2e-5)
    assert str(path.outcome) == "left the array"


def test_too_heavy_names_the_lifting_voltage(square):
    array = load_array("resonator64", voltage=10.0)
    with pytest.raises(PartTooHeavy) as caught:
        simulate(square, all_towards(array, (1.0, 0.0)))
    error = caught.value
    assert f"{error.lifting_voltage:.3g} V would lift it" in str(error)
    lifted = load_array("resonator64", voltage=1.001 * error.lifting_voltage)
    lifted.pixel.vertical_force(lifted.voltage)
    assert lifted.pixel.vertical_force(lifted.voltage) > error.weight_per_tip


def test_too_few_tips_stop_the_run(array64, square):
    """Half of the pixels idle: twice the load on each tip, too much at 1.2 times the threshold."""
    voltage = 1.2 * array64.pixel.lifting_voltage(square.areal_density * g * array64.pixel.pitch**2)
    array = load_array("resonator64", voltage=voltage)
    drive = all_towards(array, (1.0, 0.0))
    assert simulate(square, drive, duration=1e-3).outcome is Outcome.TIME_LIMIT
    active = drive.active.copy()
    active[::4] = False
    with pytest.raises(PartTooHeavy, match="would lift it"):
        simulate(square, Activation(array, active), duration=1e-3)
    none = Activation(array, np.zeros_like(active))
    assert simulate(square, none, duration=1e-3).outcome is Outcome.NOT_LIFTED


def test_time_scales_choose_the_lesser_speed(array64, paper_t):
    paper = time_scales(paper_t, array64)
    assert paper.speed == pytest.approx(6.5e-3, rel=0.01)  # against drag
    card = Part.from_file("nano_sim")
    heavy = time_scales(card, load_array("resonator128"))
    acceleration = 0.3 * 0.1 * g
    assert heavy.speed == pytest.approx(np.sqrt(2 * acceleration * card.circumradius))


def test_trajectory_as_a_dataset(array64, paper_t):
    path = simulate(paper_t, squeeze_activation(array64, 0.0), (0, 0, 0.3), 0.05)
    data = path.to_dataset()
    assert data.poses.attrs["units"] == "m, m, rad"
    assert data.poses.sel(pose="theta").values == pytest.approx(path.poses[:, 2])
    assert data.attrs["outcome"] == str(path.outcome)
    assert "frames" in repr(path)
    assert repr(path.energy).startswith(f"EnergyBalance(work {path.energy.work[-1]:.3g} J; gained")
    assert np.array_equal(path.certificates, path.error_bounds)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"pose": (0, 0)}, "pose"),
        ({"pose": (np.nan, 0, 0)}, "pose"),
        ({"pose": (1.0, 0, 0)}, "pose"),
        ({"twist": (0, np.inf, 0)}, "twist"),
        ({"duration": 0.0}, "duration"),
        ({"time_step": -1.0}, "time_step"),
        ({"time_step": 1e-12}, "time_step"),
        ({"mode": "fast"}, "mode"),
        ({"frames": 0}, "frames"),
        ({"frames": 2.5}, "frames"),
        ({"frames": "many"}, "frames"),
        ({"pose": "here"}, "pose"),
        ({"part": "paper_t"}, "part"),
        ({"save": "no such folder/run.nc"}, "save"),
        ({"save": "."}, "save"),
        ({"save": 3}, "save"),
    ],
)
def test_bad_arguments_are_named(array64, paper_t, arguments, name):
    arguments = {"part": paper_t, "drive": squeeze_activation(array64, 0.0)} | arguments
    with pytest.raises(InputError) as caught:
        simulate(**arguments)
    assert caught.value.argument == name


def test_parts_without_density_and_arrays_without_push(array64):
    with pytest.raises(InputError, match="areal_density"):
        simulate(Part([(0, 0), (1e-3, 0), (0, 1e-3)]), squeeze_activation(array64, 0.0))
    idle = with_pixel(array64, offset_fraction=0.0)
    with pytest.raises(InputError, match="do not push"):
        simulate(Part.from_file("paper_t"), squeeze_activation(idle, 0.0))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_adaptive_steps_end_at_the_edge(array64, square, tolerance):
    drive, start = all_towards(array64, (1.0, 0.0)), (5e-3, *SYMMETRIC_Y)
    path = simulate(square, drive, start, 10.0, tolerance=tolerance)
    assert path.outcome is Outcome.LEFT_ARRAY
    assert 0.0 < path.final_pose[0] - 5.4e-3 <= tolerance * square.circumradius
    thrown = simulate(square, drive, (0.0, *SYMMETRIC_Y), twist=(1.0, 0, 0), tolerance=tolerance)
    assert 0.0 < thrown.final_pose[0] - 5.4e-3 <= tolerance * square.circumradius
    residual = np.abs(path.energy.residual).max()
    assert residual < 1e-12 * path.energy.work[-1]


def test_a_file_that_cannot_be_written_is_named_before_the_run(paper_t, tmp_path):
    def never(time):
        raise AssertionError("the drive was asked")

    with pytest.raises(InputError, match="save: lies in no folder"):
        simulate(paper_t, never, duration=1.0, save=tmp_path / "missing" / "run.nc")
