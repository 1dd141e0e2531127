import numpy as np
import pytest

import limitsurf as ls
from limitsurf.actuators.activation import direction_error, squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.actuators.spread import draw_spread
from limitsurf.errors import InputError

SPREAD = {"strength": 0.2, "direction": 0.1, "dead": 0.05}


def test_moments_of_the_draw():
    spread = draw_spread((300, 300), **SPREAD, seed=5)
    assert spread.strength.mean() == pytest.approx(1.0, abs=3e-3)
    assert spread.strength.std() == pytest.approx(0.2, rel=0.02)
    assert spread.strength.min() > 0.0
    assert (spread.turn.mean(), spread.turn.std()) == pytest.approx((0.0, 0.1), abs=2e-3)
    assert spread.dead.mean() == pytest.approx(0.05, abs=3e-3)


def test_same_seed_same_draw():
    first, again, other = (draw_spread((9, 4), **SPREAD, seed=s) for s in (1, 1, 2))
    assert np.array_equal(first.strength, again.strength)
    assert np.array_equal(first.dead, again.dead)
    assert not np.array_equal(first.turn, other.turn)


def test_no_spread_changes_nothing(array64):
    same = array64.with_spread()
    assert np.array_equal(same.site_directions, array64.site_directions)
    assert same.alive.all()


def test_pushes_have_strength_turn_and_death():
    array = load_array("resonator32").with_spread(**SPREAD, seed=3)
    nominal, pushes = array.nominal_directions, array.site_directions
    size = np.linalg.norm(pushes, axis=-1)
    assert np.array_equal(size == 0.0, array.spread.dead)
    alive = array.alive
    assert size[alive] == pytest.approx(array.spread.strength[alive])
    cross = nominal[..., 0] * pushes[..., 1] - nominal[..., 1] * pushes[..., 0]
    angle = np.arctan2(cross, np.sum(nominal * pushes, axis=-1))
    assert angle[alive] == pytest.approx(array.spread.turn[alive])


def test_activations_leave_dead_actuators_out():
    array = load_array("resonator32").with_spread(dead=0.1, seed=2)
    activation = squeeze_activation(array, 0.4)
    assert not np.any(activation.active & ~array.alive)
    assert activation.active.sum() == pytest.approx(0.9 * 1024, abs=40)
    assert direction_error(activation) < np.radians(6.0)
    assert array.at_voltage(40.0).spread is array.spread


def test_a_part_still_aligns_on_an_array_with_spread():
    array = load_array("resonator64").with_spread(strength=0.1, direction=0.05, dead=0.02, seed=7)
    part = ls.Part.from_file("paper_t")
    perfect = ls.simulate(part, squeeze_activation(load_array("resonator64"), 0.0), (0, 1e-3, 1.0))
    run = ls.simulate(part, squeeze_activation(array, 0.0), (0, 1e-3, 1.0))
    assert run.outcome.name == "REST"
    assert run.final_pose[2] == pytest.approx(perfect.final_pose[2], abs=0.1)
    assert not np.array_equal(run.final_pose, perfect.final_pose)


@pytest.mark.parametrize(
    ("bad", "name"),
    [({"strength": -0.1}, "strength"), ({"direction": np.nan}, "direction"), ({"dead": 2}, "dead")],
)
def test_bad_spreads_are_named(bad, name):
    with pytest.raises(InputError, match=name):
        draw_spread((2, 2), **bad)
