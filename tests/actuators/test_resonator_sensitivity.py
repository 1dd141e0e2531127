import numpy as np
import pytest

from limitsurf.actuators.resonator_sensitivity import sensitivity
from limitsurf.actuators.torsional_resonator import TorsionalResonator
from limitsurf.errors import InputError

BASE = TorsionalResonator.from_model("resonator1994")
LOAD, VOLTAGE, MU = 3.1e-8, 50.0, 0.3


def test_sensitivity_names_every_assumed_number_that_counts():
    table = sensitivity(BASE, LOAD, VOLTAGE, MU)
    assert set(table) == {
        "beam_pitch",
        "rod_length",
        "pole_height",
        "pole_section",
        "quality",
        "contact_stiffness",
        "contact_damping",
        "mu",
    }
    assert table["rod_length"]["resonance"] == pytest.approx(-0.5, abs=1e-6)
    assert table["quality"]["resonance"] == 0.0
    assert table["quality"]["edge_amplitude"] > 1.0  # the gap closes
    assert table["contact_damping"]["offset"] == pytest.approx(1.0, abs=0.1)
    assert table["mu"]["offset"] == pytest.approx(1.0, abs=0.05)


def test_sensitivity_is_the_slope_of_coarse_differences():
    table = sensitivity(BASE, LOAD, VOLTAGE, MU, ("contact_stiffness",))
    low, high = (
        BASE.varied(contact_stiffness=10.0 * s).floating(LOAD, VOLTAGE, MU) for s in (0.99, 1.01)
    )
    slope = np.log(high.offset / low.offset) / np.log(1.01 / 0.99)
    assert table["contact_stiffness"]["offset"] == pytest.approx(slope, rel=1e-3)


def test_zero_has_no_relative_sensitivity():
    with pytest.raises(InputError, match="rod_offset"):
        sensitivity(BASE, LOAD, VOLTAGE, MU, ("rod_offset",))
