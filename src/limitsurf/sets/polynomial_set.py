"""Sublevel sets of even, convex quartics."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.conic.form import ConicForm
from limitsurf.conic.moments import convexity_margin, polynomial_form
from limitsurf.errors import InputError
from limitsurf.kernels.polynomial import closest_on_polynomial, polynomial_values
from limitsurf.sets.arguments import Metric, as_array
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.projection import Status

__all__ = ["PolynomialSet"]

Array = NDArray[np.float64]

_CERTIFIED = -1e-7  # the margin of a polynomial on the edge of convexity, to solver tolerance


class PolynomialSet(ConvexSet):
    """The set ``{x : sum_k c_k x^e_k <= 1}`` of an even, convex polynomial of degree four.

    Symmetric about the origin. Convexity is certified by writing the Hessian form as a sum of
    squares.

    Parameters
    ----------
    exponents : (m, n) int
        Exponents e_k, one monomial a row; each row sums to 2 or 4.
    coefficients : (m,) float
        Coefficients c_k.

    Raises
    ------
    InputError
        Other degrees, not certified convex, or not bounded.

    Examples
    --------
    >>> ball = PolynomialSet([[4, 0], [2, 2], [0, 4]], [1.0, 2.0, 1.0])  # |x|^4 <= 1
    >>> ball.project([3.0, 4.0]).point
    array([0.6, 0.8])
    """

    def __init__(self, exponents: ArrayLike, coefficients: ArrayLike) -> None:
        powers = as_array("exponents", exponents, None, None)
        self._coefficients = as_array("coefficients", coefficients, len(powers))
        self._exponents = np.ascontiguousarray(powers, dtype=np.int32)
        degrees = self._exponents.sum(axis=1)
        whole = np.array_equal(powers, self._exponents) and bool((powers >= 0).all())
        if len(powers) == 0 or not whole or not np.isin(degrees, (2, 4)).all():
            raise InputError("exponents", "must be whole, each row of sum 2 or 4")
        self._margin = convexity_margin(self._exponents.astype(np.int64), self._coefficients)
        if self._margin < _CERTIFIED:
            raise InputError(
                "coefficients", f"no certificate of convexity: margin {self._margin:.2g}"
            )
        self._check_bounded()

    def _check_bounded(self) -> None:
        """Raise unless q > 0 on the unit sphere: else the set holds a line.

        A convex, even q without constant that vanishes at x vanishes along all of x's line; the
        kernel of its Hessians at enough points then holds x.
        """
        axes = np.eye(self.dim)
        probes = np.vstack([axes, np.random.default_rng(0).normal(size=(20, self.dim))])

        def total(shift: Array) -> float:
            values = polynomial_values(self._exponents, self._coefficients, probes + shift)
            return float(values.sum())

        hessian = [
            [total(a + b) - total(a - b) - total(b - a) + total(-a - b) for b in 0.5 * axes]
            for a in 0.5 * axes
        ]
        eigenvalues = np.linalg.eigvalsh(hessian)
        if eigenvalues[0] <= 1e-9 * max(eigenvalues[-1], 0.0) or eigenvalues[-1] <= 0.0:
            raise InputError("coefficients", "describe an unbounded set", remedy="add monomials")

    @property
    def exponents(self) -> NDArray[np.int32]:
        """Exponents e_k."""
        return self._exponents

    @property
    def coefficients(self) -> Array:
        """Coefficients c_k."""
        return self._coefficients

    @property
    def convexity_margin(self) -> float:
        """How far the Hessian form stays a sum of squares, relative to the coefficients."""
        return self._margin

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return int(self._exponents.shape[1])

    @cached_property
    def _form(self) -> ConicForm:
        return polynomial_form(self._exponents.astype(np.int64), self._coefficients)

    def conic_form(self) -> ConicForm:
        """Return the first moments of semidefinite moment matrices with ``L(q) <= 1``."""
        return self._form

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d, a point; flat faces are not resolved."""
        del tol
        direction = as_array("d", d, self.dim)
        if not direction.any():
            return self
        return Ellipsoid(self._support_points(direction[None])[0], np.empty((self.dim, 0)))

    def _project(self, points: Array, metric: Metric) -> Rows:
        if not metric.identity:
            return super()._project(points, metric)
        closest, bound = np.empty_like(points), np.empty(len(points))
        count = np.empty(len(points), dtype=np.int32)
        closest_on_polynomial(points, self._exponents, self._coefficients, closest, bound, count)
        status = np.choose(np.sign(count) + 1, [Status.FAILED, Status.INSIDE, Status.OUTSIDE])
        return Rows(closest, bound, count, status)

    def _distances(self, points: Array, metric: Metric) -> Array:
        if not metric.identity:
            return super()._distances(points, metric)
        return self._projected_distances(points, metric)

    def __repr__(self) -> str:
        """Return the number of monomials."""
        return f"PolynomialSet({len(self._coefficients)} monomials in {self.dim} dimensions)"
