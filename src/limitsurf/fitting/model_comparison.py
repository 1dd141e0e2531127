"""Held-out errors of several models, with intervals and a recommendation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.base import clone

from limitsurf.fitting.base import LimitSurfaceModel

__all__ = ["HeldOut", "ModelComparison", "comparison_table"]

Array = NDArray[np.float64]

_DRAWS, _TAILS = 2000, (0.025, 0.975)  # of the bootstrap over pairs: intervals of 95 %


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Held-out angles (repeats, n), seconds per fit, and why the model failed."""

    angles: Array
    fit_time: float
    failed: str


@dataclass(frozen=True, eq=False)
class ModelComparison:
    """Held-out errors of several models on the same pairs.

    Attributes
    ----------
    table : DataFrame
        One row a model, best first: mean held-out ``angle``, its interval ``low`` to ``high``, by
        how much it is ``worse_by`` than the best, with that interval [all deg], ``fit_time`` [s],
        and ``failed``: why a model could not be fitted, if so.
    angles : dict of (repeats, n) float
        Held-out angle [rad] of every pair, by model.
    recommended : str
        The model of least mean angle.
    models : dict
        The models, not fitted.
    """

    table: pd.DataFrame
    angles: Mapping[str, Array]
    recommended: str
    models: Mapping[str, LimitSurfaceModel]

    def fit_recommended(self, loads: Any, twists: Any) -> LimitSurfaceModel:
        """Return the recommended model, fitted."""
        model: LimitSurfaceModel = clone(self.models[self.recommended])
        return model.fit(loads, twists)

    @property
    def advice(self) -> str:
        """The recommendation in words, with the models that are as good as far as one can tell."""
        rows = self.table[self.table.failed == ""]
        best = rows.loc[self.recommended]
        text = (
            f"recommended: {self.recommended}, {best.angle:.1f} deg held out "
            f"({best.low:.1f} to {best.high:.1f})"
        )
        level = [str(name) for name in rows.index if rows.worse_low[name] <= 0.0]
        others = [name for name in level if name != self.recommended]
        return f"{text}; not told apart from it: {', '.join(others)}" if others else text

    def __repr__(self) -> str:
        """Return the table and the recommendation."""
        return f"{self.table.round(3).to_string()}\n{self.advice}"


def comparison_table(results: Mapping[str, HeldOut], seed: int) -> pd.DataFrame:
    """Return the table, best first; models that failed come last."""
    mean = {name: np.degrees(r.angles.mean(axis=0)) for name, r in results.items()}
    fitted = [name for name, r in results.items() if not r.failed]
    best = min(fitted, key=lambda name: mean[name].mean(), default=None)
    rows = {}
    for name, result in results.items():
        low, high = _interval(mean[name], seed)
        worse = mean[name] - mean[best] if best is not None else mean[name]
        worse_low, worse_high = _interval(worse, seed)
        rows[name] = {
            "angle": mean[name].mean() if not result.failed else np.nan,
            "low": low,
            "high": high,
            "worse_by": worse.mean(),
            "worse_low": worse_low,
            "worse_high": worse_high,
            "fit_time": result.fit_time,
            "failed": result.failed,
        }
    return pd.DataFrame.from_dict(rows, orient="index").sort_values("angle", kind="stable")


def _interval(values: Array, seed: int) -> tuple[float, float]:
    """Return a bootstrap interval of the mean of values (n,)."""
    rng = np.random.default_rng(seed)
    means = values[rng.integers(len(values), size=(_DRAWS, len(values)))].mean(axis=1)
    low, high = np.quantile(means, _TAILS) if np.isfinite(means).all() else (np.nan, np.nan)
    return float(low), float(high)
