import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.planning.squeeze_function import squeeze_function
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, NAMES, angle_distance


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_steps_alternate_and_the_period_is_the_parts(case):
    squeeze = squeeze_function(turn_function(Part(case["vertices"])))
    assert np.all(squeeze.breaks < squeeze.images)
    assert np.all(squeeze.images < squeeze.ends)
    assert squeeze.period == pytest.approx(case["period_T"], abs=1e-12)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_following_the_turn_function_ends_at_the_image(case):
    """The slow twin: descend U by the sign of the turn function until it changes."""
    turn = turn_function(Part(case["vertices"]))
    squeeze = squeeze_function(turn)
    for phi in np.linspace(0.01, 3.13, 23):
        position, direction = phi, int(turn(phi))
        if direction == 0:
            continue
        while int(turn(position)) == direction:
            position += direction * 1e-3
        assert angle_distance([position], [squeeze(phi)]) < 2e-3


def test_breaks_map_to_the_right():
    squeeze = squeeze_function(turn_function(Part([(0, 0), (1, 0), (1, 1), (0, 1)])))
    assert squeeze(squeeze.breaks) == pytest.approx(np.mod(squeeze.images, np.pi))
    before = np.mod(squeeze.breaks - 1e-9, np.pi)
    assert squeeze(before) == pytest.approx(np.mod(np.roll(squeeze.images, 1), np.pi))


def test_images_are_fixed_and_arrays_broadcast():
    squeeze = squeeze_function(turn_function(Part(CASES[NAMES.index("blob_m3")]["vertices"])))
    images = np.mod(squeeze.images, np.pi)
    assert squeeze(images) == pytest.approx(images)
    assert squeeze(np.zeros((2, 3))).shape == (2, 3)


def test_neutral_parts_stay():
    disk = Part(shapely.Point(0, 0).buffer(1.0))
    squeeze = squeeze_function(turn_function(disk))
    assert squeeze([0.3, 4.0]) == pytest.approx([0.3, 4.0 - np.pi])
    assert "identity" in repr(squeeze)
