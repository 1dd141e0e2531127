"""Event-driven motion against small steps, exact crossings, rest and sliding on borders."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.constants import g
from scipy.optimize import linprog

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.errors import InputError, PartTooHeavy, TooManyEvents
from limitsurf.geometry.part import Part
from limitsurf.motion.array_events.event_motion import event_motion
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.trajectory import EventKind, Outcome
from tests.motion.event_scenes import distances, on_outline, random_case, small_array

PITCH = 1e-4
CROSSINGS = (EventKind.ENTER, EventKind.LEAVE)


def kinds(path):
    return [event.kind for event in path.events]


def difference(case, path, time_step, tip_width=0.0):
    """Return the largest distance of rim points from those of small steps, over the pitch."""
    pixel = replace(case.drive.array.pixel, tip_width=tip_width)
    array = replace(case.drive.array, pixel=pixel)
    steps = replace(case, drive=Activation(array, case.drive.active)).steps(time_step)
    worst = 0.0
    for time, pose in zip(steps.times, steps.poses, strict=True):
        nearest = int(np.argmin(np.abs(path.times - time)))
        if time > path.duration:  # at rest, or gone
            nearest = -1
        elif abs(path.times[nearest] - time) > 1e-9:
            continue
        if time > path.duration and path.outcome is Outcome.LEFT_ARRAY:
            continue
        gap = (pose - path.poses[nearest]) * [1.0, 1.0, case.part.circumradius]
        worst = max(worst, float(np.abs(gap).max()) / PITCH)
    return worst


def errors_of(case):
    """Return the path, and its differences from steps that become sixteen times smaller.

    Steps of point tips chatter about a border, each of them with the friction of one cell: with
    friction that is not the hull of the two cells' sets. There the steps take tips of a width
    that vanishes with the step.
    """
    path = case.run()
    wide = case.drive.array.pixel.residual_fraction > 0.0 and EventKind.CAPTURE in kinds(path)
    steps = case.duration / 20 * 0.25 ** np.arange(2, 5)
    return path, [difference(case, path, h, 0.03 * h * wide) for h in steps]


def check_subsets(case, path):
    """The tips counted are those in the polygon, but for those on the outline."""
    for pose, tips, held in zip(path.poses, path.tips, on_outline(path), strict=True):
        names, inside, gap = distances(case, pose)
        sure = [
            i and name not in held and d > 1e-12 * PITCH
            for name, i, d in zip(names, inside, gap, strict=True)
        ]
        free = [name in held or d <= 1e-12 * PITCH for name, d in zip(names, gap, strict=True)]
        assert sum(sure) <= tips <= sum(sure) + sum(free)


def check_crossings(case, path):
    """Where a tip enters or leaves, it is on the outline to 1e-12 of the pitch."""
    array = case.drive.array
    for event in path.events:
        if event.kind in CROSSINGS:
            pose = path.poses[np.searchsorted(path.times, event.time)]
            row, column = event.where
            place = np.array(array.first_site) + array.site_pitch * np.array([column, row])
            boundary = shapely.boundary(case.part.at(pose))
            assert shapely.distance(boundary, shapely.Point(place)) < 1e-12 * array.site_pitch


@pytest.mark.parametrize("seed", range(0, 72, 5))
def test_small_steps_approach_the_events(seed):
    case = random_case(seed)
    path, errors = errors_of(case)
    check_subsets(case, path)
    check_crossings(case, path)
    assert errors[-1] <= 2e-2
    assert errors[-1] == pytest.approx(0.0, abs=0.4 * errors[0] + 1e-9)
    sizes = np.abs(path.energy.work).max() + path.energy.kinetic.max()
    assert np.abs(path.energy.residual).max() <= 1e-8 * sizes


@pytest.mark.slow
def test_two_hundred_scenes_agree_with_small_steps():
    """First order on the mean; scenes that do not come close are counted, not left out."""
    errors, far = [], []
    for seed in range(200):
        case = random_case(seed, duration=0.1)
        path, differences = errors_of(case)
        check_subsets(case, path)
        check_crossings(case, path)
        errors.append(differences)
        if differences[-1] > 5e-3:
            far.append(seed)
    table = np.array(errors)
    moving = table[:, 0] > 1e-6  # others rest from the start on, in both
    assert moving.sum() > 130
    assert table[~moving].max() <= 1e-6
    means = np.exp(np.log(table[moving]).mean(axis=0))
    order = np.log(means[0] / means[-1]) / np.log(16.0)
    assert order == pytest.approx(1.0, abs=0.1)
    assert len(far) <= 4, f"{len(far)} scenes differ: {far}"


def line_case(columns_down, pair_right, mode="quasi-static", offset=0.0):
    """Return a square pushed up by two tips, down by those at its upper edge.

    Their moments cancel wherever the part is along x, and so do those of two tips that push
    to the right if the upper edge is on the row of those that push down.
    """
    array = small_array()
    active = np.zeros(array.site_directions.shape[:2], dtype=bool)
    active[14, [13, 17]] = True  # up
    active[19, columns_down] = True  # down
    active[[12, 14], [14, 16]] |= pair_right
    side = 12 * PITCH
    part = Part([(0, 0), (side, 0), (side, side), (0, side)], "20 g/m^2")
    x, y = np.array(array.first_site) + PITCH * np.array([15, 13])
    case = random_case(0, mode=mode, grip=0.0)
    pose = np.array([x, y - offset, 0.0])
    drive = Activation(array, active)
    return replace(case, part=part, drive=drive, pose=pose, twist=np.zeros(3), duration=0.02)


@pytest.mark.parametrize("mode", ["quasi-static", "inertial"])
def test_a_part_slides_along_a_border_with_filippovs_speed(mode):
    """Two tips up and four down with half a share each; two of six shares push to the right."""
    case = line_case([12, 14, 16, 18], True, mode)
    path = case.run()
    pixel, part = case.drive.array.pixel, case.part
    drag = air_film_drag(part, case.drive.array)[0]
    force = pixel.friction * pixel.offset_fraction * part.mass * g * 2 / 6
    t, rate = path.times, drag / part.mass
    gone = t if mode == "quasi-static" else t - (1 - np.exp(-rate * t)) / rate
    assert path.outcome is Outcome.TIME_LIMIT
    assert path.poses[:, 0] - case.pose[0] == pytest.approx(force / drag * gone, abs=1e-9 * PITCH)
    assert np.abs(path.poses[:, 1] - case.pose[1]).max() < 1e-12 * PITCH
    assert np.abs(path.poses[:, 2]).max() < 1e-12
    assert kinds(path) == [EventKind.CAPTURE] * 4


def test_a_part_stops_where_its_edge_meets_the_tips():
    case = line_case([12, 14, 16, 18], False, offset=0.3 * PITCH)
    path = case.run()
    pixel, part = case.drive.array.pixel, case.part
    force = pixel.friction * pixel.offset_fraction * part.mass * g
    speed = force / air_film_drag(part, case.drive.array)[0]
    assert path.outcome is Outcome.REST
    assert path.duration == pytest.approx(0.3 * PITCH / speed, rel=1e-9)
    assert path.final_pose[1] == pytest.approx(case.pose[1] + 0.3 * PITCH, abs=1e-12 * PITCH)
    assert path.error_bounds[-1] <= 1e-12 * part.mass * g
    assert path.tips[-1] == 6


def test_a_border_that_pushes_too_little_is_crossed():
    case = line_case([14, 16], False, offset=0.3 * PITCH)
    wide = replace(case, drive=Activation(case.drive.array, case.drive.active.copy()))
    wide.drive.active[14, [11, 19]] = True  # four up, two down
    path = wide.run()
    assert EventKind.CAPTURE not in kinds(path)
    assert kinds(path)[:2] == [EventKind.ENTER] * 2


def resting_cases():
    for seed in (0, 12, 30, 36, 48):
        case = random_case(seed, mode="quasi-static", grip=0.0, duration=5.0)
        path = case.run()
        if path.outcome is Outcome.REST:
            yield case, path


def test_rest_on_a_border_has_zero_in_the_hull():
    """An independent linear program finds shares; from there the part does not move at all."""
    count = 0
    for case, path in resting_cases():
        pose, held = path.final_pose, on_outline(path)[-1]
        names, inside, gap = distances(case, pose)
        array = case.drive.array
        rows, columns = np.nonzero(case.drive.active)
        arms = np.array(array.first_site) + PITCH * np.column_stack([columns, rows]) - pose[:2]
        pushes = array.site_directions[rows, columns]
        moments = arms[:, 0] * pushes[:, 1] - arms[:, 1] * pushes[:, 0]
        loads = np.column_stack([pushes, moments / case.part.circumradius])
        border = gap < 1e-12 * PITCH
        assert held <= {name for name, on in zip(names, border, strict=True) if on}
        if not held:
            continue  # the pushes of whole tips cancel
        free = linprog(
            np.zeros(border.sum()),
            A_eq=loads[border].T,
            b_eq=-loads[inside & ~border].sum(axis=0),
            bounds=(0.0, 1.0),
        )
        assert free.status == 0, free.message
        assert path.error_bounds[-1] <= 1e-9 * case.part.mass * g
        again = replace(case, pose=pose).run()
        assert again.outcome is Outcome.REST
        assert again.duration == 0.0
        moved = (again.final_pose - pose) * [1.0, 1.0, case.part.circumradius]
        assert np.abs(moved).max() < 1e-12 * PITCH
        count += 1
    assert count >= 3


@pytest.mark.parametrize("mode", ["quasi-static", "inertial"])
def test_shifts_by_pixels_and_quarter_turns_change_nothing(mode):
    case = random_case(7, mode=mode, grip=0.01)
    array, active = case.drive.array, case.drive.active
    path = case.run()
    shifted = np.roll(active, (4, -2), axis=(0, 1))
    pose = case.pose + np.array([-2, 4, 0]) * PITCH
    moved = replace(case, drive=Activation(array, shifted), pose=pose).run()
    assert [e.kind for e in moved.events] == kinds(path)
    assert moved.final_pose - path.final_pose == pytest.approx(pose - case.pose, abs=1e-8 * PITCH)
    quarter = np.array([-case.pose[1], case.pose[0], case.pose[2] + np.pi / 2])
    twist = np.array([-case.twist[1], case.twist[0], case.twist[2]])
    turned = replace(
        case, drive=Activation(array, active.T[:, ::-1].copy()), pose=quarter, twist=twist
    ).run()
    x, y, theta = path.final_pose
    assert [e.kind for e in turned.events] == kinds(path)
    assert turned.final_pose == pytest.approx([-y, x, theta + np.pi / 2], abs=1e-8 * PITCH)


def aligned_case(seed):
    """Return a part whose edges lie on rows, columns or diagonals of tips: many events at once."""
    rng = np.random.default_rng([7, seed])
    case = random_case(seed, grip=(0.0, 0.01, 0.05)[seed % 3])
    array = case.drive.array
    shapes = [
        shapely.box(0, 0, *(PITCH * rng.integers(4, 12, 2))),
        shapely.Polygon(PITCH * np.array([(0, 0), (8, 0), (0, 8)])),
        shapely.box(0, 0, 8, 8).difference(shapely.box(2, 2, 4, 6)),
        shapely.Polygon([(0, 0), (10, 0), (10, 4), (6, 4), (6, 8), (4, 8), (4, 4), (0, 4)]),
    ]
    shape = shapes[seed // 6 % 4]
    shape = shape if shape.length < 1.0 else shapely.transform(shape, lambda p: PITCH * p)
    line = (0.0, np.pi / 4, np.pi / 2)[seed // 24 % 3]
    pose = np.array([*(PITCH / 2 * rng.integers(-6, 7, 2)), np.pi / 4 * rng.integers(0, 8)])
    mode = ("quasi-static", "inertial")[seed // 3 % 2]
    drive = squeeze_activation(array, line)
    part = Part(shape, "80 g/m^2")
    return replace(case, part=part, drive=drive, pose=pose, twist=np.zeros(3), mode=mode)


@pytest.mark.parametrize("seed", range(0, 60, 9))
def test_aligned_parts_end(seed):
    case = replace(aligned_case(seed), duration=0.4)
    path = case.run(max_events=3000)
    check_subsets(case, path)
    check_crossings(case, path)


@pytest.mark.slow
def test_no_scene_hangs():
    for seed in range(40):
        case = random_case(seed, duration=2.0)
        path = case.run(max_events=6000)
        check_subsets(case, path)
        assert path.outcome in (Outcome.REST, Outcome.LEFT_ARRAY, Outcome.TIME_LIMIT)
        sizes = np.abs(path.energy.work).max() + path.energy.kinetic.max()
        assert np.abs(path.energy.residual).max() <= 1e-8 * sizes


def test_a_part_leaves_where_a_corner_meets_the_edge():
    array = small_array()
    drive = Activation(array, array.site_directions @ np.array([1.0, 0.0]) > 0.5)
    case = replace(random_case(0, grip=0.0), drive=drive, pose=np.array([6e-4, 0.0, 0.3]))
    path = replace(case, duration=2.0).run()
    assert path.outcome is Outcome.LEFT_ARRAY
    assert path.events[-1].kind is EventKind.EDGE
    right = shapely.bounds(case.part.at(path.final_pose))[2]
    assert right == pytest.approx(array.width / 2, abs=1e-12 * PITCH)


def test_a_growing_load_moves_the_part_when_friction_is_used_up():
    """Pushes cancel; the part slips when the load equals grip times weight."""
    case = line_case([12, 14, 16, 18], False)
    pixel = replace(case.drive.array.pixel, offset_fraction=0.0, residual_fraction=0.1)
    array = replace(case.drive.array, pixel=pixel)
    active = np.zeros_like(case.drive.active)
    active[np.ix_([11, 13, 15], [13, 15, 17])] = True
    weight = case.part.mass * g
    pull = pixel.friction * 0.1 * weight / 0.01
    path = event_motion(
        case.part,
        Activation(array, active),
        case.pose,
        0.02,
        drag=air_film_drag(case.part, array),
        load=lambda t: (pull * t, 0.0, 0.0),
    )
    slip = [event.time for event in path.events if event.kind is EventKind.SLIP]
    assert slip == pytest.approx([0.01], rel=1e-9)
    after = path.times - 0.01
    drag = air_film_drag(case.part, array)[0]
    gone = np.where(after > 0, 0.5 * pull * after**2 / drag, 0.0)
    assert path.poses[:, 0] - case.pose[0] == pytest.approx(gone, rel=1e-6, abs=1e-7 * PITCH)


def test_sliding_without_pushes_stops_where_coulomb_says():
    """A block at v0 without rotation stops after v0 / (mu g), and sticks."""
    case = line_case([12, 14, 16, 18], False)
    pixel = replace(case.drive.array.pixel, offset_fraction=0.0, residual_fraction=0.1)
    array = replace(case.drive.array, pixel=pixel)
    active = np.zeros_like(case.drive.active)
    active[np.ix_([11, 13, 15], [13, 15, 17])] = True
    speed, deceleration = 5e-3, pixel.friction * 0.1 * g
    path = event_motion(
        case.part,
        Activation(array, active),
        case.pose,
        1.0,
        twist=(speed, 0.0, 0.0),
        mode="inertial",
        drag=(0.0, 0.0, 0.0),
    )
    assert path.outcome is Outcome.REST
    assert kinds(path) == [EventKind.STICK, EventKind.REST]
    assert path.duration == pytest.approx(speed / deceleration, rel=1e-4)
    distance = speed**2 / (2 * deceleration)
    assert path.final_pose[0] - case.pose[0] == pytest.approx(distance, rel=1e-7)
    assert np.array_equal(path.twists[-1], np.zeros(3))
    assert path.energy.friction[-1] == pytest.approx(path.energy.kinetic[0], rel=1e-6)


def test_too_few_tips_stop_the_run():
    case = random_case(0)
    none = Activation(case.drive.array, np.zeros_like(case.drive.active))
    assert replace(case, drive=none).run().outcome is Outcome.NOT_LIFTED
    weak = case.drive.array.at_voltage(10.0)
    with pytest.raises(PartTooHeavy, match="would lift it"):
        replace(case, drive=Activation(weak, case.drive.active)).run()


def test_too_many_events_are_named():
    with pytest.raises(TooManyEvents, match="max_events: 3 events") as caught:
        random_case(6).run(max_events=3)
    assert caught.value.time > 0.0


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"mode": "fast"}, "mode"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"max_events": 0}, "max_events"),
        ({"frames": 0}, "frames"),
        ({"load": (0, np.nan, 0)}, "load"),
        ({"twist": (0, 0)}, "twist"),
    ],
)
def test_bad_arguments_are_named(changes, name):
    with pytest.raises(InputError) as caught:
        random_case(0).run(**changes)
    assert caught.value.argument == name


def test_bad_places_and_drags_are_named():
    case = random_case(0)
    for changes, name in (({"pose": (1.0, 0, 0)}, "pose"), ({"duration": 0.0}, "duration")):
        with pytest.raises(InputError) as caught:
            replace(case, **changes).run()
        assert caught.value.argument == name
    for drag in ((0, 0, 0), (1, 2, 1), (-1, -1, 1)):
        with pytest.raises(InputError, match="drag"):
            event_motion(case.part, case.drive, case.pose, 0.1, drag=drag)
