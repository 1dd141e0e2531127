from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.planning.diameter_function import diameter_function
from limitsurf.planning.squeeze_function import (
    SqueezeFunction,
    smallest_period,
    squeeze_function,
)
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


def test_following_counts_turns():
    """The part turns by less than a step, and to where the reduced function says."""
    squeeze = squeeze_function(turn_function(Part(CASES[NAMES.index("T")]["vertices"])))
    phi = np.linspace(-7.0, 9.0, 1001)
    ends = squeeze.follow(phi)
    assert np.all(np.abs(ends - phi) < np.max(squeeze.ends - squeeze.breaks))
    assert angle_distance(np.mod(ends, np.pi), squeeze(phi)) < 1e-12
    assert np.all(np.diff(ends) >= -1e-12)
    assert squeeze.follow(squeeze.breaks[0]) == squeeze.images[0]
    assert squeeze.follow(squeeze.breaks[0] - 1e-9) == pytest.approx(squeeze.images[-1] - np.pi)


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


def repeated(rng, k, copies, noise=0.0):
    """Return k steps repeated `copies` times in pi, with noise."""
    turn = np.pi / copies
    corners = np.sort(rng.uniform(0.0, turn, 2 * k))
    at = np.repeat(np.arange(copies) * turn, k)
    breaks, images = np.tile(corners[::2], copies) + at, np.tile(corners[1::2], copies) + at
    breaks = breaks + noise * rng.uniform(-0.5, 0.5, len(breaks))
    return breaks, np.append(breaks[1:], breaks[0] + np.pi), images


@pytest.mark.parametrize(("k", "copies"), [(1, 1), (1, 7), (3, 1), (3, 4), (2, 12), (5, 9)])
def test_smallest_period(k, copies):
    rng = np.random.default_rng(k)
    exact = repeated(rng, k, copies)
    assert smallest_period(*exact, np.pi) == pytest.approx(np.pi / copies)
    assert smallest_period(*repeated(rng, k, copies, 4e-10), np.pi) == pytest.approx(np.pi / copies)
    if copies > 1:  # parts that are nearly symmetric are not
        assert smallest_period(*repeated(rng, k, copies, 1e-6), np.pi) > np.pi / copies + 1e-9
        breaks, ends, images = exact
        one_off = np.append(images[0] + 1e-6, images[1:])
        assert smallest_period(breaks, ends, one_off, np.pi) == np.pi


def test_the_ends_count_for_the_period():
    """Steps that begin alike but do not end alike are not the same."""
    breaks, ends, images = repeated(np.random.default_rng(0), 1, 3)
    assert smallest_period(breaks, ends - np.array([0.0, 0.1, 0.0]), images, np.pi) == np.pi


def test_period_of_many_steps_is_found_at_once():
    steps = repeated(np.random.default_rng(1), 5, 20_000)
    assert smallest_period(*steps, np.pi) == pytest.approx(np.pi / 20_000)
    squeeze = SqueezeFunction(*steps, np.pi / 20_000)
    assert squeeze.steps == 5


def test_turn_and_diameter_functions_make_step_functions_alike():
    """A rectangle of ratio 2 rests along its long side either way; the jaws also hold its ends."""
    part = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    assert squeeze_function(turn_function(part)).images == pytest.approx([np.pi])
    assert squeeze_function(diameter_function(part)).images == pytest.approx([np.pi / 2, np.pi])


@pytest.mark.parametrize(("order", "period"), [(5, np.pi / 5), (10, np.pi / 5), (1, np.pi)])
def test_symmetric_parts_with_triple_roots_keep_their_period(order, period):
    """A triple root is known to 1e-5 only; whether steps are the same, the part's symmetry says."""
    breaks, _, images = repeated(np.random.default_rng(3), 2, 5, 2e-5)
    turn = SimpleNamespace(stable=images, unstable=breaks, neutral=False, symmetry_order=order)
    assert squeeze_function(turn).period == pytest.approx(period)
