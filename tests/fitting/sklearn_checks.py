"""Which of scikit-learn's own checks do not fit models of loads and motions, and why."""

import numpy as np
from sklearn.utils.validation import check_is_fitted, validate_data

from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.quartic_model import QuarticModel

COLUMNS = "gives features that are no loads: other than three columns"
TARGETS = "gives one target: no motions"
KEYWORD = "calls fit with y=, which is named twists here"

#: checks that fail for the models as they are
RAW = {
    "check_fit_score_takes_y": TARGETS,
    "check_estimators_overwrite_params": COLUMNS,
    "check_dont_overwrite_parameters": TARGETS,
    "check_estimators_fit_returns_self": COLUMNS,
    "check_readonly_memmap_input": COLUMNS,
    "check_n_features_in_after_fitting": COLUMNS,
    "check_positive_only_tag_during_fit": COLUMNS,
    "check_estimators_dtypes": COLUMNS,
    "check_sample_weights_pandas_series": COLUMNS,
    "check_sample_weights_not_an_array": COLUMNS,
    "check_sample_weights_list": TARGETS,
    "check_all_zero_sample_weights_error": COLUMNS,
    "check_sample_weights_shape": COLUMNS,
    "check_sample_weights_not_overwritten": COLUMNS,
    "check_sample_weight_equivalence_on_dense_data": KEYWORD,
    "check_dtype_object": COLUMNS,
    "check_estimators_empty_data_messages": COLUMNS,
    "check_pipeline_consistency": TARGETS,
    "check_estimators_pickle": TARGETS,
    "check_f_contiguous_array_estimator": TARGETS,
    "check_regressors_train": COLUMNS,
    "check_regressor_data_not_an_array": COLUMNS,
    "check_regressor_multioutput": COLUMNS,
    "check_regressors_no_decision_function": COLUMNS,
    "check_regressors_int": COLUMNS,
    "check_non_transformer_estimators_n_iter": COLUMNS,
    "check_methods_sample_order_invariance": TARGETS,
    "check_methods_subset_invariance": TARGETS,
    "check_fit2d_1sample": COLUMNS,
    "check_fit2d_1feature": COLUMNS,
    "check_dict_unchanged": TARGETS,
    "check_fit_idempotent": COLUMNS,
    "check_fit_check_is_fitted": COLUMNS,
    "check_n_features_in": COLUMNS,
    "check_fit2d_predict1d": TARGETS,
}

#: checks that fail even when their data are turned into loads and motions
PHYSICAL = {
    "check_regressors_train": "wants predictions of the shape of its single target",
    "check_regressor_multioutput": "wants five columns for five targets",
}


class Physical:
    """Turns any numbers into loads and motions that fit them, before a model sees them.

    Loads are a fixed map of the features; motions those of an ellipsoid, turned a little by the
    targets. The checks then try the models themselves.
    """

    def fit(self, X, y=None, sample_weight=None):
        X, y = _checked(self, X, y)
        features = self.n_features_in_
        super().fit(loads(X), motions(loads(X), y), sample_weight)
        self.n_features_in_ = features
        return self

    def predict(self, X):
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, ensure_all_finite="allow-nan")
        return super().predict(loads(X))

    def score(self, X, y, sample_weight=None):
        X, y = _checked(self, X, y, reset=False)
        plain = self.plain(**self.get_params())
        plain.__dict__.update(self.__dict__)
        return plain.score(loads(X), motions(loads(X), y), sample_weight)


class PhysicalEllipsoid(Physical, EllipsoidModel):
    plain = EllipsoidModel


class PhysicalQuartic(Physical, QuarticModel):
    plain = QuarticModel


def _checked(model, X, y, **options):
    options |= {"multi_output": True, "y_numeric": True, "ensure_all_finite": "allow-nan"}
    return validate_data(model, X, y, **options)


def loads(X):
    """Return loads (n, 3) in all directions: a fixed map of the features."""
    matrix = np.random.default_rng(X.shape[1]).normal(size=(X.shape[1], 3))
    return np.cos(X @ matrix + 1.0) * [1.0, 1.0, 0.05]


def motions(F, y):
    """Return motions (n, 3) along the normals of an ellipsoid, turned a little by the targets."""
    turn = 0.1 * np.sin(np.asarray(y, dtype=float).reshape(len(F), -1)[:, 0])
    vx, vy, omega = (F * [1.0, 2.0, 400.0]).T
    return np.column_stack([vx - turn * vy, vy + turn * vx, omega])
