"""Which model fits the data best: judged on pairs that the fit has not seen."""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.progress import track
from sklearn.base import clone

from limitsurf.errors import InputError, SolveFailed
from limitsurf.fitting.base import LimitSurfaceModel, angles_between
from limitsurf.fitting.columns import named_rows
from limitsurf.fitting.contact_model import ContactModel
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.model_comparison import HeldOut, ModelComparison, comparison_table
from limitsurf.fitting.pairs import scaled_motions
from limitsurf.fitting.polytope_model import PolytopeModel
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.sets.arguments import as_count, as_positive

__all__ = ["compare_models", "default_models"]

Array = NDArray[np.float64]


def default_models(rho: float) -> dict[str, LimitSurfaceModel]:
    """Return the models that need to know nothing of the support."""
    return {
        "contacts": ContactModel(rho),
        "balanced contacts": ContactModel(rho, balanced=True),
        "quartic": QuarticModel(rho),
        "ellipsoid": EllipsoidModel(rho),
        "polytope": PolytopeModel(rho, kind="outer"),
    }


def compare_models(
    loads: Any,
    twists: Any,
    models: Mapping[str, LimitSurfaceModel] | None = None,
    *,
    rho: float | None = None,
    folds: int = 5,
    repeats: int = 1,
    seed: int = 0,
    progress: bool = False,
) -> ModelComparison:
    """Compare models by cross-validation: by pairs held out from the fit.

    Parameters
    ----------
    loads, twists : (n, 3) array, data frame or xarray
        As in `LimitSurfaceModel.fit`. Pairs with NaN are dropped with a warning.
    models : dict, optional
        Models by name; `default_models` otherwise. All angles are taken with one `rho`.
    rho : float, optional
        Length that makes moments forces [m]; otherwise that of the first model, and without models
        the one that makes the loads' moments weigh as much as a component of their forces.
    folds, repeats : int
        Parts that the pairs are shuffled into, each held out once (as many as pairs, at most); and
        times that this is done.
    seed : int
        Of the shuffling.
    progress : bool
        Show a bar.

    Notes
    -----
    Intervals come from a bootstrap over pairs, of the angles and of their differences from the best
    model's. They do not hold the spread over training sets.

    Examples
    --------
    >>> from limitsurf.sets.contact_sum import ContactSum
    >>> v = np.random.default_rng(0).normal(size=(30, 3))
    >>> feet = ContactSum([[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]], [2.0, 1.0, 1.0])
    >>> models = {"contacts": ContactModel(1.0), "ellipsoid": EllipsoidModel(1.0)}
    >>> compare_models(feet.support_point(v), v, models).recommended
    'contacts'
    """
    F, v = named_rows("loads", loads), named_rows("twists", twists)
    F, v = _complete(F, v)
    length = _length(F, models, rho)
    chosen = default_models(length) if models is None else dict(models)
    if not chosen:
        raise InputError("models", "are missing", remedy="give at least one")
    parts = _parts(len(F), as_count("folds", folds, 2), as_count("repeats", repeats), seed)
    jobs = track(chosen.items(), "comparing", disable=not progress, transient=True)
    results = {name: _held_out(model, F, v, length, parts) for name, model in jobs}
    table = comparison_table(results, seed)
    if (table.failed != "").all():
        reasons = "; ".join(f"{name}: {why}" for name, why in table.failed.items())
        raise InputError("models", f"cannot be fitted: {reasons}", remedy="measure more pairs")
    angles = {name: result.angles for name, result in results.items()}
    return ModelComparison(table, angles, str(table.index[0]), chosen)


def _complete(F: Array, v: Array) -> tuple[Array, Array]:
    if len(F) != len(v):
        raise InputError("twists", f"has {len(v)} rows, but loads has {len(F)}")
    known = np.asarray(np.isfinite(np.column_stack([F, v])).all(axis=1))
    if not known.all():
        warnings.warn(f"dropped {(~known).sum()} of {len(known)} pairs: NaN", stacklevel=3)
    if known.sum() < 2:
        raise InputError("loads", f"{known.sum()} pairs are too few to hold one out")
    return F[known], v[known]


def _length(F: Array, models: Mapping[str, LimitSurfaceModel] | None, rho: float | None) -> float:
    if rho is not None:
        return as_positive("rho", rho)
    for model in (models or {}).values():
        return model._length
    force, moment = np.sqrt((F[:, :2] ** 2).sum() / 2.0), np.sqrt((F[:, 2] ** 2).sum())
    if not (force > 0.0 and moment > 0.0):
        raise InputError("rho", "cannot be told from loads without force or moment")
    return float(moment / force)


def _parts(n: int, folds: int, repeats: int, seed: int) -> list[list[NDArray[np.int64]]]:
    """Return, for each repeat, the pairs held out in each fold."""
    rng = np.random.default_rng(seed)
    return [np.array_split(rng.permutation(n), min(folds, n)) for _ in range(repeats)]


def _held_out(
    model: LimitSurfaceModel, F: Array, v: Array, rho: float, parts: list[list[NDArray[np.int64]]]
) -> HeldOut:
    motions = scaled_motions(v, rho)
    angles, spent, fits = np.full((len(parts), len(F)), np.nan), 0.0, 0
    for row, folds in zip(angles, parts, strict=True):
        for held in folds:
            seen = np.setdiff1d(np.arange(len(F)), held)
            start = time.perf_counter()
            try:
                fitted = clone(model).fit(F[seen], v[seen])
            except (InputError, SolveFailed) as error:
                return HeldOut(angles, spent / max(fits, 1), str(error))
            spent, fits = spent + time.perf_counter() - start, fits + 1
            predicted = scaled_motions(fitted.predict(F[held]) / [1, 1, fitted._length], rho)
            row[held] = angles_between(predicted, motions[held])
    return HeldOut(angles, spent / fits, "")
