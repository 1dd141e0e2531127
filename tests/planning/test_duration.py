from dataclasses import replace

import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning import duration
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.duration import expected_duration, line_durations
from limitsurf.planning.verification import verify_alignment


@pytest.fixture(scope="module")
def plan(paper_t):
    return plan_alignment(paper_t)


def settled(trajectory, tolerance):
    """Return when an orientation was outside the tolerance of its end for the last time [s]."""
    off = np.abs(trajectory.poses[:, 2] - trajectory.final_pose[2]) > tolerance
    return trajectory.times[np.flatnonzero(off)[-1]] if off.any() else 0.0


@pytest.mark.slow
def test_an_array_takes_as_long(plan, paper_t, array64):
    """Settling times of runs on the array, contact by contact."""
    verified = verify_alignment(plan, paper_t, array64, samples=30, seed=4)
    one = np.radians(1.0)
    times = np.array([[settled(t, one) for t in verified.replay(k, frames=300)] for k in range(30)])
    found = line_durations(plan, array64)
    assert times.sum(axis=1).mean() == pytest.approx(found.sum(), rel=0.12)
    assert plan.expected_duration(array64) == found.sum()
    assert times.mean(axis=0) == pytest.approx(found, rel=0.2)


def test_the_quadrature_has_converged(plan, array64, monkeypatch):
    coarse = line_durations(plan, array64)
    assert np.array_equal(line_durations(plan, array64), coarse)
    monkeypatch.setattr(duration, "_ORIENTATIONS", 120)
    nodes = np.pi * np.arange(1, 6) / 6
    monkeypatch.setattr(duration, "_PLACES", np.cos(nodes))
    monkeypatch.setattr(duration, "_SHARES", np.sin(nodes) ** 2 / 3)
    assert coarse == pytest.approx(line_durations(plan, array64), rel=0.02)


def test_shares_are_those_of_a_disk():
    """Moments of the shadow of a uniform disk of radius 1: 1, 0, 1/4."""
    moments = [duration._SHARES @ duration._PLACES**k for k in (0, 1, 2, 4)]
    assert moments == pytest.approx([1.0, 0.0, 0.25, 0.125])


def test_what_makes_a_plan_slow(plan, array64):
    base = expected_duration(plan, array64)
    weak = replace(array64, pixel=replace(array64.pixel, offset_fraction=0.02))
    thick = replace(array64, air_viscosity=4 * array64.air_viscosity)
    assert expected_duration(plan, weak) > 3.0 * base
    assert expected_duration(plan, thick) > 2.0 * base
    assert expected_duration(plan, array64, tolerance=1e-3) > 1.2 * base
    centred = replace(plan, model="centred")
    assert expected_duration(centred, array64) != base


def test_push_squeeze_starts_beside_the_line(plan, array64):
    starts = duration._offsets(replace(plan, model="push-squeeze"), np.array([0.3, 2.0]), None)
    for phi, offset in zip((0.3, 2.0), starts, strict=True):
        assert plan.part.at((0, offset, phi)).bounds[1] == pytest.approx(0.0, abs=1e-15)
    assert expected_duration(replace(plan, model="push-squeeze"), array64) > 0.0


def test_bad_input(plan, array64):
    with pytest.raises(InputError, match="areal_density"):
        expected_duration(replace(plan, part=Part(plan.part.polygon)), array64)
    with pytest.raises(InputError, match="tolerance"):
        expected_duration(plan, array64, tolerance=0.0)
    with pytest.raises(InputError, match="start_offset"):
        expected_duration(plan, array64, start_offset=-1.0)
    with pytest.raises(InputError, match="ActuatorArray"):
        expected_duration(plan, 3.0)
    idle = replace(array64, pixel=replace(array64.pixel, offset_fraction=0.0))
    with pytest.raises(InputError, match="does not push"):
        expected_duration(plan, idle)


def test_steps_that_end_before_they_begin_have_no_starts(plan):
    squeeze = plan.squeeze
    ends = np.append(squeeze.breaks[0] - 0.01, squeeze.ends[1:])
    swallowed = replace(plan, squeeze=replace(squeeze, ends=ends))
    share = duration._first_starts(swallowed, None).share
    assert share.min() >= 0.0
    assert share.sum() == pytest.approx(1.0)
