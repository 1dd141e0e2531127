import numpy as np
import pytest

from limitsurf.actuators.resonator_sweep import sweep_resonators
from limitsurf.actuators.torsional_resonator import TorsionalResonator
from limitsurf.errors import InputError, LimitSurfError
from tests.actuators.resonator_twin import twin_floating

BASE = TorsionalResonator.from_model("resonator1994")
LOAD, VOLTAGE, MU = 3.1e-8, 50.0, 0.3


def designs(n, seed=4):
    rng = np.random.default_rng(seed)
    return {
        "rod_length": rng.uniform(20e-6, 40e-6, n),
        "quality": rng.uniform(30.0, 90.0, n),
        "rod_offset": rng.uniform(-8e-6, 8e-6, n),
        "contact_damping": rng.uniform(0.0, 6e-7, n),
        "pole_height": rng.uniform(0.0, 6e-6, n),
        "beam_pitch": rng.uniform(2e-6, 8e-6, n),
    }


@pytest.mark.parametrize("changes", [{}, {"poles": "-x", "driven": "-x"}, {"drive": "biased"}])
def test_a_sweep_equals_one_by_one(changes):
    base = BASE.varied(**changes)
    varied = designs(60)
    loads = np.geomspace(1e-9, 4e-7, 60)
    sweep = sweep_resonators(base, loads, VOLTAGE, MU, **varied)
    for i, load in enumerate(loads):
        one = base.varied(**{name: float(values[i]) for name, values in varied.items()})
        assert sweep.resonance[i] == pytest.approx(one.resonance, rel=1e-12)
        try:
            part = one.floating(load, VOLTAGE, MU)
        except LimitSurfError:
            assert sweep.status[i] != 0
            assert np.isnan(sweep.offset[i])
            continue
        assert sweep.status[i] == 0
        assert sweep.edge_amplitude[i] == pytest.approx(part.edge_amplitude, rel=1e-11)
        assert sweep.height[i] == pytest.approx(part.height, rel=1e-11)
        assert sweep.offset[i] == pytest.approx(part.offset, rel=1e-9, abs=1e-20)
        assert sweep.vertical_force[i] == pytest.approx(one.vertical_force(VOLTAGE))
    assert 10 < (sweep.status == 0).sum() < 60


@pytest.mark.parametrize("changes", [{"poles": "none"}, {"driven": "-x", "drive": "biased"}])
def test_designs_far_from_any_that_were_built(changes):
    """Four decades of contact, load and Q: nearly all are decided, and equal to the slow twin."""
    rng, n = np.random.default_rng(0), 2000
    base = BASE.varied(**changes)
    varied = {
        "rod_length": rng.uniform(15e-6, 45e-6, n),
        "quality": 10 ** rng.uniform(0.5, 3.0, n),
        "rod_offset": rng.uniform(-15e-6, 15e-6, n),
        "contact_damping": 10 ** rng.uniform(-9.0, -5.0, n),
        "contact_stiffness": 10 ** rng.uniform(-1.0, 3.0, n),
        "pole_height": rng.uniform(0.0, 6e-6, n),
    }
    load, voltage = 10 ** rng.uniform(-12.0, -6.3, n), rng.uniform(5.0, 80.0, n)
    mu, lag = rng.uniform(0.0, 1.0, n), rng.uniform(0.05, 3.1, n)
    sweep = sweep_resonators(base, load, voltage, mu, lag=lag, **varied)
    assert np.mean(sweep.status == 4) < 2e-3
    good = np.flatnonzero(sweep.status == 0)
    assert len(good) > 0.5 * n
    compared = 0
    for i in good[:40]:
        design = base.varied(**{name: float(column[i]) for name, column in varied.items()})
        try:
            twin = twin_floating(design, load[i], voltage[i], mu[i], lag[i])
        except ValueError:  # the twin's own root finder may lose its bracket
            continue
        compared += 1
        assert sweep.offset_fraction[i] == pytest.approx(twin[4], abs=1e-7)
        edge = twin[0] * max(design.levers)
        assert sweep.edge_amplitude[i] == pytest.approx(edge, rel=1e-7)
    assert compared >= 38


def test_lags_may_vary():
    lags = np.array([0.4, 0.55, 1.2])
    sweep = sweep_resonators(BASE, 3.4e-7, 75.0, MU, lag=lags)
    parts = [BASE.floating(3.4e-7, 75.0, MU, lag) for lag in lags[:2]]
    assert sweep.offset[:2] == pytest.approx([part.offset for part in parts])
    assert sweep.status[2] == 1  # the free edge hits
    with pytest.raises(InputError, match="lag"):
        sweep_resonators(BASE, 3.4e-7, 75.0, MU, lag=0.0)


def test_numbers_broadcast():
    sweep = sweep_resonators(BASE, LOAD, [40.0, 50.0], MU)
    assert sweep.offset.shape == (2,)
    assert sweep_resonators(BASE, LOAD, VOLTAGE, MU).offset.shape == (1,)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"rod_length": [30e-6, -1.0]}, "rod_length"),
        ({"rod_offset": [0.0, 30e-6]}, "rod_offset"),
        ({"quality": [[60.0]]}, "quality"),
        ({"quality": [60.0, np.nan]}, "quality"),
        ({"poles": [1.0]}, "poles"),
        ({"restitution": [0.5, 1.0]}, "restitution"),
    ],
)
def test_bad_designs_are_named(changes, name):
    with pytest.raises(InputError, match=name):
        sweep_resonators(BASE, LOAD, VOLTAGE, MU, **changes)


def test_bad_conditions_are_named():
    for arguments, name in (((0.0, 50.0, MU), "load"), ((LOAD, [50.0, 0.0], MU), "voltage")):
        with pytest.raises(InputError, match=name):
            sweep_resonators(BASE, *arguments)
    with pytest.raises(InputError, match="mu"):
        sweep_resonators(BASE, LOAD, VOLTAGE, -0.3)
