"""Step functions of full motion beside motions from everywhere."""

import numpy as np
import pytest
import shapely

from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.planning.basin_steps import (
    centred_squeeze_function,
    shift_squeeze_function,
    unknown_offset_function,
)
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.separatrices import boundary_shift
from limitsurf.planning.squeeze_function import squeeze_function
from limitsurf.planning.step_function import step_function
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, angle_distance

PARTS = {case["name"]: Part(np.array(case["vertices"])) for case in CASES}
NAMES = ("square", "rect_1.22x1", "triangle_3-4-5", "pentagon", "T", "simple_16", "blob_m3")
RATIOS = (0.01, 1.0, 10.0)


def starts(rng, squeeze, count=60):
    """Return random orientations that do not lie on a break."""
    phi = rng.uniform(0, squeeze.modulus, count)
    off = np.abs(np.subtract.outer(phi, squeeze.breaks)) % squeeze.modulus
    return phi[np.minimum(off, squeeze.modulus - off).min(axis=1) > 1e-6]


def assert_same(a, b, modulus):
    off = np.abs(a - b) % modulus
    assert np.minimum(off, modulus - off).max() < 1e-6


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("side", ["left", "right"])
def test_shift_squeeze_is_where_parts_beside_the_line_come_to_rest(name, ratio, side, rng):
    part = PARTS[name]
    squeeze = shift_squeeze_function(part, ratio, side)
    phi = starts(rng, squeeze)
    away = (-1 if side == "left" else 1) * part.circumradius * rng.uniform(1, 3, len(phi))
    _, rest = IdealSqueeze(ratio).rest(part, away, phi)
    assert_same(squeeze(phi), rest, 2 * np.pi)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("ratio", RATIOS)
def test_centred_is_where_parts_on_the_line_come_to_rest(name, ratio, rng):
    part = PARTS[name]
    squeeze = centred_squeeze_function(part, ratio)
    following = np.append(squeeze.breaks[1:], squeeze.breaks[0] + np.pi)
    assert squeeze.ends == pytest.approx(following, abs=1e-12)
    phi = starts(rng, squeeze)
    _, rest = IdealSqueeze(ratio).rest(part, 0.0, phi)
    assert_same(squeeze(phi), rest, np.pi)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("ratio", [*RATIOS, 100.0])
def test_unknown_offset_tells_where_parts_may_come_to_rest(name, ratio, rng):
    """From every arc of steps i..k, motions come to one of the images i..k."""
    part = PARTS[name]
    try:
        squeeze = unknown_offset_function(part, ratio)
    except SolveFailed:
        assert ratio > 10.0  # that is said, not guessed
        return
    k = len(squeeze.breaks)
    phi = rng.uniform(0, np.pi, 200)
    z = part.circumradius * rng.uniform(-1, 1, 200)
    _, rest = IdealSqueeze(ratio).rest(part, z, phi)
    for first in range(k):
        for count in range(1, k):
            last = first + count - 1
            left, right = squeeze.breaks[first], squeeze.ends[last % k] + np.pi * (last // k)
            place = left + np.mod(phi - left, np.pi)
            inside = (place > left + 1e-6) & (place < right - 1e-6)
            images = squeeze.images[np.arange(first, last + 1) % k]
            off = np.abs(np.subtract.outer(rest[inside], images)) % np.pi
            assert (np.minimum(off, np.pi - off).min(axis=1) < 1e-6).all()


@pytest.mark.parametrize(
    "shape",
    [
        shapely.box(0, 0, np.sqrt(1.5), 1),  # a triple root
        shapely.box(0, 0, 50, 1),
        shapely.box(0, 0, 1.0001, 1),
        shapely.Point(0, 0).buffer(1, 4).difference(shapely.box(-0.1, -0.3, 0.6, 0.2)),
        shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(1.5, 0.2, 3, 0.7)]),
    ],
    ids=["triple", "sliver", "near square", "ring", "pieces"],
)
def test_odd_shapes(shape, rng):
    part = Part(shape)
    for ratio in (0.01, 1.0, 10.0):
        squeeze = shift_squeeze_function(part, ratio)
        phi = starts(rng, squeeze, 20)
        _, rest = IdealSqueeze(ratio).rest(part, -1.2 * part.circumradius, phi)
        off = np.abs(squeeze(phi) - rest) % (2 * np.pi)
        assert np.minimum(off, 2 * np.pi - off).max() < 1e-4  # triple roots are known to 1e-5


def test_neutral_parts_have_no_steps():
    angle = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    disk = Part(np.column_stack([np.cos(angle), np.sin(angle)]))
    for function, modulus in (
        (shift_squeeze_function, 2 * np.pi),
        (centred_squeeze_function, np.pi),
    ):
        squeeze = function(disk)
        assert len(squeeze.breaks) == 0
        assert squeeze.period == squeeze.modulus == modulus


def test_bands_swallow_steps_that_stay_in_order():
    """A swallowed step ends before it begins; places and images still ascend."""
    squeeze = unknown_offset_function(PARTS["simple_16"], 10.0)
    assert (squeeze.ends < squeeze.breaks).any()
    for column in (squeeze.breaks, squeeze.ends, squeeze.images):
        assert (np.diff(column) >= 0.0).all()


@pytest.mark.parametrize("name", NAMES)
def test_slow_turning_is_2phase(name):
    """With a mobility ratio of 0, and nearly so with a tiny one, offsets do not matter."""
    part = PARTS[name]
    plain = squeeze_function(turn_function(part))
    for ratio, off in ((0.0, 1e-9), (1e-4, 1e-3)):
        for found in (centred_squeeze_function(part, ratio), unknown_offset_function(part, ratio)):
            assert angle_distance(found.breaks, plain.breaks) < off
            assert angle_distance(found.ends, plain.ends) < off
            assert angle_distance(found.images, plain.images) < 1e-9
        beside = shift_squeeze_function(part, ratio)
        assert angle_distance(beside.breaks % np.pi, np.tile(plain.breaks, 2)) < off


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_periods_are_those_of_the_symmetry(case):
    part, order = PARTS[case["name"]], case["symmetry_order"]
    # mirrored on 2 r axes, regular shapes of odd order r come to rest as if of order 2 r
    regular = case["name"] in ("triangle_equilateral", "pentagon", "star5")
    beside = 2 * np.pi / (2 * order if regular else order)
    assert shift_squeeze_function(part).period == pytest.approx(beside)
    assert centred_squeeze_function(part).period == pytest.approx(case["period_T"])
    assert unknown_offset_function(part).period == pytest.approx(case["period_T"])


@pytest.mark.parametrize("name", ["T", "simple_16", "pentagon"])
def test_the_other_side_is_half_a_turn_away(name):
    part = PARTS[name]
    left, right = (shift_squeeze_function(part, 2.0, side) for side in ("left", "right"))
    assert angle_distance(right.breaks, left.breaks + np.pi, 2 * np.pi) < 1e-9
    assert angle_distance(right.images, left.images + np.pi, 2 * np.pi) < 1e-9


def test_bands_are_as_wide_as_borders_move():
    part = PARTS["T"]
    plain = squeeze_function(turn_function(part))
    found = unknown_offset_function(part, 1.0)
    shift = max(np.abs(found.breaks - plain.breaks).max(), np.abs(found.ends - plain.ends).max())
    assert shift == pytest.approx(boundary_shift(part, 1.0), abs=1e-9)


def test_models():
    part = PARTS["T"]
    assert step_function(part, "squeeze", 1.0).modulus == np.pi
    assert step_function(part, "push-squeeze", 1.0).modulus == 2 * np.pi
    centred = step_function(part, "centred", 10.0)
    assert np.array_equal(centred.breaks, centred_squeeze_function(part, 10.0).breaks)
    unknown = step_function(part, "unknown-offset", 1.0)
    assert (unknown.ends < np.append(unknown.breaks[1:], unknown.breaks[0] + np.pi)).all()


def test_bad_arguments_are_named():
    part = PARTS["T"]
    with pytest.raises(InputError, match=r"model.*push-squeeze"):
        step_function(part, "throw", 1.0)
    with pytest.raises(InputError, match="mobility_ratio"):
        step_function(part, "squeeze", -1.0)
    with pytest.raises(InputError, match="side"):
        shift_squeeze_function(part, 1.0, "above")
