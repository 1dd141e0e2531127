import warnings

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, KFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils.estimator_checks import check_estimator

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.sets.ellipsoid import Ellipsoid
from tests.fitting.simulated import pairs_of
from tests.fitting.sklearn_checks import PHYSICAL, RAW, PhysicalEllipsoid, PhysicalQuartic

FEET = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], 1.0).limit_surface()


@pytest.mark.parametrize(
    ("model", "exceptions"),
    [
        (EllipsoidModel, RAW),
        (QuarticModel, RAW),
        (PhysicalEllipsoid, PHYSICAL),
        pytest.param(PhysicalQuartic, PHYSICAL, marks=pytest.mark.slow),
    ],
)
def test_scikit_learns_checks_pass_but_for_the_listed_ones(model, exceptions):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        results = check_estimator(
            model(), expected_failed_checks=exceptions, on_fail=None, on_skip=None
        )
    status = {r["check_name"]: r["status"] for r in results}
    assert {name for name, s in status.items() if s == "failed"} == set()
    assert {name for name, s in status.items() if s == "xfail"} == set(exceptions)
    assert sum(s == "passed" for s in status.values()) >= 15


def test_cross_validation_and_grid_search():
    loads, twists = pairs_of(FEET, 40, noise=0.1)
    folds = KFold(4, shuffle=True, random_state=0)
    scores = cross_val_score(QuarticModel(0.05), loads, twists, cv=folds)
    assert scores.shape == (4,)
    assert ((scores > -0.35) & (scores < 0.0)).all()
    narrow = Ellipsoid(np.zeros(3), np.diag([4.0, 1.0, 0.1]))  # far from one of revolution
    search = GridSearchCV(EllipsoidModel(0.05), {"shrinkage": [0.1, 1000.0]}, cv=folds)
    search.fit(*pairs_of(narrow, 40, noise=0.1))
    assert search.best_params_ == {"shrinkage": 0.1}
    assert search.best_estimator_.get_params()["rho"] == 0.05


def test_pipeline_turns_units_first():
    loads, twists = pairs_of(FEET, 30)
    to_newtons = FunctionTransformer(lambda F: F * [1.0, 1.0, 1e-3])
    pipeline = make_pipeline(to_newtons, EllipsoidModel(0.05)).fit(loads * [1.0, 1.0, 1e3], twists)
    assert pipeline.score(loads * [1.0, 1.0, 1e3], twists) == pytest.approx(
        EllipsoidModel(0.05).fit(loads, twists).score(loads, twists), rel=1e-9
    )


def test_clone_keeps_options_and_forgets_the_fit():
    model = QuarticModel(0.07, offset=True, huber=2.0).fit(*pairs_of(FEET, 20))
    copy = clone(model)
    assert copy.get_params() == model.get_params()
    assert not hasattr(copy, "surface_")
    assert copy.set_params(rho=0.1).rho == 0.1


def test_frames_and_xarray_give_the_same_fit_and_cross_validate():
    loads, twists = pairs_of(FEET, 24, noise=0.05)
    F = pd.DataFrame(loads, columns=["fx", "fy", "m"])[["m", "fx", "fy"]]
    v = pd.DataFrame(twists, columns=["vx [m/s]", "vy [m/s]", "omega [rad/s]"])
    plain = EllipsoidModel(0.05).fit(loads, twists)
    named = EllipsoidModel(0.05).fit(F, v)
    assert named.loss_ == plain.loss_
    assert list(named.feature_names_in_) == ["m", "fx", "fy"]
    arrays = [
        xr.DataArray(x, dims=("pair", "axis"), coords={"axis": names})
        for x, names in ((loads, ["fx", "fy", "m"]), (twists, ["vx", "vy", "omega"]))
    ]
    assert EllipsoidModel(0.05).fit(*arrays).loss_ == plain.loss_
    data = xr.Dataset({"fx": ("pair", loads[:, 0]), "fy": ("pair", loads[:, 1])})
    data["m"] = ("pair", loads[:, 2])
    assert EllipsoidModel(0.05).fit(data, twists).loss_ == plain.loss_
    expected = cross_val_score(EllipsoidModel(0.05), loads, twists, cv=3)
    np.testing.assert_allclose(cross_val_score(EllipsoidModel(0.05), F, v, cv=3), expected)
    np.testing.assert_allclose(cross_val_score(EllipsoidModel(0.05), *arrays, cv=3), expected)
