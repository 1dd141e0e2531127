"""Convex quartics fitted to measured loads and motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError, SolveFailed
from limitsurf.fitting.form_fit import FittedForm, FormLoss
from limitsurf.fitting.form_model import FormModel
from limitsurf.fitting.form_stages import fit_quartic
from limitsurf.fitting.pairs import Pairs
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.linear_image import LinearImage
from limitsurf.sets.polynomial_set import PolynomialSet

__all__ = ["QuarticModel"]

Array = NDArray[np.float64]


class QuarticModel(FormModel):
    r"""A limit surface of degree four: applied loads with ``H(F - a) <= 1``, H a convex form.

    Fifteen numbers, 18 with an offset. H is convex because its Hessian form is a sum of squares, as
    Zhou, Paolini, Bagnell and Mason proposed (A convex polynomial force-motion model for planar
    sliding, ICRA 2016); the loss is that of `form_fit`.

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
        How strongly the quartic is drawn towards the ellipsoid that the same options fit, and this
        towards one of revolution; zero for not at all.
    max_iter : int
        Most Gauss-Newton steps of either.

    Examples
    --------
    Three feet under a part; predictions for pushes that the fit has not seen:

    >>> import numpy as np
    >>> from limitsurf.contacts.contact_set import ContactSet
    >>> feet = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], 1.0).limit_surface()
    >>> twists = np.random.default_rng(0).normal(size=(200, 3)) * [1.0, 1.0, 20.0]
    >>> loads = -feet.support_point(-twists)
    >>> model = QuarticModel(rho=0.05).fit(loads[:100], twists[:100])
    >>> bool(-np.degrees(model.score(loads[100:], twists[100:])) < 6.0)
    True
    """

    @property
    def _least_pairs(self) -> int:
        return 6 if self.offset else 5

    def _fit_form(self, pairs: Pairs, loss: FormLoss, steps: int) -> tuple[FittedForm, FormLoss]:
        return fit_quartic(pairs, loss, self.offset, steps)

    def _surface(self, form: FittedForm, to_newtons: Array) -> ConvexSet:
        coefficients = form.basis.substituted(form.c, form.frame @ to_newtons)
        try:
            centred = PolynomialSet(form.basis.exponents, coefficients)
        except InputError as error:
            raise SolveFailed(
                f"the pairs leave the surface all but unbounded ({error}); measure pushes in other "
                "directions, or raise shrinkage",
                best=form,
            ) from error
        return LinearImage(np.eye(3), centred, self.offset_) if self.offset else centred
