"""Where the fit of a form starts: rough answers in closed form, which outliers do not move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.fitting.form_fit import FittedForm
from limitsurf.fitting.forms import form_basis
from limitsurf.fitting.pairs import Pairs

__all__ = ["ball_start", "weighted_median"]

Array = NDArray[np.float64]


def ball_start(pairs: Pairs, offset: bool) -> FittedForm:
    """Return an ellipsoid ``fx^2 + fy^2 + k m^2 <= r^2``, about an offset if there is one.

    Its motion is ``(fx, fy, k m)``, so that k is how much larger the share of the rotation is in
    motions than that of the moment in loads, and r is the size of the loads: medians of both.
    """
    center = _rough_center(pairs) if offset else np.zeros(3)
    x = pairs.loads - center
    across = [np.hypot(rows[:, 0], rows[:, 1]) for rows in (x, pairs.motions)]
    turn = np.abs(pairs.motions[:, 2]) * across[0]
    moment = np.abs(x[:, 2]) * across[1]
    known = (turn > 0.0) & (moment > 0.0)
    k = 1.0
    if known.any():
        k = np.exp(weighted_median(np.log(turn[known] / moment[known]), pairs.weight[known]))
    size = np.linalg.norm(x * np.sqrt([1.0, 1.0, k]), axis=1)
    r = weighted_median(size, pairs.weight)
    basis = form_basis(2)
    return FittedForm(basis, basis.ball, np.diag(np.sqrt([1.0, 1.0, k])) / r, center)


def _rough_center(pairs: Pairs) -> Array:
    """Return a of ``F = a + M v`` by least squares: opposite motions need loads opposite from a."""
    root = np.sqrt(pairs.weight)[:, None]
    columns = np.hstack([np.ones((len(pairs), 1)), pairs.motions])
    return np.asarray(np.linalg.lstsq(columns * root, pairs.loads * root)[0][0])


def weighted_median(values: Array, weight: Array) -> float:
    """Return the weighted median: half of the weight lies on either side."""
    order = np.argsort(values)
    below = np.cumsum(weight[order])
    half = 0.5 * below[-1]
    low, high = np.searchsorted(below, half), np.searchsorted(below, half, side="right")
    return float(0.5 * (values[order[low]] + values[order[min(high, len(values) - 1)]]))
