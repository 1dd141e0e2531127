"""Sublevel sets of even, convex quartics."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.conic.form import ConicForm, image
from limitsurf.conic.moments import convexity_margin, polynomial_form
from limitsurf.errors import InputError, SolveFailed
from limitsurf.kernels.polynomial import closest_on_polynomial, polynomial_values
from limitsurf.kernels.polynomial_support import support_on_polynomial
from limitsurf.sets.arguments import Metric, as_array
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.projection import Status

__all__ = ["PolynomialSet"]

Array = NDArray[np.float64]

_CERTIFIED = -1e-7  # the margin of a polynomial on the edge of convexity, to solver tolerance
_ALONG = 1e-9  # largest sine of the angle between a direction and the normal at its support point


class PolynomialSet(ConvexSet):
    """The set ``{x : sum_k c_k x^e_k <= 1}`` of an even, convex polynomial of degree four.

    Symmetric about the origin, and strictly convex: a polynomial that is constant on a segment is
    constant on its line, which no bounded set holds. Convexity is certified by writing the Hessian
    form as a sum of squares.

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
        self._scale = self._intercepts()
        self._scaled = self._coefficients * np.prod(self._scale**self._exponents, axis=1)
        self._margin = convexity_margin(self._exponents.astype(np.int64), self._scaled)
        if self._margin < _CERTIFIED:
            raise InputError(
                "coefficients", f"no certificate of convexity: margin {self._margin:.2g}"
            )
        self._check_bounded()

    def _intercepts(self) -> Array:
        """Return where the boundary meets the axes, as powers of two; 1 where it does not.

        With these as units the set has size 1, whatever the units of force and moment: neither the
        certificate of convexity nor Newton's method then depends on them.
        """
        pure = np.zeros((2, self.dim))
        for e, c in zip(self._exponents, self._coefficients, strict=True):
            if np.count_nonzero(e) == 1:
                pure[e.max() // 2 - 1, e.argmax()] += c
        a, b = np.maximum(pure, 0.0)
        root = a + np.sqrt(a * a + 4.0 * b)
        meets = np.sqrt(np.divide(2.0, root, out=np.ones_like(root), where=root > 0.0))
        return np.asarray(np.exp2(np.round(np.log2(meets))))

    def _check_bounded(self) -> None:
        """Raise unless q > 0 on the unit sphere: else the set holds a line.

        A convex, even q without constant that vanishes at x vanishes along all of x's line; the
        kernel of its Hessians at enough points then holds x.
        """
        axes = np.eye(self.dim)
        probes = np.vstack([axes, np.random.default_rng(0).normal(size=(20, self.dim))])

        def total(shift: Array) -> float:
            values = polynomial_values(self._exponents, self._scaled, probes + shift)
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
        """How far the Hessian form stays a sum of squares.

        Relative to the coefficients, in units in which the set has size 1.
        """
        return self._margin

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return int(self._exponents.shape[1])

    @cached_property
    def _form(self) -> ConicForm:
        unit = polynomial_form(self._exponents.astype(np.int64), self._scaled)
        return image(unit, np.diag(self._scale), np.zeros(self.dim))

    def conic_form(self) -> ConicForm:
        """Return the first moments of semidefinite moment matrices with ``L(q) <= 1``."""
        return self._form

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d: a point, as the set is strictly convex."""
        del tol
        direction = as_array("d", d, self.dim)
        if not direction.any():
            return self
        return Ellipsoid(self._support_points(direction[None])[0], np.empty((self.dim, 0)))

    def _support_points(self, directions: Array) -> Array:
        farthest, residual = np.empty_like(directions), np.empty(len(directions))
        scaled = directions * self._scale
        support_on_polynomial(scaled, self._exponents, self._scaled, farthest, residual)
        if not np.all(residual <= _ALONG):
            raise SolveFailed(
                f"support: Newton's method stopped {residual.max():.1e} from the normal",
                best=farthest * self._scale,
            )
        return farthest * self._scale

    def _project(self, points: Array, metric: Metric) -> Rows:
        closest, bound = np.empty_like(points), np.empty(len(points))
        count = np.empty(len(points), dtype=np.int32)
        W = metric.W * np.outer(self._scale, self._scale)
        root = np.array(np.linalg.inv(metric.C * self._scale).T, dtype=np.float64, order="C")
        polynomial = self._exponents, self._scaled
        scaled = points / self._scale
        closest_on_polynomial(scaled, polynomial, (W, root), closest, bound, count)
        status = np.choose(np.sign(count) + 1, [Status.FAILED, Status.INSIDE, Status.OUTSIDE])
        return Rows(closest * self._scale, bound, count, status)

    def _distances(self, points: Array, metric: Metric) -> Array:
        return self._projected_distances(points, metric)

    def __repr__(self) -> str:
        """Return the number of monomials."""
        return f"PolynomialSet({len(self._coefficients)} monomials in {self.dim} dimensions)"
