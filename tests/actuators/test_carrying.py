import numpy as np
import pytest
from scipy.constants import g

import limitsurf as ls
from limitsurf.actuators.activation import Activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.actuators.carrying import carry
from limitsurf.actuators.force_fields import uniform_field
from limitsurf.actuators.realised_field import activate
from limitsurf.errors import InputError, PartTooHeavy

CARD = ls.Part.from_file("nano_sim")
POSE = (1e-4, -2e-4, 0.4)


def drive(voltage):
    return activate(load_array("resonator128", voltage=voltage), uniform_field(0.0))


def test_active_tips_lift_and_inactive_ones_hang_free():
    state = carry(drive(60.0), CARD, POSE)
    assert state.lifted
    assert state.load_per_active * state.active == pytest.approx(CARD.mass * g)
    assert state.load_per_passive == 0.0
    assert state.passive == pytest.approx(3 * state.active, rel=0.05)
    assert len(state.contacts) == state.active
    state.require_lifted()


def test_a_lifted_part_moves():
    state = carry(drive(60.0), CARD, POSE)
    load = ls.friction_load(state.contacts.limit_surface(), [0.0, 0.0, 0.0])
    assert not load.sticks
    assert load.net[0] > 0.0
    assert load.net[0] == pytest.approx(0.1 * 0.3 * CARD.mass * g, rel=0.05)


def test_a_part_too_heavy_rests_on_all_tips_and_nothing_moves():
    """Three of four tips hold it with 3/4 mu W, one pushes with at most 1/4 mu W."""
    state = carry(drive(50.0), CARD, POSE)
    assert not state.lifted
    assert state.load_per_active == state.load_per_passive
    total = state.load_per_active * (state.active + state.passive)
    assert total == pytest.approx(CARD.mass * g)
    assert len(state.contacts) == state.active + state.passive
    hold = state.contacts.radius.sum()
    assert hold == pytest.approx(0.75 * 0.3 * CARD.mass * g, rel=0.02)
    assert np.linalg.norm(state.contacts.offset.sum(axis=0)) < hold / 3
    assert ls.friction_load(state.contacts.limit_surface(), [0.0, 0.0, 0.0]).sticks


def test_the_error_names_the_voltage_needed():
    state = carry(drive(50.0), CARD, POSE)
    with pytest.raises(PartTooHeavy, match="would lift it") as caught:
        state.require_lifted()
    assert caught.value.lifting_voltage == state.lifting_voltage
    assert 53.0 < state.lifting_voltage < 57.0
    assert carry(drive(1.001 * state.lifting_voltage), CARD, POSE).lifted


def test_without_active_tips_nothing_lifts():
    array = load_array("resonator128")
    off = Activation(array, np.zeros((256, 256), bool))
    state = carry(off, CARD, POSE)
    assert (state.lifted, state.active, state.lifting_voltage) == (False, 0, np.inf)
    assert ls.friction_load(state.contacts.limit_surface(), [0.0, 0.0, 0.0]).sticks
    with pytest.raises(PartTooHeavy):
        state.require_lifted()


def test_dead_actuators_carry_nothing():
    array = load_array("resonator128", voltage=60.0).with_spread(dead=0.03, seed=2)
    everywhere = Activation(array, array.nominal_directions[..., 0] > 0.5)
    alive, state = carry(drive(60.0), CARD, POSE), carry(everywhere, CARD, POSE)
    assert state.active < alive.active
    assert state.active + state.passive == alive.active + alive.passive
    assert state.load_per_active > alive.load_per_active


def test_a_part_off_the_array_is_named():
    with pytest.raises(InputError, match="pose"):
        carry(drive(60.0), CARD, (1.0, 0.0, 0.0))


def test_the_push_can_be_computed_from_the_resonator():
    """Paper on the 1994 array at 50 V: 0.16 of mu N, not the model's assumed 0.1."""
    part, array = ls.Part.from_file("paper_t"), load_array("resonator64")
    running = array.running_under(part)
    assert running.pixel.offset_fraction == pytest.approx(0.157, abs=0.002)
    assert running.pixel.residual_fraction == 0.0
    assert array.pixel.offset_fraction == 0.1
    drive = ls.squeeze_activation(running, 0.0)
    assert ls.simulate(part, drive, (0, 1e-3, 1.0)).outcome.name == "REST"
    with pytest.raises(PartTooHeavy):
        array.running_under(CARD)
    assert load_array("resonator128", voltage=56.5).running_under(CARD).pixel.offset_fraction > 0.05
