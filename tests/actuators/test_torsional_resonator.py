"""Numbers of the 1994 paper, statics, free oscillation."""

import numpy as np
import pytest
from scipy.constants import g
from scipy.integrate import quad
from scipy.optimize import brentq

from limitsurf.actuators.resonator_kernel import grid_record
from limitsurf.actuators.rim_force import calibrated_width, force_scaling
from limitsurf.actuators.torsional_resonator import TorsionalResonator
from limitsurf.errors import AmplitudeBeyondClearance, BeyondPullIn, InputError, ModelError
from limitsurf.modelfiles import find_model
from limitsurf.units import parse_quantity
from tests.actuators.resonator_twin import LEGENDRE, rim_torque

PAPER = 80e-3 * g  # N/m^2: weight of paper of 80 g/m^2


@pytest.fixture(scope="module")
def resonator():
    return TorsionalResonator.from_model("resonator1994")


def test_force_of_the_paper(resonator):
    """Section 5: 2.8e-7 N at 50 V; 2.8e-11 N/um^2; paper 8e-13 N/um^2, 35 times less."""
    assert resonator.vertical_force(50.0) == pytest.approx(2.8e-7, rel=5e-3)
    assert resonator.force_per_area(50.0) * 1e-12 == pytest.approx(2.8e-11, rel=5e-3)
    assert 0.080 * g * 1e-12 == pytest.approx(8e-13, rel=2.5e-2)
    assert resonator.force_per_area(50.0) / 0.8 == pytest.approx(35.0, rel=5e-3)
    assert resonator.force_per_area(50.0) / PAPER == pytest.approx(35.0, rel=3e-2)


def test_ideal_plate_is_eleven_times_the_finite_element_figure(resonator):
    assert resonator.ideal_force(50.0) == pytest.approx(3.07e-6, rel=2e-3)
    assert resonator.ideal_force(50.0) / 2.8e-7 == pytest.approx(11.0, rel=2e-2)


def test_sizes_of_the_paper(resonator):
    assert resonator.grid_width == resonator.grid_length == pytest.approx(50e-6)
    assert (resonator.beam_width, resonator.beam_height) == pytest.approx((1e-6, 3e-6))
    assert resonator.clearance == pytest.approx(3e-6)
    assert resonator.cell_area == pytest.approx(1e-8)


def test_calibration_is_about_one_beam(resonator):
    width = calibrated_width(2.8e-7, resonator.perimeter, resonator.clearance, 50.0)
    assert width == pytest.approx(resonator.effective_width, rel=5e-3)
    assert width == pytest.approx(resonator.beam_width, rel=0.2)


def test_resonates_in_the_high_khz_with_several_um(resonator):
    """Section 2: resonance in the high kHz, edges reach several um; here at 50 V and Q = 60."""
    assert 1e5 < resonator.resonance < 1e6
    assert resonator.quality == 60.0
    assert 1e-6 < resonator.amplitude(50.0) < 3e-6
    assert resonator.frequency_response(50.0).edge_amplitude.max() < 3e-6


def test_force_falls_with_size_and_force_per_area_rises(resonator):
    sizes = np.geomspace(5e-6, 200e-6, 30)
    curve = force_scaling(resonator, sizes, 50.0)
    assert np.polyfit(np.log(sizes), np.log(curve.force), 1)[0] == pytest.approx(1.0)
    assert np.polyfit(np.log(sizes), np.log(curve.force_per_area), 1)[0] == pytest.approx(-1.0)
    assert "gap 3 um" in curve.condition
    assert "fixed" in curve.condition
    smaller = resonator.varied(grid_width=25e-6, grid_length=25e-6, cell_area=2.5e-9)
    assert force_scaling(resonator, 25e-6, 50.0).force_per_area == pytest.approx(
        smaller.force_per_area(50.0)
    )


def test_voltages_broadcast_and_invert(resonator):
    volts = np.array([[10.0, 20.0], [30.0, 50.0]])
    assert resonator.vertical_force(volts).shape == (2, 2)
    assert resonator.lifting_voltage(resonator.vertical_force(volts)) == pytest.approx(volts)
    assert resonator.vertical_force(parse_quantity("50 V", "V")) == resonator.vertical_force(50)


def test_inertia_is_the_integral_over_grid_and_poles():
    base = TorsionalResonator.from_model("resonator1994").varied(
        rod_offset=7e-6, poles="-x", beam_pitch=1e-6
    )
    a, t, d = base.grid_width, base.beam_height, base.rod_offset
    plate = quad(lambda x: (x * x + t * t / 12) * t, -a / 2 - d, a / 2 - d)[0] * base.grid_length
    pole = quad(lambda z: z * z + (a / 2 + d) ** 2, t / 2, t / 2 + base.pole_height)[0]
    assert base.inertia == pytest.approx(base.density * (plate + base.pole_section * pole))


@pytest.mark.parametrize("driven", ["-x", "+x"])
@pytest.mark.parametrize("offset", [0.0, 6e-6])
def test_static_tilt_and_pull_in(resonator, driven, offset):
    one = resonator.varied(driven=driven, rod_offset=offset)
    limit = one.pull_in_voltage
    for share in (0.1, 0.7, 0.999):
        tilt = one.static_tilt(share * limit)
        assert one.stiffness * tilt == pytest.approx(one.torque(share * limit, tilt), rel=1e-9)
        squares = (limit**2 * share**2, 0.0) if driven == "-x" else (0.0, limit**2 * share**2)
        assert one.torque(share * limit, tilt) == pytest.approx(
            float(rim_torque(one, tilt, *squares)), rel=1e-9
        )
        assert np.sign(tilt) == (1.0 if driven == "-x" else -1.0)
    with pytest.raises(BeyondPullIn, match=f"{limit:.4g} V") as caught:
        one.static_tilt(limit * 1.0001)
    assert caught.value.pull_in == limit
    assert one.static_tilt(0.0) == 0.0


def test_pull_in_is_where_the_two_equilibria_meet(resonator):
    """Scan of V^2 over the tilt, on the twin's torque."""
    one = resonator.varied(driven="-x")
    tilts = np.linspace(1e-4, 0.999, 20001) * one.clearance / one.levers[1]
    unit = np.array([float(rim_torque(one, t, 1.0, 0.0)) for t in tilts[::40]])
    scan = np.sqrt((one.stiffness * tilts[::40] / unit).max())
    assert one.pull_in_voltage == pytest.approx(scan, rel=1e-4)
    assert len(LEGENDRE[0]) == 40


def test_small_amplitudes_are_those_of_the_linear_oscillator(resonator):
    """Torque V^2/2 per driven side at f; both sides in turn give twice that."""
    one = resonator.varied(driven="-x")
    k, j, c, volts = one.stiffness, one.inertia, one.damping, 0.5
    for f in (0.3e5, 2.5e5, one.resonance, 2.8e5, 9e5):
        w = 2 * np.pi * f
        linear = 0.5 * one.torque(volts) / np.hypot(k - j * w * w, c * w) * one.levers[1]
        assert one.amplitude(volts, f) == pytest.approx(linear, rel=1e-4)
        assert resonator.amplitude(volts, f) == pytest.approx(2 * linear, rel=1e-4)


def test_either_drive_gives_the_same_small_amplitude(resonator):
    """V^2 has the harmonic V^2/2 at f, with a sine at f/2 and with a bias of V/2."""
    for frequency in (None, 2.6e5):
        sine = resonator.amplitude(1.0, frequency)
        biased = resonator.varied(drive="biased").amplitude(1.0, frequency)
        assert sine == pytest.approx(biased, rel=1e-4)


def test_amplitude_at_resonance_is_the_peak_of_the_response(resonator):
    response = resonator.frequency_response(50.0, np.linspace(1.4, 1.7, 601))
    assert resonator.amplitude(50.0) == pytest.approx(response.edge_amplitude.max(), rel=1e-3)
    motion = resonator.motion(50.0)
    assert resonator.amplitude(50.0, motion.frequency) == pytest.approx(
        motion.edge_amplitude, rel=1e-3
    )
    assert motion.lag == pytest.approx(np.pi / 2)
    assert abs(motion.mean_tilt) < 1e-12 * motion.tilt_amplitude  # both sides in turn


def test_response_leans_to_lower_frequencies(resonator):
    low, high = resonator.motion(1.0), resonator.motion(55.0)
    assert high.frequency < low.frequency
    linear = low.edge_amplitude * 55.0**2
    assert high.edge_amplitude > 1.15 * linear  # the gap closes on the pulling side


def test_amplitude_at_a_frequency_meets_the_balance_of_the_twin(resonator):
    """c w A and (k - J w^2) A equal the torque's harmonics for some phase of the drive."""
    frequency = 0.995 * resonator.motion(45.0).frequency
    motion = resonator.motion(45.0, frequency)
    assert motion.frequency == pytest.approx(frequency, rel=1e-9)
    grid, w = grid_record(resonator), 2 * np.pi * frequency
    phase = 2 * np.pi * np.arange(128) / 128
    ahead = phase + motion.lag - np.pi / 2
    tilt = motion.mean_tilt + motion.tilt_amplitude * np.sin(phase)
    left, right = 45.0**2 * np.cos(ahead / 2) ** 2, 45.0**2 * np.sin(ahead / 2) ** 2
    torque = rim_torque(resonator, tilt, left, right)
    cos, sin = 2 * (torque * np.cos(phase)).mean(), 2 * (torque * np.sin(phase)).mean()
    assert grid.damping * w * motion.tilt_amplitude == pytest.approx(cos, rel=1e-8)
    assert (grid.stiffness - grid.inertia * w * w) * motion.tilt_amplitude == pytest.approx(
        sin, rel=1e-6
    )


def test_amplitude_beyond_the_clearance_is_named(resonator):
    with pytest.raises(AmplitudeBeyondClearance, match="clearance of 3 um"):
        resonator.amplitude(70.0)
    with pytest.raises(AmplitudeBeyondClearance):
        resonator.varied(quality=300.0).amplitude(50.0)
    assert np.isnan(resonator.frequency_response(70.0).edge_amplitude).any()


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"contact_stiffness": -1.0}, "contact_stiffness"),
        ({"rod_length": 0.0}, "rod_length"),
        ({"quality": np.nan}, "quality"),
        ({"contact_damping": -1e-9}, "contact_damping"),
        ({"restitution": 1.5, "contact_damping": 0.0}, "restitution"),
        ({"restitution": 0.5}, "twice"),
        ({"rod_offset": 26e-6}, "rod_offset"),
        ({"beam_pitch": 0.5e-6}, "beam_pitch"),
        ({"poles": "up"}, "poles"),
        ({"driven": "none"}, "driven"),
        ({"drive": "square"}, "drive"),
        ({"shear_modulus_tall": -79.6e9}, "shear_modulus_tall"),
        ({"colour": 1.0}, "colour"),
        ({"quality": "high"}, "quality"),
        ({"rod_offset": None}, "rod_offset"),
    ],
)
def test_bad_numbers_are_named(resonator, changes, name):
    with pytest.raises(InputError, match=name):
        resonator.varied(**changes)


@pytest.mark.parametrize("value", [0.0, -50.0, np.nan, np.inf, "50"])
def test_bad_voltages_and_frequencies(resonator, value):
    with pytest.raises(InputError, match="voltage"):
        resonator.amplitude(value)
    with pytest.raises(InputError, match="frequency"):
        resonator.amplitude(50.0, value)


@pytest.mark.parametrize("value", [-50.0, np.nan, np.inf, "50 V", None])
def test_bad_voltages_of_statics_are_named(resonator, value):
    for force in (
        resonator.vertical_force,
        resonator.ideal_force,
        resonator.force_per_area,
        resonator.torque,
        resonator.static_tilt,
    ):
        with pytest.raises(InputError, match="voltage"):
            force(value)
    with pytest.raises(InputError, match="sizes"):
        force_scaling(resonator, [-1e-5], 50.0)


def test_model_files_that_cannot_be_built_are_named(resonator, tmp_path):
    text = find_model("resonators", "resonator1994").read_text()
    path = tmp_path / "lossy.toml"
    path.write_text(text.replace("value = 1\n", "value = 0.5\n"))
    with pytest.raises(ModelError, match=r"lossy\.toml: restitution"):
        TorsionalResonator.from_model(path)


def test_other_bad_arguments(resonator):
    with pytest.raises(InputError, match="tilt"):
        resonator.torque(50.0, 0.2)
    with pytest.raises(InputError, match="voltage"):
        resonator.static_tilt(-1.0)
    with pytest.raises(InputError, match="force"):
        resonator.lifting_voltage(-1.0)
    with pytest.raises(InputError, match="lags"):
        resonator.frequency_response(50.0, [0.0])


def test_the_model_says_what_is_assumed(resonator):
    assert set(resonator.assumed) == {
        "beam_pitch",
        "rod_length",
        "rod_offset",
        "pole_height",
        "pole_section",
        "quality",
        "contact_stiffness",
        "contact_damping",
        "restitution",
    }
    assert brentq(lambda v: resonator.vertical_force(v) - 2.8e-7, 1.0, 90.0) == pytest.approx(
        50.0, abs=0.1
    )
