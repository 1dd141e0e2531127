import numpy as np
import pytest

from limitsurf.actuators.activation import Activation, direction_error, squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.errors import InputError

ANGLES = np.radians([0.0, 10.0, 30.0, 45.0, 60.0, 90.0, 117.3, 135.0, 179.0])


def pushes(activation):
    """Return the push of every pixel, (rows, columns, 2), and the number of actuators running."""
    array = activation.array
    running = activation.active[..., None] * array.site_directions
    shape = (array.rows, 2, array.columns, 2)
    counts = activation.active.reshape(shape).sum(axis=(1, 3))
    return running.reshape(*shape, 2).sum(axis=(1, 3)), counts


@pytest.mark.parametrize("method", ["dither", "nearest"])
@pytest.mark.parametrize("line", ANGLES)
def test_one_actuator_a_pixel_pushes_towards_the_line(array64, line, method):
    push, counts = pushes(squeeze_activation(array64, line, method=method))
    assert np.all(counts == 1)
    normal = np.array([-np.sin(line), np.cos(line)])
    offset = array64.pixel_centers @ normal
    clear = np.abs(offset) > 1e-9
    assert np.all((push @ normal * np.sign(offset))[clear] < 1e-12)


@pytest.mark.parametrize("line", ANGLES)
def test_dither_has_the_ratio_of_the_normal(array64, line):
    push, _ = pushes(squeeze_activation(array64, line))
    share = np.mean(np.abs(push[..., 0]))
    sine, cosine = abs(np.sin(line)), abs(np.cos(line))
    assert share == pytest.approx(sine / (sine + cosine), abs=2e-3)


@pytest.mark.parametrize("line", ANGLES)
def test_dither_is_even_over_small_windows(array64, line):
    """The worst 10 x 10 window is off by less than half of what independent coins would give."""
    x = np.abs(pushes(squeeze_activation(array64, line))[0][..., 0])
    windows = np.lib.stride_tricks.sliding_window_view(x, (10, 10)).mean(axis=(2, 3))
    assert np.abs(windows - x.mean()).max() < 0.09


@pytest.mark.parametrize("line", ANGLES)
def test_dither_pushes_normally_to_the_line(array64, line):
    assert direction_error(squeeze_activation(array64, line)) < np.radians(0.5)


def test_nearest_axis_is_off_by_the_angle_to_the_axis(array64):
    for degrees, error in ((0, 0), (10, 10), (30, 30), (60, 30), (89, 1)):
        activation = squeeze_activation(array64, np.radians(degrees), method="nearest")
        assert np.degrees(direction_error(activation)) == pytest.approx(error, abs=1e-6)


def test_pixels_on_the_line_take_sides_in_turn():
    """Rounding must not tilt the line: on the diagonal, half of them push each way all along."""
    array = load_array("resonator32")
    for line in (np.pi / 4, np.pi / 4 + 1e-16, 3 * np.pi / 4):
        push, _ = pushes(squeeze_activation(array, line))
        normal = np.array([-np.sin(line), np.cos(line)])
        diagonal = np.arange(32)
        other = diagonal if line < 1.0 else diagonal[::-1]
        side = np.sign(push[diagonal, other] @ normal)
        assert abs(side.sum()) == 0
        assert np.all(side[1:] == -side[:-1])


def test_the_same_line_the_same_activation(array64):
    first, second = (squeeze_activation(array64, 0.7) for _ in range(2))
    assert np.array_equal(first.active, second.active)


def test_bad_input(array64):
    with pytest.raises(InputError, match="line"):
        squeeze_activation(array64, np.nan)
    with pytest.raises(InputError, match="method"):
        squeeze_activation(array64, 0.0, method="best")
    with pytest.raises(InputError, match="active"):
        Activation(array64, np.ones((3, 3), bool))
    with pytest.raises(InputError, match="no line"):
        direction_error(Activation(array64, np.ones((128, 128), bool)))
