"""Forms ``H(x) = sum_k c_k x^e_k``, ``|e_k| = d``, of a load: values and derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from limitsurf.conic.convex_form import form_exponents

__all__ = ["FormBasis", "form_basis"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FormBasis:
    """The monomials of one degree in three variables.

    Attributes
    ----------
    degree : int
        Degree d.
    exponents : (m, 3) int
        Exponents e_k.
    norm : (m,) float
        Weights of the norm ``sum norm_k c_k^2`` that rotations leave alone (Bombieri's).
    ball : (m,) float
        Coefficients of ``|x|^d``.
    """

    degree: int
    exponents: NDArray[np.int64]
    norm: Array
    ball: Array

    def values(self, x: Array) -> Array:
        """Return the monomials (n, m) at x (n, 3)."""
        return _powers(x, self.exponents)

    def gradients(self, x: Array) -> Array:
        """Return the derivatives (n, 3, m) of the monomials."""
        return np.stack([_derivative(x, self.exponents, [i]) for i in range(3)], axis=1)

    def hessians(self, x: Array, c: Array) -> Array:
        """Return the second derivatives (n, 3, 3) of the form c."""
        rows = [[_derivative(x, self.exponents, [i, j]) @ c for j in range(3)] for i in range(3)]
        return np.moveaxis(np.array(rows), -1, 0)

    def substituted(self, c: Array, matrix: Array) -> Array:
        """Return the coefficients of ``H(matrix x)``."""
        found = {tuple(e): k for k, e in enumerate(self.exponents)}
        new = np.zeros_like(c)
        for e, coefficient in zip(self.exponents, c, strict=True):
            factors = np.repeat(np.arange(3), e)
            for chosen in product(range(3), repeat=self.degree):
                key = tuple(chosen.count(i) for i in range(3))
                new[found[key]] += coefficient * np.prod(matrix[factors, chosen])
        return new


@cache
def form_basis(degree: int) -> FormBasis:
    """Return the monomials of degree 2 or 4."""
    exponents = form_exponents(3, degree)
    orders = [math.prod(math.factorial(k) for k in e) for e in exponents]
    norm = np.array(orders) / math.factorial(degree)
    half = math.factorial(degree // 2)
    ball = [
        half / math.prod(math.factorial(k // 2) for k in e) if not (e % 2).any() else 0.0
        for e in exponents
    ]
    return FormBasis(degree, exponents, norm, np.array(ball))


def _powers(x: Array, exponents: NDArray[np.int64]) -> Array:
    table = np.cumprod(np.stack([np.ones_like(x)] + [x] * int(exponents.max()), axis=0), axis=0)
    factors = [table[exponents[:, i], :, i].T for i in range(3)]
    return np.asarray(factors[0] * factors[1] * factors[2])


def _derivative(x: Array, exponents: NDArray[np.int64], along: list[int]) -> Array:
    """Return the derivatives of the monomials, once along each of the given axes."""
    factor, left = np.ones(len(exponents)), exponents.copy()
    for i in along:
        factor *= left[:, i]
        left[:, i] = np.maximum(left[:, i] - 1, 0)
    return np.asarray(factor * _powers(x, left))
