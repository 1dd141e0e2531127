"""Tips with their full mean friction: slow parts feel the set, fast ones drift with the tips."""

import numpy as np
import pytest
from scipy.constants import g

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.simulate import simulate
from limitsurf.motion.trajectory import Outcome


@pytest.fixture(scope="module")
def square():
    return Part([(0, 0), (2e-3, 0), (2e-3, 2e-3), (0, 2e-3)], "80 g/m^2")


def all_towards(array, direction):
    return Activation(array, array.site_directions @ np.array(direction) > 0.5)


def test_a_part_without_drag_drifts_as_fast_as_its_tips(array64, square):
    """The sawtooth tip drifts at 2 mm/s: there its mean friction vanishes."""
    w = 2e-3 * np.array([1.0, 1.0, 1.0, -3.0])
    tip = OscillatingContact(array64.pixel.friction, [1.0, 0.0], w, 1.0)
    drift = tip.drift_velocity[0]
    path = simulate(
        square,
        all_towards(array64, (1, 0)),
        (-2e-3, -5e-5, 0.0),
        0.2,
        tip=tip,
        drag=(0, 0, 0),
        time_step=1e-3,
    )
    assert path.twists[-1] == pytest.approx([drift, 0, 0], rel=1e-3, abs=1e-9)
    assert np.abs(path.energy.residual).max() < 1e-8 * path.energy.work.max()


def test_with_drag_push_and_drag_balance(array64, square):
    """Quasi-static: the speed at which N mu phi'(v) equals the drag, by bisection here."""
    from scipy.optimize import brentq

    w = 5e-3 * np.sin(2 * np.pi * (np.arange(64) + 0.5) / 64)
    force = 1.0 + 0.5 * np.sin(2 * np.pi * (np.arange(64) + 0.5) / 64)
    tip = OscillatingContact(array64.pixel.friction, [1.0, 0.0], w, force)
    drag, weight = air_film_drag(square, array64)[0], square.mass * g

    def balance(v):
        return -weight * tip.gradient([v, 0.0])[0] - drag * v

    speed = brentq(balance, 0.0, 5e-3)
    path = simulate(
        square,
        all_towards(array64, (1, 0)),
        (-2e-3, -5e-5, 0.0),
        0.05,
        tip=tip,
        mode="quasi-static",
        time_step=1e-3,
    )
    assert path.twists[0] == pytest.approx([speed, 0, 0], rel=1e-6, abs=1e-12)


def test_slow_parts_feel_the_push_at_rest(array64, paper_t):
    """Fast tips: the potential is that of the set, and the paths agree."""
    w = 10.0 * np.array([0.6, 0.8, 1.0, -1.2, -0.9])
    tip = OscillatingContact(array64.pixel.friction, [1.0, 0.0], w, [1.0, 1.0, 1.0, 1.0, 1.0])
    from dataclasses import replace

    fraction = float(tip.offset[0] / tip.mu)
    pixel = replace(array64.pixel, offset_fraction=fraction, residual_fraction=0.0, tip_width=0.0)
    drive = squeeze_activation(replace(array64, pixel=pixel), 0.2)
    ends = [
        simulate(paper_t, drive, (2e-4, 3e-4, 1.0), 0.02, tip=t, time_step=2e-4, frames=5)
        for t in (None, tip)
    ]
    moved = ends[0].final_pose - ends[0].poses[0]
    assert np.abs(moved[1]) > 1e-6
    assert ends[1].final_pose == pytest.approx(ends[0].final_pose, rel=1e-2, abs=1e-8)


def test_tips_that_rest_half_the_time_hold_a_part(array64, square):
    w = np.array([0.0, 0.0, 0.0, 3e-3, 0.0, -3e-3])
    tip = OscillatingContact(array64.pixel.friction, [1.0, 0.0], w, 1.0)
    drive = all_towards(array64, (1, 0))
    held = 0.9 * float(tip.radius) * square.mass * g
    path = simulate(square, drive, (0, -5e-5, 0), 0.1, tip=tip, load=(held, 0, 0))
    assert path.outcome is Outcome.REST
    assert np.array_equal(path.final_pose, path.poses[0])
    pulled = simulate(square, drive, (0, -5e-5, 0), 0.02, tip=tip, load=(1.5 * held, 0, 0))
    assert pulled.final_pose[0] > 1e-6


def test_a_part_leaves_the_array(array64, square):
    tip = OscillatingContact(0.3, [1.0, 0.0], 0.1 * np.array([1.0, 1.0, 1.0, -3.0]), 1.0)
    path = simulate(
        square, all_towards(array64, (1, 0)), (5.3e-3, -5e-5, 0), 5.0, tip=tip, time_step=2e-3
    )
    assert path.outcome is Outcome.LEFT_ARRAY
    assert path.final_pose[0] == pytest.approx(5.4e-3, abs=1e-4)


def test_the_resonators_own_tip_pushes_a_little_less_on_a_moving_part(array64, square):
    load = square.areal_density * g * array64.pixel.pitch**2
    tip = array64.pixel.tip(load, 50.0)
    drive = all_towards(array64.running_under(square), (1, 0))
    start = (-2e-3, -5e-5, 0.0)
    at_rest = simulate(square, drive, start, 0.05, mode="quasi-static", time_step=2e-3)
    moving = simulate(square, drive, start, 0.05, mode="quasi-static", time_step=2e-3, tip=tip)
    ratio = moving.twists[0, 0] / at_rest.twists[0, 0]
    assert 0.4 < ratio < 0.95


def test_several_tips_are_refused(array64, square):
    tip = OscillatingContact(0.3, [[1.0, 0.0]] * 2, [1.0, 1.0, -2.0], 1.0)
    with pytest.raises(InputError, match="tip: has shape"):
        simulate(square, all_towards(array64, (1, 0)), tip=tip)


def test_a_tolerance_is_refused(array64, square):
    tip = OscillatingContact(0.3, [1.0, 0.0], [1.0, 1.0, -2.0], 1.0)
    with pytest.raises(InputError, match="tolerance: is not for"):
        simulate(square, all_towards(array64, (1, 0)), tip=tip, tolerance=1e-3)
