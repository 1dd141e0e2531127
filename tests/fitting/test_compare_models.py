"""Models judged on pairs held out from their fit."""

import numpy as np
import pytest
from simulated_supports import pairs, support
from sklearn.model_selection import KFold, cross_val_predict

from limitsurf.errors import InputError
from limitsurf.fitting.base import angles_between
from limitsurf.fitting.compare_models import compare_models, default_models
from limitsurf.fitting.contact_model import ContactModel
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.polytope_model import PolytopeModel
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.fitting.three_point_model import ThreePointModel


def data(n, noise=0.1):
    rng = np.random.default_rng(0)
    loads, v = pairs(support("three", rng), n, rng)
    return loads + noise * rng.normal(size=(n, 3)), v


MODELS = {"ellipsoid": EllipsoidModel(1.0), "contacts": ContactModel(1.0)}


def test_angles_are_those_of_a_plain_cross_validation():
    loads, twists = data(20)
    found = compare_models(loads, twists, MODELS, folds=20)
    for name, model in MODELS.items():
        predicted = cross_val_predict(model, loads, twists, cv=KFold(20))
        assert found.angles[name][0] == pytest.approx(angles_between(predicted, twists), abs=1e-9)
        assert found.table.angle[name] == pytest.approx(np.degrees(found.angles[name].mean()))


def test_the_better_model_is_recommended_and_the_worse_told_apart():
    loads, twists = data(40)
    found = compare_models(loads, twists, MODELS, repeats=2)
    assert found.recommended == "contacts"
    assert list(found.table.index) == ["contacts", "ellipsoid"]
    worse = found.table.loc["ellipsoid"]
    assert 0.0 < worse.worse_low < worse.worse_by < worse.worse_high
    assert (found.table.low < found.table.angle).all()
    assert found.advice.startswith("recommended: contacts, ")
    assert "not told apart" not in repr(found)
    assert isinstance(found.fit_recommended(loads, twists), ContactModel)


def test_equals_are_not_told_apart():
    twins = {"one": EllipsoidModel(1.0), "other": EllipsoidModel(1.0)}
    found = compare_models(*data(10), twins)
    assert found.advice.endswith("not told apart from it: other")


def test_nothing_held_out_is_seen():
    """Shuffled motions cannot be predicted, however well they are fitted."""
    loads, twists = data(30)
    signs = np.sign((loads * twists[::-1]).sum(axis=1))
    found = compare_models(loads, twists[::-1] * signs[:, None], {"p": PolytopeModel(1.0)})
    assert found.table.angle["p"] > 30.0


def test_models_that_cannot_be_fitted_come_last_with_the_reason():
    found = compare_models(*data(5), {"quartic": QuarticModel(1.0), **MODELS})
    assert found.table.index[-1] == "quartic"
    assert "is the minimum" in found.table.failed["quartic"]
    with pytest.raises(InputError, match="cannot be fitted: quartic"):
        compare_models(*data(5), {"quartic": QuarticModel(1.0)})


def test_models_with_lengths_of_their_own_are_judged_with_one():
    loads, twists = data(12)
    feet = support("three", np.random.default_rng(0)).position
    models = {"near": ThreePointModel(feet, 1.0), "far": ThreePointModel(feet, 5.0)}
    found = compare_models(loads, twists, models, rho=2.0)
    assert found.table.angle["near"] == pytest.approx(found.table.angle["far"], rel=0.3)


def test_a_length_is_found_in_the_loads():
    loads, twists = data(12)
    a = compare_models(loads, twists, folds=3)
    b = compare_models(loads * [1, 1, 0.1], twists * [1, 1, 10.0], folds=3)
    assert a.models["contacts"].rho == pytest.approx(10.0 * b.models["contacts"].rho)
    assert a.table.angle["contacts"] == pytest.approx(b.table.angle["contacts"], rel=1e-3)
    assert set(a.models) == set(default_models(1.0))


def test_pairs_with_nan_are_dropped_and_bad_arguments_refused():
    loads, twists = data(12)
    loads[3, 1] = np.nan
    with pytest.warns(UserWarning, match="dropped 1 of 12 pairs: NaN"):
        found = compare_models(loads, twists, MODELS)
    assert found.angles["contacts"].shape == (1, 11)
    loads, twists = data(12)
    for change, name in (
        ({"models": {}}, "models"),
        ({"folds": 1}, "folds"),
        ({"repeats": 0}, "repeats"),
        ({"twists": twists[:-1]}, "twists"),
        ({"loads": loads[:1], "twists": twists[:1]}, "too few"),
        ({"rho": -1.0}, "rho"),
        ({"loads": loads * [1, 1, 0], "models": None}, "rho"),
    ):
        arguments = {"loads": loads, "twists": twists, "models": MODELS} | change
        with pytest.raises(InputError, match=name):
            compare_models(**arguments)
