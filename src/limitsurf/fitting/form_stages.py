"""The stages of a fit: a start in closed form, an ellipsoid near it, a quartic near that; noise."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.fitting.form_fit import FittedForm, FormLoss, fit_form, residuals
from limitsurf.fitting.form_start import ball_start, weighted_median
from limitsurf.fitting.forms import form_basis
from limitsurf.fitting.pairs import Pairs

__all__ = ["fit_quadric", "fit_quartic", "quadric_matrix"]

Array = NDArray[np.float64]

_ROUNDS = 2
_LEAST_NOISE = 1e-3  # rad, or relative: less than what forces are measured to
_RAYLEIGH, _NORMAL = (
    np.sqrt(2.0 * np.log(2.0)),
    0.67449,
)  # medians of errors in two, in one dimension


def fit_quadric(
    pairs: Pairs, loss: FormLoss, offset: bool, steps: int
) -> tuple[FittedForm, FormLoss]:
    """Return the ellipsoid of least loss, drawn towards that of `ball_start`, and its noise."""
    return _fit_with_noise(ball_start(pairs, offset), pairs, loss, offset, steps)


def fit_quartic(
    pairs: Pairs, loss: FormLoss, offset: bool, steps: int
) -> tuple[FittedForm, FormLoss]:
    """Return the convex quartic of least loss, drawn towards the ellipsoid of least loss."""
    ellipsoid, _ = fit_quadric(pairs, loss, offset, steps)
    basis = form_basis(4)
    root = np.asarray(np.linalg.cholesky(quadric_matrix(ellipsoid)).T)
    start = FittedForm(basis, basis.ball, root, ellipsoid.center)
    return _fit_with_noise(start, pairs, loss, offset, steps)


def quadric_matrix(form: FittedForm) -> Array:
    """Return A of ``(F - a)'A(F - a) <= 1``."""
    half = 0.5 * form.basis.hessians(np.zeros((1, 3)), form.c)[0]
    return np.asarray(form.frame.T @ half @ form.frame)


def _fit_with_noise(
    start: FittedForm, pairs: Pairs, loss: FormLoss, offset: bool, steps: int
) -> tuple[FittedForm, FormLoss]:
    """Fit, estimate the noise from what is left, and fit again."""
    form = fit_form(start, pairs, loss, offset, steps)
    for _ in range(_ROUNDS if loss.estimated else 0):
        loss = _with_noise(form, pairs, loss)
        form = fit_form(form, pairs, loss, offset, steps)
    return form, loss


def _with_noise(form: FittedForm, pairs: Pairs, loss: FormLoss) -> FormLoss:
    """Return the loss with its estimated noises renewed.

    Robust deviations of the residuals, which m coefficients have made too small: for m of the pairs
    the noise assumed so far stands.
    """
    r, s = residuals(form, pairs)
    n, m = float(pairs.weight.sum()), len(form.c)
    seen = {
        "motion_noise": weighted_median(np.linalg.norm(r, axis=1), pairs.weight) / _RAYLEIGH,
        "load_noise": weighted_median(np.abs(s), pairs.weight) / _NORMAL,
    }
    noise: dict[str, Any] = {
        name: max(
            _LEAST_NOISE,
            float(np.sqrt((m * getattr(loss, name) ** 2 + n * seen[name] ** 2) / (m + n))),
        )
        for name in loss.estimated
    }
    return replace(loss, **noise)
