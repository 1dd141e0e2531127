import numpy as np
import pytest

from limitsurf.actuators.actuator_array import load_array
from limitsurf.errors import InputError, ModelError
from limitsurf.modelfiles import find_model


def test_sizes_and_sites(array64):
    assert (array64.rows, array64.columns) == (64, 64)
    assert array64.width == array64.height == pytest.approx(12.8e-3)
    assert array64.site_pitch == pytest.approx(100e-6)
    assert array64.site_directions.shape == (128, 128, 2)
    assert array64.pixel_centers.mean(axis=(0, 1)) == pytest.approx([0.0, 0.0], abs=1e-18)
    first = array64.pixel_centers[0, 0] - array64.site_pitch / 2
    assert array64.first_site == pytest.approx(tuple(first))


def test_every_pixel_has_one_actuator_for_each_direction(array64):
    pixels = array64.site_directions.reshape(64, 2, 64, 2, 2).transpose(0, 2, 1, 3, 4)
    pixels = pixels.reshape(64, 64, 4, 2)
    assert np.all(pixels.sum(axis=2) == 0.0)
    assert np.all(np.abs(pixels).sum(axis=-1) == 1.0)
    assert np.all(np.abs(pixels).sum(axis=2) == 2.0)


def test_vertical_force_is_the_papers(array64):
    """Boehringer et al. 1994, section 5: 2.8e-7 N at 50 V."""
    pixel = array64.pixel
    assert pixel.vertical_force(50.0) == pytest.approx(2.8e-7, rel=5e-3)
    assert pixel.vertical_force(100.0) == pytest.approx(4 * pixel.vertical_force(50.0))
    assert pixel.lifting_voltage(pixel.vertical_force(37.0)) == pytest.approx(37.0)


@pytest.mark.parametrize(
    ("pressure", "voltage"), [(0.784, 17.0), (8.5, 55.0), (11.4, 64.0)], ids=["paper", "SIM", "die"]
)
def test_lifting_voltages_of_the_design(array64, pressure, voltage):
    force = pressure * array64.pixel.pitch**2
    assert array64.pixel.lifting_voltage(force) == pytest.approx(voltage, abs=0.7)


def test_voltages():
    assert load_array("resonator32", voltage="30 V").voltage == 30.0
    for voltage in (0.0, -5.0, 1000.0, "50 N"):
        with pytest.raises(InputError, match="voltage"):
            load_array("resonator32", voltage=voltage)


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("value = 64", "value = 64.5", "whole number"),
        ("value = 64", "value = 0", "at least 1"),
        ('"resonator1994"', '"resonator2094"', "no such file or model"),
    ],
)
def test_bad_array_models(tmp_path, old, new, problem):
    path = tmp_path / "bad.toml"
    path.write_text(find_model("arrays", "resonator64").read_text().replace(old, new))
    with pytest.raises(ModelError, match=problem):
        load_array(path)
