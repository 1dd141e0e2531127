r"""What the fitted models share.

A load F applied to a sliding part lies on the boundary of a convex set B, and the part moves along
the outer normal of B there. What the contacts exert on the part is minus F: the limit surface of
the library's conventions is ``L = -B``.
"""

from __future__ import annotations

import warnings
from abc import abstractmethod
from contextlib import AbstractContextManager
from functools import cache
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted
from threadpoolctl import ThreadpoolController

from limitsurf.errors import InputError
from limitsurf.fitting.columns import column_names, named_rows
from limitsurf.fitting.pairs import Pairs, read_pairs, scaled_loads, scaled_motions
from limitsurf.fitting.surface_files import surface_toml
from limitsurf.sets.convex_set import ConvexSet

__all__ = ["LimitSurfaceModel", "angles_between", "one_blas_thread"]

Array = NDArray[np.float64]


def angles_between(a: Array, b: Array) -> Array:
    """Return the angles [rad] between rows, pi/2 where one is zero.

    ``2 atan2(|a - b|, |a + b|)`` of unit vectors keeps its digits near 0 and pi (Kahan).
    """
    a, b = (x / np.maximum(np.linalg.norm(x, axis=-1, keepdims=True), 1e-300) for x in (a, b))
    apart, along = (np.linalg.norm(x, axis=-1) for x in (a - b, a + b))
    return np.asarray(2.0 * np.arctan2(apart, along))


def one_blas_thread() -> AbstractContextManager[Any]:
    """Return a context in which BLAS does not share out matrices as small as those of a fit."""
    context: AbstractContextManager[Any] = _threads().limit(limits=1, user_api="blas")
    return context


@cache
def _threads() -> Any:
    return ThreadpoolController()


class LimitSurfaceModel(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """Base of the fitted models: a scikit-learn regressor from loads to directions of motion.

    A model derives from it, stores its options in ``__init__``, `rho` [m] first, and gives `_fit`
    and `_directions`. It says how many pairs it needs in `_least_pairs`, and in `_passive` whether
    the contacts only brake.

    Attributes
    ----------
    surface_ : ConvexSet
        Loads that the contacts can exert on the part [N, N, N m]: minus the applied ones.
    n_pairs_ : int
        Number of pairs used.
    n_features_in_ : int
        Three.
    """

    rho: float

    @abstractmethod
    def _fit(self, pairs: Pairs) -> ConvexSet:
        """Fit to scaled pairs; return the limit surface L, in [N, N, N m]."""

    @abstractmethod
    def _directions(self, loads: Array) -> Array:
        """Return outer normals (n, 3) of B, any length, for loads ``(fx, fy, m/rho)`` [N]."""

    @property
    def _length(self) -> float:
        """The length that makes moments forces [m]."""
        return self.rho

    @property
    def _least_pairs(self) -> int:
        return 1

    @property
    def _passive(self) -> bool:
        return True

    def fit(self, loads: Any, twists: Any = None, sample_weight: ArrayLike | None = None) -> Self:
        """Fit the limit surface to pairs of loads and motions.

        Parameters
        ----------
        loads : (n, 3) array, data frame or xarray
            Loads applied to the part [N, N, N m].
        twists : (n, 3) array, data frame or xarray
            Velocities or small displacements [m, m, rad], in any unit of time.
        sample_weight : (n,) float, optional
            Weights; see `weights_from_noise`.

        Raises
        ------
        InputError
            What is given cannot be used; see `read_pairs`.
        SolveFailed
            The program behind the fit did not converge.
        """
        if twists is None:
            raise InputError("twists", "requires y to be passed, but the target y is None")
        pairs = read_pairs(
            loads,
            twists,
            sample_weight,
            self._length,
            least=self._least_pairs,
            passive=self._passive,
        )
        with one_blas_thread():
            self.surface_ = self._fit(pairs)
        self.n_pairs_, self.n_features_in_ = len(pairs), 3
        if names := column_names(loads):
            self.feature_names_in_ = np.array(names, dtype=object)
        return self

    def predict(self, loads: Any) -> Array:
        """Return unit vectors along ``(vx, vy, rho omega)`` (n, 3); zeros where nothing pulls."""
        check_is_fitted(self)
        rows = scaled_loads(loads, self._length)
        known = np.isfinite(rows).all(axis=1)
        found = np.full_like(rows, np.nan)
        normals = self._directions(rows[known]) if known.any() else rows[known]
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        found[known] = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
        return found

    def predict_load(self, twists: Any) -> Array:
        """Return the loads (n, 3) [N, N, N m] to be applied for motions along `twists`."""
        check_is_fitted(self)
        return np.asarray(-self.surface_.support_point(-named_rows("twists", twists)))

    def score(self, loads: Any, twists: Any, sample_weight: ArrayLike | None = None) -> float:
        """Return minus the mean angle [rad] between predicted and given motions."""
        angles = angles_between(self.predict(loads), scaled_motions(twists, self._length))
        weight = np.ones(len(angles)) if sample_weight is None else np.asarray(sample_weight)
        known = np.isfinite(angles)
        if not known.any():
            raise InputError("loads", "has no pair without NaN")
        if not known.all():
            warnings.warn(f"dropped {(~known).sum()} of {len(known)} pairs: NaN", stacklevel=2)
        return -float(np.average(angles[known], weights=weight[known]))

    def to_toml(self) -> str:
        """Return the fitted surface as the text of a model file; `load_surface` reads it."""
        check_is_fitted(self)
        pairs = f"fitted to {self.n_pairs_} pairs"
        return surface_toml(self.surface_, self._length, f"{type(self).__name__} {pairs}", pairs)

    def __sklearn_tags__(self) -> Any:
        """Say that NaN may come in, three columns come out, and the score is no R^2."""
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        tags.target_tags.single_output = False
        tags.target_tags.multi_output = True
        tags.regressor_tags.poor_score = True
        return tags
