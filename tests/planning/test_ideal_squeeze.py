"""The ideal squeeze as a drive, beside the general motion in a force density."""

import numpy as np
import pytest
import shapely

from limitsurf.actuators.density_field import DensityField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.field_motion import field_motion
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, angle_distance

PARTS = {case["name"]: Part(np.array(case["vertices"])) for case in CASES}
STARTS = ((0.3, 0.4), (-0.45, 1.3), (0.1, 5.0))


def drag_of(part, ratio):
    return part.area, part.area, part.polar_moment / ratio


@pytest.mark.parametrize("name", ["T", "simple_16", "rect_2x1", "tiny_1e-6"])
@pytest.mark.parametrize("ratio", [0.1, 1.0, 10.0])
def test_rest_and_path_are_those_of_the_general_motion(name, ratio):
    part, drive = PARTS[name], IdealSqueeze(ratio)
    field = DensityField.squeeze(0.0, 1.0)
    for share, phi in STARTS:
        z = share * part.area**0.5
        offset, angle = drive.rest(part, z, phi)
        path = drive.path(part, z, phi)
        assert [path.offsets[-1], path.orientations[-1]] == pytest.approx(
            [float(offset), float(angle)], abs=1e-7
        )
        k = len(path.times) // 3
        twin = field_motion(
            part,
            field,
            (0.0, -z, phi),
            duration=float(path.times[k]),
            mode="quasi-static",
            drag=drag_of(part, ratio),
        )
        unit = part.area**0.5
        assert path.offsets[k] / unit == pytest.approx(-twin.final_pose[1] / unit, abs=1e-6)
        assert path.orientations[k] == pytest.approx(twin.final_pose[2], abs=1e-6)


def test_the_general_motion_rests_there_too():
    part, drive = PARTS["simple_16"], IdealSqueeze(10.0)
    twin = field_motion(
        part,
        DensityField.squeeze(0.0, 1.0),
        (0.0, 0.5, 1.2),
        duration=1e3,
        mode="quasi-static",
        drag=drag_of(part, 10.0),
    )
    offset, phi = drive.rest(part, -0.5, 1.2)
    assert [float(offset), float(phi)] == pytest.approx(
        [-twin.final_pose[1], twin.final_pose[2]], abs=1e-9
    )


@pytest.mark.parametrize("name", PARTS)
def test_without_mobility_of_rotation_the_part_follows_its_turn_function(name, rng):
    """First the median, then downhill: between the same unstable orientations."""
    part = PARTS[name]
    turn = turn_function(part)
    phi = rng.uniform(0, np.pi, 40)
    _, rest = IdealSqueeze(0.0).rest(part, 0.2 * part.area**0.5, phi)
    near = np.abs(np.subtract.outer(rest, turn.stable) / np.pi)
    assert np.abs(near - np.round(near)).min(axis=1).max() * np.pi < 1e-6
    for start, end in zip(phi, rest, strict=True):
        low, high = sorted((start, end))
        between = np.concatenate([turn.unstable + k * np.pi for k in (-1, 0, 1)])
        assert not ((between > low) & (between < high)).any()


def test_results_scale_and_move_with_the_part(rng):
    shape = PARTS["simple_16"].polygon
    phi, share = rng.uniform(0, 7, 20), rng.uniform(-0.5, 0.5, 20)
    ends = []
    for factor, shift in ((1.0, 0.0), (1e-6, 0.0), (1e5, 3e5)):
        moved = shapely.affinity.translate(
            shapely.affinity.scale(shape, factor, factor, origin=(0, 0)), shift, -shift
        )
        part = Part(moved)
        unit = part.area**0.5
        offset, angle = IdealSqueeze(2.0).rest(part, share * unit, phi)
        ends.append(np.column_stack([offset / unit, angle]))
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)
    assert ends[2] == pytest.approx(ends[0], abs=1e-7)


def test_half_a_turn_changes_the_side_and_nothing_else(rng):
    part, drive = PARTS["convex_8"], IdealSqueeze(3.0)
    phi, z = rng.uniform(0, np.pi, 30), rng.uniform(-0.2, 0.2, 30)
    offset, angle = drive.rest(part, z, phi)
    other, turned = drive.rest(part, -z, phi + np.pi)
    assert other == pytest.approx(-offset, abs=1e-9)
    assert turned == pytest.approx(angle + np.pi, abs=1e-9)


def test_slivers_and_extreme_ratios_come_to_rest(rng):
    """Long things end along the line, whatever the mobilities; a sliver of a triangle nearly so."""
    for outline, most in (
        ([(0, 0), (1000, 0), (1000, 0.1), (0, 0.1)], 1e-12),
        ([(0, 0), (1, 0), (300, 1)], 0.02),
    ):
        part = Part(outline)
        for ratio in (0.0, 1e-6, 1e-2, 1.0, 1e2, 1e6):
            z = rng.uniform(-0.5, 0.5, 10) * part.area**0.5
            _, phi = IdealSqueeze(ratio).rest(part, z, rng.uniform(0, np.pi, 10))
            assert np.abs(np.sin(phi)).max() < most


def test_broadcasting():
    part = PARTS["T"]
    offset, phi = IdealSqueeze().rest(part, [[0.1], [0.2]], [0.3, 0.4, 0.5])
    assert offset.shape == phi.shape == (2, 3)
    one = IdealSqueeze().rest(part, 0.2, 0.4)
    assert [float(x) for x in one] == [offset[1, 1], phi[1, 1]]
    assert angle_distance([phi[1, 1]], [turn_function(part).stable[1]]) < 1e-9


@pytest.mark.parametrize("ratio", [-1.0, 1e-9, 1e7, np.nan, np.inf, "fast", None])
def test_bad_ratios_are_named(ratio):
    with pytest.raises(InputError, match="mobility_ratio"):
        IdealSqueeze(ratio)


def test_bad_starts_are_named():
    part = PARTS["T"]
    with pytest.raises(InputError, match="offset"):
        IdealSqueeze().rest(part, np.nan, 0.0)
    with pytest.raises(InputError, match="phi"):
        IdealSqueeze().path(part, 0.0, np.inf)
