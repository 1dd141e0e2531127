from dataclasses import replace

import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.field_errors import FieldErrors
from limitsurf.planning.turn_function import turn_function


def with_pitch(array, pitch):
    count = round(array.width / pitch)
    pixel = replace(array.pixel, pitch=pitch, tip_width=pitch / 20, residual_fraction=0.0)
    return replace(array, pixel=pixel, rows=count, columns=count)


def test_the_nearest_axis_is_off_by_the_angle_of_the_line(paper_t, array64):
    for degrees in (10.0, 30.0, -20.0):
        line = np.radians(degrees)
        errors = FieldErrors.of(array64, paper_t, line, method="nearest")
        assert np.degrees(errors.direction) == pytest.approx(-degrees, abs=0.2)
        dithered = FieldErrors.of(array64, paper_t, line)
        assert abs(np.degrees(dithered.direction)) < 0.6


def test_directions_that_are_turned_are_measured_as_such(paper_t, array64):
    fine = with_pitch(array64, 1e-4)
    spread = fine.with_spread().spread
    turned = replace(fine, spread=replace(spread, turn=np.full_like(spread.turn, 0.1)))
    straight, skew = (FieldErrors.of(a, paper_t, 0.3) for a in (fine, turned))
    assert skew.direction == pytest.approx(straight.direction)  # the lattice alone
    assert skew.spread == pytest.approx(np.tan(0.1), rel=0.05)


def test_pixel_errors_fall_with_the_pitch(paper_t, array64):
    """planning.md: a power of 1.6 to 2; lines at odd angles, of which the mean is taken."""
    lines = (0.2, 0.5, 0.9, 1.3)
    pitches = np.array([4e-4, 2e-4, 1e-4])
    rms = [
        np.mean([FieldErrors.of(with_pitch(array64, h), paper_t, line).pixels for line in lines])
        for h in pitches
    ]
    power = np.polyfit(np.log(pitches), np.log(rms), 1)[0]
    assert 1.2 < power < 2.2
    assert rms[0] > rms[1] > rms[2]


def test_dead_actuators_as_by_drawing_them(paper_t, array64):
    """The formula of first order against arrays with dead actuators drawn at random."""
    share = 0.03
    guess = FieldErrors.of(array64, paper_t, 0.3, dead=share)
    drawn = [
        FieldErrors.of(array64.with_spread(dead=share, seed=s), paper_t, 0.3) for s in range(8)
    ]
    measured = np.sqrt(np.mean([errors.spread**2 for errors in drawn]))
    assert guess.spread == pytest.approx(measured, rel=0.25)
    assert guess.spread_worst >= max(errors.spread_worst for errors in drawn) * 0.8
    assert guess.pixels == drawn[0].pixels
    more = FieldErrors.of(array64, paper_t, 0.3, dead=4 * share)
    assert more.spread / guess.spread == pytest.approx(2.0, rel=0.1)


def test_deadband_is_the_share_of_grip(paper_t, array64):
    none = FieldErrors.of(with_pitch(array64, 2e-4), paper_t, 0.3).deadband
    one, two = (
        FieldErrors.of(
            replace(array64, pixel=replace(array64.pixel, residual_fraction=f)), paper_t, 0.3
        ).deadband
        for f in (0.01, 0.02)
    )
    assert none == 0.0
    assert two == pytest.approx(2 * one)


def test_deadband_of_a_square_in_closed_form(array64):
    """On the diagonal U = a^3 sqrt(2)/6, and friction about the centre holds 0.3826 a^3."""
    a = 3e-3
    part = Part([(0, 0), (a, 0), (a, a), (0, a)], "80 g/m^2")
    pixel = replace(array64.pixel, pitch=5e-5, residual_fraction=0.01, offset_fraction=0.1)
    fine = replace(array64, pixel=pixel, rows=256, columns=256)
    errors = FieldErrors.of(fine, part, 0.0, samples=8)
    spin = (np.sqrt(2) + np.arcsinh(1.0)) / 6
    assert errors.deadband == pytest.approx(0.1 * spin / (np.sqrt(2) / 6), rel=0.02)


def test_sources_add_up():
    errors = FieldErrors(0.1, 0.01, 0.03, 0.02, 0.04, 0.05)
    assert errors.worst == pytest.approx(0.1)
    assert errors.likely(1.0) == pytest.approx(0.02 + np.hypot(0.01, 0.04))
    assert errors.likely(100.0) == errors.worst
    sources = errors.sources
    assert sum(one.worst for one in sources.values()) == pytest.approx(errors.worst)
    assert sources["direction"].tangent == errors.tangent == np.tan(0.1)
    assert "deadband up to 1.15 deg" in repr(errors)


def test_bad_input(paper_t, array64):
    with pytest.raises(InputError, match="deadband"):
        FieldErrors(deadband=-0.1)
    with pytest.raises(InputError, match="pixels"):
        FieldErrors(pixels=float("nan"))
    with pytest.raises(InputError, match="direction"):
        FieldErrors(direction=2.0)
    with pytest.raises(InputError, match="dead"):
        FieldErrors.of(array64, paper_t, 0.0, dead=1.0)
    with pytest.raises(InputError, match="start"):
        FieldErrors.of(array64, paper_t, 0.0, start_offset=1.0)
    idle = replace(array64, pixel=replace(array64.pixel, offset_fraction=0.0))
    with pytest.raises(InputError, match="do not push"):
        FieldErrors.of(idle, paper_t, 0.0)
    none = array64.with_spread(dead=1.0)
    with pytest.raises(InputError, match="no running actuator"):
        FieldErrors.of(none, paper_t, 0.0)
    turn = 2 * np.pi * np.arange(400) / 400
    disk = Part(1e-3 * np.column_stack([np.cos(turn), np.sin(turn)]))
    if turn_function(disk).neutral:
        with pytest.raises(InputError, match="neutral"):
            FieldErrors.of(array64, disk, 0.0)
