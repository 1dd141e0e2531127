import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.planning.moment_ratio import MomentRatio
from limitsurf.planning.squeeze_function import SqueezeFunction, squeeze_function
from limitsurf.planning.step_bounds import exact_bounds, step_bounds
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, NAMES

LOBED = ["T", "U_sym", "blob_m3", "simple_16", "longplan_L5"]


def turn_of(name):
    return turn_function(Part(CASES[NAMES.index(name)]["vertices"]))


def flow_ends(ratio, phi, tangent, noise):
    """Slow twin: follow the sign of a perturbed moment on a fine grid until it changes."""
    grid = np.linspace(0.0, np.pi, 7200, endpoint=False)
    drive = np.sign(ratio(grid) - tangent + noise(grid))
    ends = []
    for start in phi:
        j = int(np.floor(start / grid[1]))
        for _ in range(len(grid)):
            step = int(drive[j % len(grid)])
            if step * drive[(j + step) % len(grid)] <= 0:
                break
            j += step
        ends.append(j * grid[1])
    return np.array(ends)


@pytest.mark.parametrize("name", LOBED)
def test_without_errors_bounds_are_the_squeeze_function(name):
    squeeze = squeeze_function(turn_of(name))
    phi = np.linspace(-4.0, 7.0, 1777)
    found = exact_bounds(squeeze).reach(np.column_stack([phi, phi]))
    assert np.array_equal(found[:, 0], found[:, 1])
    apart = np.mod(found[:, 0] - squeeze(phi) + 1.0, np.pi) - 1.0
    assert np.abs(apart).max() < 1e-12
    bounds = step_bounds(squeeze, MomentRatio(turn_of(name)), 0.0, 0.0)
    away = np.abs(phi[:, None] - np.concatenate([squeeze.breaks + np.pi * k for k in range(-3, 4)]))
    clear = away.min(axis=1) > 1e-4
    assert np.abs(bounds.reach(np.column_stack([phi, phi])) - found)[clear].max() < 1e-4
    assert not bounds.lost.any()


@pytest.mark.parametrize("name", LOBED)
@pytest.mark.parametrize("share", [0.05, 0.3, 0.8])
def test_perturbed_moments_stay_within_the_bounds(name, share, rng):
    """Any moment error of at most the width, however it depends on the orientation."""
    turn = turn_of(name)
    ratio, squeeze = MomentRatio(turn), squeeze_function(turn)
    top = float(np.abs(ratio(np.linspace(0, np.pi, 999))).max())
    tangent, width = 0.3 * share * top, share * top
    bounds = step_bounds(squeeze, ratio, tangent, width)
    phi = np.linspace(0.0, np.pi, 91, endpoint=False) + 1e-3
    reach = bounds.reach(np.column_stack([phi, phi]))
    assert (reach[:, 0] <= reach[:, 1]).all()
    for _ in range(4):
        waves, phase = rng.integers(1, 20), rng.uniform(0, 6.28)
        kind = rng.integers(3)

        def noise(x, waves=waves, phase=phase, kind=kind):
            wave = np.cos(2 * waves * x + phase)
            return 0.999 * width * (wave, np.sign(wave), np.full_like(x, np.sign(phase - 3)))[kind]

        ends = flow_ends(ratio, phi, tangent, noise)
        middle = reach.mean(axis=1)
        ends += np.pi * np.round((middle - ends) / np.pi)
        slack = 3 * np.pi / 7200
        assert (ends >= reach[:, 0] - slack).all()
        assert (ends <= reach[:, 1] + slack).all()


@pytest.mark.parametrize("name", ["T", "U_sym"])
def test_wider_errors_reach_further(name):
    """Where no place to rest lies on the way to another: such a hull may be wider than needed."""
    turn = turn_of(name)
    ratio, squeeze = MomentRatio(turn), squeeze_function(turn)
    phi = np.linspace(0.0, np.pi, 301)
    top = np.tan(turn.critical_angle)
    last = np.tile([np.inf, -np.inf], (len(phi), 1))
    for share in (0.0, 0.02, 0.1, 0.3, 0.6, 0.9):
        reach = step_bounds(squeeze, ratio, 0.0, share * top).reach(np.column_stack([phi, phi]))
        anywhere = np.diff(reach)[:, 0] >= np.pi - 1e-9
        assert (anywhere | (reach[:, 0] <= last[:, 0] + 1e-9)).all()
        assert (anywhere | (reach[:, 1] >= last[:, 1] - 1e-9)).all()
        last = reach
    assert not np.isinf(last).any()


def test_beyond_the_critical_angle_all_is_lost():
    turn = turn_of("T")
    for tangent, width in ((1.01, 0.0), (-1.01, 0.0), (0.0, 1.01)):
        tan = np.tan(turn.critical_angle)
        bounds = step_bounds(squeeze_function(turn), MomentRatio(turn), tangent * tan, width * tan)
        assert bounds.lost.all()
        assert np.diff(bounds.reach(np.array([[0.3, 0.3]])))[0, 0] == pytest.approx(np.pi)


def test_breaks_of_other_models_move_with_the_unstable_orientation():
    """Period 2 pi, breaks a little off the unstable orientations, gaps between the steps."""
    turn = turn_of("U_sym")
    ratio, plain = MomentRatio(turn), squeeze_function(turn)
    k, off = len(plain.breaks), 0.02
    breaks = np.concatenate([plain.breaks, plain.breaks + np.pi]) + off
    images = np.concatenate([plain.images, plain.images + np.pi])
    ends = np.append(breaks[1:], breaks[0] + 2 * np.pi) - 0.5 * off
    other = SqueezeFunction(breaks, ends, images, 2 * np.pi, 2 * np.pi)
    a, b = (step_bounds(s, ratio, 0.0, 0.01) for s in (plain, other))
    assert b.bands[:, 1] == pytest.approx(np.append(a.bands[:, 1], a.bands[:, 1] + np.pi) + off)
    assert b.bands[k:, 0] - a.bands[:, 0] == pytest.approx(np.full(k, np.pi + 0.5 * off))
    assert b.rests[:k] == pytest.approx(a.rests)
    assert b.rests[k:] == pytest.approx(a.rests + np.pi)
