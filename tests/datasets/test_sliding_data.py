"""The record of pairs: what it checks, and what it warns of."""

import dataclasses

import numpy as np
import pytest

from limitsurf.datasets.plausibility import ImplausibleUnits
from limitsurf.datasets.sliding_data import SlidingData
from limitsurf.errors import InputError

RHO = 0.05


@pytest.fixture
def rows(rng):
    scale = np.array([1.0, 1.0, RHO])
    return 4.0 * rng.normal(size=(20, 3)) * scale, 1e-2 * rng.normal(size=(20, 3)) / scale


def test_the_record_is_frozen_and_its_arrays_too(rows):
    data = SlidingData(*rows, RHO)
    assert len(data) == 20
    with pytest.raises(dataclasses.FrozenInstanceError):
        data.rho = 1.0
    with pytest.raises(ValueError, match="read-only"):
        data.loads[0, 0] = 1.0
    rows[0][0, 0] += 1.0
    assert data.loads[0, 0] == rows[0][0, 0] - 1.0


def test_take_keeps_rows_and_all_that_is_known(rows):
    data = SlidingData(*rows, RHO, load_deviations=np.abs(rows[0]), name="a", motion="velocity")
    mask = rows[0][:, 0] > 0.0
    some = data.take(mask)
    assert (some.loads == rows[0][mask]).all()
    assert (some.twists == rows[1][mask]).all()
    assert (some.load_deviations == np.abs(rows[0][mask])).all()
    assert some.twist_deviations is None
    assert (some.name, some.motion, some.rho) == ("a", "velocity", RHO)
    assert (data.take(np.flatnonzero(mask)).loads == some.loads).all()
    for wrong in ([20], mask[:-1], [0.5]):
        with pytest.raises(InputError, match="rows"):
            data.take(wrong)


def test_deviations_for_all_are_spread(rows):
    data = SlidingData(*rows, RHO, twist_deviations=[1e-4, 2e-4, 3e-3])
    assert data.twist_deviations.shape == (20, 3)
    assert (data.twist_deviations == [1e-4, 2e-4, 3e-3]).all()


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        ({"loads": np.ones((20, 2))}, "loads"),
        ({"loads": np.empty((0, 3))}, "loads"),
        ({"loads": np.full((20, 3), np.nan)}, "loads"),
        ({"twists": np.ones((19, 3))}, "twists"),
        ({"rho": 0.0}, "rho"),
        ({"rho": "5 cm"}, "rho"),
        ({"motion": "speed"}, "motion"),
        ({"load_deviations": -np.ones(3)}, "load_deviations"),
        ({"twist_deviations": np.ones((20, 2))}, "twist_deviations"),
    ],
)
def test_wrong_arguments_are_named(rows, change, argument):
    good = {"loads": rows[0], "twists": rows[1], "rho": RHO}
    with pytest.raises(InputError) as caught:
        SlidingData(**(good | change))
    assert caught.value.argument == argument


@pytest.mark.parametrize("factor", [1e3, 1e-3])
@pytest.mark.parametrize("which", [0, 1])
def test_moments_and_angles_in_wrong_units_are_warned_of(rows, which, factor):
    """N mm beside N, kN m beside N, ways in mm beside rad: a factor of 1000 either way."""
    wrong = [r.copy() for r in rows]
    wrong[which][:, 2] *= factor
    with pytest.warns(ImplausibleUnits, match="forces" if which == 0 else "angles"):
        SlidingData(*wrong, RHO)


def test_pure_sliding_and_few_pairs_are_not_suspected(rows):
    sliding = [r * [1.0, 1.0, 0.0] for r in rows]
    assert len(SlidingData(*sliding, RHO)) == 20
    assert len(SlidingData([[1.0, 0.0, 9.0]], [[1.0, 0.0, 0.0]], RHO)) == 1


def test_repr_says_what_and_how_large():
    data = SlidingData([[3, 4, 0.1]], [[0, 0.002, -0.5]], RHO, motion="velocity", name="ring")
    assert repr(data) == (
        "SlidingData(ring, 1 pair: to 5 N, 0.1 N m and 0.002 m/s, 0.5 rad/s; rho 0.05 m)"
    )
