"""The same motion in a frame that is moved, rotated, rescaled."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.geometry.part import Part
from limitsurf.motion.simulate import simulate

OUTLINE = 1e-4 * np.array([(0, 0), (18, 2), (21, 13), (9, 11), (3, 19)])


@pytest.fixture(scope="module")
def array(array64):
    pixel = replace(array64.pixel, residual_fraction=0.02)
    return replace(array64, pixel=pixel)


@pytest.fixture(scope="module")
def part():
    return Part(OUTLINE, "80 g/m^2")


def all_towards(array, direction):
    return Activation(array, array.site_directions @ np.array(direction) > 0.5)


@pytest.mark.parametrize("mode", ["inertial", "quasi-static"])
def test_moved_by_whole_pixels(array, part, mode):
    drive, start = all_towards(array, (1, 0)), np.array([1e-4, 3e-5, 0.3])
    shift = array.pixel.pitch * np.array([-3, 2, 0])
    path = simulate(part, drive, start, 0.2, mode=mode)
    moved = simulate(part, drive, start + shift, 0.2, mode=mode)
    assert np.ptp(path.poses[:, 2]) > 1e-3
    assert moved.poses - shift == pytest.approx(path.poses, abs=1e-11)


def test_moved_by_any_distance_with_an_array_as_far(array, part):
    """A part is the same wherever its drawing's origin is."""
    far = Part(shapely.affinity.translate(part.polygon, 0.3, -0.2), "80 g/m^2")
    drive, start = squeeze_activation(array, 0.4), (1e-4, 3e-4, 0.3)
    ends = [simulate(p, drive, start, 0.2).final_pose for p in (part, far)]
    assert ends[1] == pytest.approx(ends[0], abs=1e-11)


@pytest.mark.parametrize("mode", ["inertial", "quasi-static"])
def test_rotated_by_a_right_angle(array, part, mode):
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    turned = np.rot90(array.pixel.directions @ quarter.T, -1)  # rows count upwards
    other = replace(array, pixel=replace(array.pixel, directions=np.ascontiguousarray(turned)))
    start = np.array([3e-4, -2e-4, 0.7])
    path = simulate(part, all_towards(array, (1, 0)), start, 0.2, mode=mode)
    rotated = simulate(
        part,
        all_towards(other, (0, 1)),
        [*quarter @ start[:2], start[2] + 0.5 * np.pi],
        0.2,
        mode=mode,
    )
    assert rotated.poses[:, :2] == pytest.approx(path.poses[:, :2] @ quarter.T, abs=1e-11)
    assert rotated.poses[:, 2] == pytest.approx(path.poses[:, 2] + 0.5 * np.pi, abs=1e-9)


def test_twice_as_large_takes_twice_as_long(array, part):
    """Quasi-static: forces and drag grow with the area, moments and angular drag alike."""
    large = Part(2 * OUTLINE, "80 g/m^2")
    pixel = replace(array.pixel, pitch=2 * array.pixel.pitch, tip_width=2 * array.pixel.tip_width)
    start = np.array([3e-4, -2e-4, 0.7])
    path = simulate(
        part, squeeze_activation(array, 0.4), start, 0.2, mode="quasi-static", time_step=1e-3
    )
    twice = simulate(
        large,
        squeeze_activation(replace(array, pixel=pixel), 0.4),
        start * [2, 2, 1],
        0.4,
        mode="quasi-static",
        time_step=2e-3,
    )
    assert twice.poses == pytest.approx(path.poses * [2, 2, 1], abs=1e-10)
