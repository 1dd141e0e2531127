"""What ellipsoids and quartics share: a convex form fitted to pairs, perhaps with an offset."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError, SolveFailed
from limitsurf.fitting.base import LimitSurfaceModel
from limitsurf.fitting.form_fit import FittedForm, FormLoss
from limitsurf.fitting.pairs import Pairs
from limitsurf.sets.arguments import as_count, as_number, as_positive
from limitsurf.sets.convex_set import ConvexSet

__all__ = ["FormModel"]

Array = NDArray[np.float64]

_STRONGER = 10.0 ** np.arange(6)
_GUESS = 0.15  # rad, or relative: noise before the residuals tell; nine degrees, a hand-held push


class FormModel(LimitSurfaceModel):
    """Base of `EllipsoidModel` and `QuarticModel`, which say what their options mean.

    Attributes
    ----------
    offset_ : (3,) float
        Active offset: the centre of `surface_` [N, N, N m]; zeros without `offset`.
    form_ : FittedForm
        The form behind the surface, in newtons.
    motion_noise_, load_noise_ : float
        Noise, as given or estimated [rad, relative].
    n_iter_ : int
        Gauss-Newton steps of the last fit.
    loss_ : float
        What was minimised.
    shrinkage_ : float
        The shrinkage used: `shrinkage`, or where few pairs then leave the surface unbounded, the
        least of its tenfolds that does not.
    """

    def __init__(
        self,
        rho: float = 0.05,
        *,
        offset: bool = False,
        motion_noise: float | None = None,
        load_noise: float | None = None,
        huber: float = 1.345,
        shrinkage: float = 1.0,
        max_iter: int = 2000,
    ) -> None:
        self.rho = rho
        self.offset = offset
        self.motion_noise = motion_noise
        self.load_noise = load_noise
        self.huber = huber
        self.shrinkage = shrinkage
        self.max_iter = max_iter

    @abstractmethod
    def _fit_form(self, pairs: Pairs, loss: FormLoss, steps: int) -> tuple[FittedForm, FormLoss]:
        """Return the form of least loss, and the loss with the noise estimated."""

    @abstractmethod
    def _surface(self, form: FittedForm, to_newtons: Array) -> ConvexSet:
        """Return the limit surface of a form; `to_newtons` divides moments by rho."""

    @property
    def _passive(self) -> bool:
        return not self.offset

    def _fit(self, pairs: Pairs) -> ConvexSet:
        loss, steps = self._loss(), as_count("max_iter", self.max_iter)
        tries = _STRONGER if loss.shrinkage > 0.0 else _STRONGER[:1]
        for factor in tries:
            trial = replace(loss, shrinkage=float(factor * loss.shrinkage))
            form, fitted = self._fit_form(pairs, trial, steps)
            self.motion_noise_, self.load_noise_ = fitted.motion_noise, fitted.load_noise
            self.form_, self.n_iter_, self.loss_ = form, form.iterations, form.value
            self.shrinkage_ = fitted.shrinkage
            self.offset_ = -form.center * np.array([1.0, 1.0, pairs.rho]) + 0.0
            try:
                return self._surface(form, np.diag([1.0, 1.0, 1.0 / pairs.rho]))
            except SolveFailed as failure:
                unbounded = failure
        raise unbounded

    def _loss(self) -> FormLoss:
        huber = as_number("huber", self.huber)
        shrinkage = as_number("shrinkage", self.shrinkage)
        if not huber > 0.0:
            raise InputError("huber", "must be positive", value=huber, remedy="inf: squares only")
        if not 0.0 <= shrinkage < np.inf:
            raise InputError("shrinkage", "must be finite and at least 0", value=shrinkage)
        names = ("motion_noise", "load_noise")
        given = {name: getattr(self, name) for name in names}
        noise = {k: _GUESS if v is None else as_positive(k, v) for k, v in given.items()}
        unknown = tuple(name for name in names if given[name] is None)
        return FormLoss(**noise, huber=huber, shrinkage=shrinkage, estimated=unknown)

    def _directions(self, loads: Array) -> Array:
        return self.form_.gradients(loads)
