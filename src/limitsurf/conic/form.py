r"""Convex sets as plain conic data: ``{ F y + f : A y + b in K }``.

K is a product of cones. Every set of limitsurf can be written like this, and sums and linear
images of sets are sums and images of forms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

__all__ = ["Cone", "ConicForm", "constraints", "image", "minkowski_sum"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cone:
    """One cone: all zero, non-negative, second-order ``(t, z), |z| <= t``, or semidefinite.

    Attributes
    ----------
    kind : {"zero", "nonnegative", "second-order", "semidefinite"}
        Which cone.
    size : int
        Number of rows; a semidefinite cone of order k has k (k + 1) / 2 rows, the upper triangle
        by columns, off-diagonal entries times sqrt(2).
    """

    kind: Literal["zero", "nonnegative", "second-order", "semidefinite"]
    size: int


@dataclass(frozen=True, eq=False)
class ConicForm:
    """The set ``{ F y + f : A y + b in K }``.

    Attributes
    ----------
    F, f : (n, k) and (n,) float
        The map from the variables y to the points of the set.
    A, b : (m, k) sparse and (m,) float
        The conic constraint.
    cones : tuple of Cone
        K, in the order of the rows of A.
    """

    F: Array
    f: Array
    A: sparse.csc_matrix
    b: Array
    cones: tuple[Cone, ...]


def image(form: ConicForm, matrix: Array, offset: Array) -> ConicForm:
    """Return the form of ``{ M x + c : x in S }``."""
    return ConicForm(matrix @ form.F, matrix @ form.f + offset, form.A, form.b, form.cones)


def minkowski_sum(forms: Sequence[ConicForm]) -> ConicForm:
    """Return the form of the sum of the sets; each keeps its own variables."""
    return ConicForm(
        np.hstack([form.F for form in forms]),
        np.sum([form.f for form in forms], axis=0),
        sparse.csc_matrix(sparse.block_diag([form.A for form in forms])),
        np.concatenate([form.b for form in forms]),
        tuple(cone for form in forms for cone in form.cones),
    )


def constraints(form: ConicForm, point: Any) -> list[Any]:
    """Return cvxpy constraints that hold exactly for points of the set.

    Parameters
    ----------
    form : ConicForm
        The set.
    point : cvxpy expression, (n,)
        What has to lie in it.
    """
    import cvxpy as cp

    if form.F.shape[1] == 0:
        return [point == form.f]
    y = cp.Variable(form.F.shape[1])
    found = [point == form.F @ y + form.f]
    rows = form.A @ y + form.b
    start = 0
    for cone in form.cones:
        part = rows[start : start + cone.size]
        start += cone.size
        if cone.kind == "zero":
            found.append(part == 0)
        elif cone.kind == "nonnegative":
            found.append(part >= 0)
        elif cone.kind == "second-order":
            found.append(cp.SOC(part[0], part[1:]))
        else:
            order = triangle_order(cone.size)
            full = cp.reshape(unpacking(order) @ part, (order, order), order="F")
            found.append(full >> 0)
    return found


def triangle_order(size: int) -> int:
    """Return the order k of a semidefinite cone of k (k + 1) / 2 rows."""
    return int((np.sqrt(8 * size + 1) - 1) / 2 + 0.5)


def unpacking(order: int) -> sparse.csc_matrix:
    """Return the matrix that unpacks a scaled upper triangle into all entries, by columns."""
    rows, columns, values = [], [], []
    k = 0
    for j in range(order):
        for i in range(j + 1):
            scale = 1.0 if i == j else np.sqrt(0.5)
            for row in {i + order * j, j + order * i}:
                rows.append(row)
                columns.append(k)
                values.append(scale)
            k += 1
    return sparse.csc_matrix((values, (rows, columns)), (order * order, k))
