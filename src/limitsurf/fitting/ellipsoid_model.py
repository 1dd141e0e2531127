"""Ellipsoids fitted to measured loads and motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.fitting.form_fit import FittedForm, FormLoss
from limitsurf.fitting.form_model import FormModel
from limitsurf.fitting.form_stages import fit_quadric, quadric_matrix
from limitsurf.fitting.pairs import Pairs
from limitsurf.sets.ellipsoid import Ellipsoid

__all__ = ["EllipsoidModel"]

Array = NDArray[np.float64]


class EllipsoidModel(FormModel):
    r"""A limit surface that is an ellipsoid: applied loads with ``(F - a)'A(F - a) <= 1``.

    A positive definite; six numbers, nine with an offset. The loss is explained in `form_fit`.

    Parameters
    ----------
    rho : float
        Length that makes moments forces and angles lengths [m], such as the radius of gyration.
    offset : bool
        Whether active contacts push by themselves: the centre is fitted too.
    motion_noise : float, optional
        Expected error of the directions of motion [rad]; estimated if not given.
    load_noise : float, optional
        Expected error of the size of the loads, relative; estimated if not given.
    huber : float
        Errors beyond this many times the noise count linearly: outliers pull little. Infinity for
        least squares.
    shrinkage : float
        How strongly the ellipsoid is drawn towards one of revolution about the axis of moments,
        whose two sizes come from medians; zero for not at all.
    max_iter : int
        Most Gauss-Newton steps.

    Examples
    --------
    A disk of radius 2 N whose moments reach 0.1 N m:

    >>> import numpy as np
    >>> twists = np.random.default_rng(0).normal(size=(50, 3)) * [1.0, 1.0, 20.0]
    >>> disk = Ellipsoid(np.zeros(3), np.diag([2.0, 2.0, 0.1]))
    >>> model = EllipsoidModel(rho=0.05).fit(-disk.support_point(-twists), twists)
    >>> model.surface_.support(np.eye(3)).round(6)
    array([2. , 2. , 0.1])
    >>> bool(model.score(-disk.support_point(-twists), twists) > -1e-6)
    True
    """

    @property
    def _least_pairs(self) -> int:
        return 3 if self.offset else 2

    def _fit_form(self, pairs: Pairs, loss: FormLoss, steps: int) -> tuple[FittedForm, FormLoss]:
        return fit_quadric(pairs, loss, self.offset, steps)

    def _surface(self, form: FittedForm, to_newtons: Array) -> Ellipsoid:
        A = to_newtons @ quadric_matrix(form) @ to_newtons
        return Ellipsoid(self.offset_, np.linalg.inv(np.linalg.cholesky(A)).T)
