"""A part on the tips: why there is a push, where it points, and how large it is."""

import numpy as np
import pytest

from limitsurf.actuators.resonator_contact import single_tip
from limitsurf.actuators.torsional_resonator import TorsionalResonator
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.errors import AmplitudeBeyondClearance, InputError, PartTooHeavy, TipStalled
from tests.actuators.resonator_twin import march, twin_floating

MU = 0.3
PAPER = 80e-3 * 9.80665 * (200e-6) ** 2  # N, on one active tip per 200 um pixel
BASE = TorsionalResonator.from_model("resonator1994")
OFF_CENTER = BASE.varied(poles="none", rod_offset=5e-6)

CASES = [
    (BASE, PAPER, 50.0, 0.5 * np.pi),
    (BASE, 1.4e-7, 50.0, 0.5 * np.pi),
    (BASE, 3.4e-7, 75.0, 0.6),
    (OFF_CENTER.varied(driven="-x"), PAPER, 55.0, 0.5 * np.pi),
    (OFF_CENTER.varied(driven="+x", drive="biased"), PAPER, 55.0, 0.5 * np.pi),
    (BASE.varied(poles="both"), PAPER, 50.0, 0.5 * np.pi),
    (BASE.varied(contact_damping=0.0, restitution=0.7), PAPER, 50.0, 0.5 * np.pi),
]


def reference_offset(mu, velocity, force):
    """Return mean(mu N sign(w)) of samples joined linearly and periodically."""
    total = 0.0
    for i in range(len(velocity)):
        w0, w1 = velocity[i - 1], velocity[i]
        n0, n1 = force[i - 1], force[i]
        if w0 * w1 >= 0.0:
            total += np.sign(w0 + w1) * 0.5 * (n0 + n1)
        else:
            s = w0 / (w0 - w1)
            middle = n0 + s * (n1 - n0)
            total += np.sign(w0) * 0.5 * s * (n0 + middle)
            total += np.sign(w1) * 0.5 * (1 - s) * (middle + n1)
    return mu * total / len(velocity)


@pytest.mark.parametrize(("resonator", "load", "voltage", "lag"), CASES)
def test_balance_equals_the_slow_twin(resonator, load, voltage, lag):
    part = resonator.floating(load, voltage, MU, lag)
    amplitude, mean, omega, height, offset = twin_floating(resonator, load, voltage, MU, lag)
    assert part.tilt_amplitude == pytest.approx(amplitude, rel=1e-9)
    assert part.mean_tilt == pytest.approx(mean, rel=1e-8, abs=1e-12)
    assert 2 * np.pi * part.frequency == pytest.approx(omega, rel=1e-10)
    assert part.height == pytest.approx(height, rel=1e-10)
    assert part.offset_fraction == pytest.approx(offset, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize(("resonator", "load", "voltage", "lag"), CASES[:6])
def test_time_stepping_agrees_within_the_harmonics_left_out(resonator, load, voltage, lag):
    """The whole equation of motion, 400 cycles on: the push of heavy loads is a fifth less."""
    part = resonator.floating(load, voltage, MU, lag)
    amplitude, _, normal, offset = march(part, per=1600)
    assert amplitude == pytest.approx(part.tilt_amplitude, rel=0.04)
    assert normal == pytest.approx(load, rel=0.08)
    assert offset == pytest.approx(part.offset_fraction, rel=0.1 if load < 5e-8 else 0.22, abs=1e-4)


def test_lossless_contacts_give_no_push_however_asymmetric():
    for resonator in (BASE, OFF_CENTER, OFF_CENTER.varied(driven="-x", poles="-x")):
        part = resonator.varied(contact_damping=0.0).floating(PAPER, 50.0, MU)
        assert part.offset_fraction == 0.0
        assert part.shares.max() == 1.0  # and yet only one tip touches


@pytest.mark.parametrize("poles", ["none", "both"])
def test_symmetric_grids_give_no_push_however_lossy(poles):
    """Both edges touch, and push against each other."""
    part = BASE.varied(poles=poles, contact_damping=6e-7).floating(PAPER, 50.0, MU)
    assert part.shares == pytest.approx([0.5, 0.5])
    assert abs(part.offset_fraction) < 1e-12


@pytest.mark.parametrize("e", [0.0, 0.3, 0.8, 0.999])
@pytest.mark.parametrize("load", [PAPER, 5e-8])
def test_impact_limit(e, load):
    """|a| = mu mean(N) (1-e)/(1+e), at any load."""
    resonator = BASE.varied(contact_damping=0.0, restitution=e)
    part = resonator.floating(load, 50.0, MU)
    assert abs(part.offset) == pytest.approx(MU * load * (1 - e) / (1 + e), rel=1e-9)


def test_a_pole_at_plus_x_pushes_towards_minus_x():
    lossy = BASE.varied(contact_damping=2e-7)
    assert lossy.floating(PAPER, 50.0, MU).offset < 0.0
    assert lossy.varied(poles="-x").floating(PAPER, 50.0, MU).offset > 0.0
    right, left = (
        lossy.floating(PAPER, 50.0, MU),
        lossy.varied(poles="-x").floating(PAPER, 50.0, MU),
    )
    assert right.offset == pytest.approx(-left.offset, rel=1e-9)
    assert (right.shares[0], left.shares[1]) == (1.0, 1.0)


def test_rods_off_the_centre_push_like_a_pole_on_the_farther_edge():
    far_left = OFF_CENTER.floating(PAPER, 50.0, MU)
    assert far_left.shares[1] == 1.0
    assert far_left.offset > 0.0
    assert OFF_CENTER.varied(rod_offset=-5e-6).floating(PAPER, 50.0, MU).offset < 0.0


def test_rising_edge_goes_the_way_of_the_push():
    waves = BASE.floating(PAPER, 50.0, MU).waveforms(512)
    rising = np.diff(waves.height[0], append=waves.height[0, :1]) > 0.0
    assert np.all(waves.velocity[0, rising][1:-1] < 0.0)


@pytest.mark.parametrize("resonator", [BASE, OFF_CENTER], ids=["pole", "offset"])
def test_push_grows_with_loss(resonator):
    damping = np.array([0.0, 1e-8, 1e-7, 3e-7, 5e-7])
    pushes = [
        abs(resonator.varied(contact_damping=c).floating(PAPER, 50.0, MU).offset) for c in damping
    ]
    assert np.all(np.diff(pushes) > 0.0)
    losses = [1.0, 0.9, 0.5, 0.1, 0.0]
    plain = resonator.varied(contact_damping=0.0)
    pushes = [abs(plain.varied(restitution=e).floating(PAPER, 50.0, MU).offset) for e in losses]
    assert np.all(np.diff(pushes) > 0.0)


def test_mean_force_is_the_weight_carried():
    for resonator, load, voltage, lag in CASES:
        waves = resonator.floating(load, voltage, MU, lag).waveforms()
        assert waves.normal_force.sum(axis=0).mean() == pytest.approx(load, rel=1e-12)
        assert waves.normal_force.min() == 0.0


def test_contact_phases_bound_the_force():
    part = BASE.floating(1.4e-7, 50.0, MU)
    waves = part.waveforms(4096)
    phase = 2 * np.pi * part.frequency * waves.time - np.pi  # from the peak of the +x tip
    touching = phase[waves.normal_force[0] > 0.0]
    assert touching.min() == pytest.approx(-part.touch[0], abs=2e-3)
    assert touching.max() == pytest.approx(part.release[0], abs=2e-3)
    assert 0.0 < part.release[0] < part.touch[0]
    peak = waves.height[0].max()
    assert peak - part.height == pytest.approx(part.depths[0], rel=1e-3)


def test_heavier_parts_float_lower_on_slower_swings():
    loads = [1e-9, 1e-8, 1e-7, 2e-7]
    parts = [BASE.floating(load, 50.0, MU) for load in loads]
    assert np.all(np.diff([p.height for p in parts]) < 0.0)
    assert np.all(np.diff([p.edge_amplitude for p in parts]) < 0.0)
    assert np.all(np.diff([p.frequency for p in parts]) > 0.0)  # the part stiffens the spring
    assert BASE.floating(1e-13, 50.0, MU).edge_amplitude == pytest.approx(
        BASE.amplitude(50.0), rel=1e-3
    )


@pytest.mark.parametrize(("resonator", "order"), [(BASE, 1.9), (CASES[6][0], 0.9)])
def test_sampled_waveforms_give_the_offset(resonator, order):
    """Against the integral of the joined samples; the error falls with their number."""
    errors, counts = [], (64, 256, 1024)
    part = resonator.floating(PAPER, 50.0, MU)
    for n in counts:
        velocity, force = single_tip(part, n)
        assert not np.any((velocity == 0.0) & (np.roll(velocity, 1) == 0.0))
        errors.append(abs(reference_offset(MU, velocity, force) / part.offset - 1.0))
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] > order
    assert errors[1] < (1e-2 if order > 1.0 else 0.3)


def test_both_tips_of_one_height_are_one_contact():
    part = BASE.varied(poles="both").floating(PAPER, 50.0, MU)
    velocity, force = single_tip(part)
    assert abs(reference_offset(MU, velocity, force)) < 1e-12 * PAPER
    assert force.mean() == pytest.approx(PAPER)


def test_tips_of_two_heights_are_refused():
    stubby = BASE.varied(pole_height=2e-8)
    part = stubby.floating(PAPER, 50.0, MU)
    assert part.shares.min() > 0.0
    with pytest.raises(InputError, match="differ in height"):
        single_tip(part)


def test_contact_is_an_oscillating_contact():
    contact = BASE.contact(PAPER, 50.0, MU, facing=0.5 * np.pi, samples=1024)
    assert isinstance(contact, OscillatingContact)
    part = BASE.floating(PAPER, 50.0, MU)
    assert contact.offset == pytest.approx([0.0, part.offset], rel=1e-3, abs=1e-12 * PAPER)
    assert contact.radius == 0.0


def test_a_running_tip_pushes_a_slow_part_and_drags_a_fast_one():
    """The push ends at the drift speed; beyond the tip's own speed friction is passive."""
    contact = BASE.contact(PAPER, 50.0, MU, samples=1024)
    part = BASE.floating(PAPER, 50.0, MU)
    drift = contact.drift_velocity[0]
    assert drift * part.offset > 0.0
    assert abs(drift) == pytest.approx(14.8e-3, rel=0.01)
    assert contact.gradient([drift, 0.0])[0] == pytest.approx(0.0, abs=1e-6 * MU * PAPER)
    top = part.waveforms().velocity[0].max()
    assert contact.gradient([2 * top, 0.0])[0] == pytest.approx(MU * PAPER, rel=1e-9)


def test_a_part_too_heavy_names_the_voltage_needed():
    with pytest.raises(PartTooHeavy) as caught:
        BASE.floating(3.4e-7, 50.0, MU)
    assert caught.value.lifting_voltage == pytest.approx(55.0, abs=0.5)
    BASE.floating(3.4e-7, 1.01 * caught.value.lifting_voltage, MU)


def test_a_grid_that_the_part_would_stop_is_named():
    with pytest.raises(TipStalled, match="raise the voltage"):
        BASE.varied(contact_damping=5e-6).floating(2.7e-7, 50.0, MU)
    with pytest.raises(TipStalled, match="never leave"):
        BASE.varied(contact_stiffness=0.05, contact_damping=0.0).floating(2.7e-7, 50.0, MU)
    with pytest.raises(AmplitudeBeyondClearance):
        BASE.floating(PAPER, 70.0, MU)


def test_a_leading_drive_limits_the_swing():
    """At 75 V the edge would hit at resonance; with a lag below a quarter cycle it does not."""
    lag = BASE.lag_for(75.0, 1.5e-6)
    assert 0.0 < lag < 0.5 * np.pi
    part = BASE.floating(3.4e-7, 75.0, MU, lag)
    assert part.edge_amplitude < 1.5e-6
    assert part.lag == lag
    assert BASE.lag_for(50.0, 1.5e-6) == 0.5 * np.pi
    with pytest.raises(InputError, match="edge_amplitude"):
        BASE.lag_for(50.0, 3e-6)
    with pytest.raises(InputError, match="lag"):
        BASE.floating(PAPER, 50.0, MU, 0.0)


@pytest.mark.parametrize("voltage", [60.0, 75.0, 100.0])
def test_the_swing_of_a_lag_is_steady(voltage):
    """Past some 1.8 um it runs away before it gets there; below a static tilt it cannot come."""
    lag = BASE.lag_for(voltage, 1.5e-6)
    swing = BASE.frequency_response(voltage, [lag]).edge_amplitude
    assert swing == pytest.approx([1.5e-6], rel=1e-9)
    with pytest.raises(InputError, match="runs away"):
        BASE.lag_for(voltage, 2.5e-6)
    with pytest.raises(InputError, match="whatever the lag"):
        BASE.lag_for(voltage, 1e-12)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((0.0, 50.0, MU), "load"),
        (("heavy", 50.0, MU), "load"),
        ((PAPER, -1.0, MU), "voltage"),
        ((PAPER, 50.0, -0.1), "mu"),
    ],
)
def test_bad_arguments_are_named(arguments, name):
    with pytest.raises(InputError, match=name):
        BASE.floating(*arguments)
    with pytest.raises(InputError, match="samples"):
        BASE.floating(PAPER, 50.0, MU).waveforms(3)
