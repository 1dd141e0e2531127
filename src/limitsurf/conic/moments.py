r"""Polynomial sublevel sets as conic data, and convexity certified by sums of squares.

For a polynomial q of degree four whose Hessian is a sum of squares, Lasserre's relaxation of order
two is exact: ``{x : q(x) <= 1}`` is the projection, on the first moments, of the positive
semidefinite moment matrices with ``sum q_e y_e <= 1`` (Lasserre, SIAM J. Optim. 19, 2009).
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm

__all__ = ["convexity_margin", "polynomial_form"]

Array = NDArray[np.float64]
Exponents = NDArray[np.int64]


def _monomials(n: int, degree: int) -> list[tuple[int, ...]]:
    """Return the exponents of all monomials up to a degree, the constant first."""
    found: list[tuple[int, ...]] = []
    for total in range(degree + 1):
        found += [
            tuple(variables.count(i) for i in range(n))
            for variables in combinations_with_replacement(range(n), total)
        ]
    return found


def polynomial_form(exponents: Exponents, coefficients: Array) -> ConicForm:
    """Return the conic form of ``{x : sum c_k x^e_k <= 1}`` for an SOS-convex quartic."""
    n = exponents.shape[1]
    moments = {e: k - 1 for k, e in enumerate(_monomials(n, 4))}  # the constant moment is 1
    basis = _monomials(n, 2)
    order = len(basis)
    rows, columns, values, b = [], [], [], [1.0]
    for e, c in zip(exponents, coefficients, strict=True):
        rows.append(0)
        columns.append(moments[tuple(int(x) for x in e)])
        values.append(-c)
    row = 1
    for j in range(order):
        for i in range(j + 1):
            product = tuple(p + q for p, q in zip(basis[i], basis[j], strict=True))
            if sum(product) == 0:
                b.append(1.0)
            else:
                b.append(0.0)
                rows.append(row)
                columns.append(moments[product])
                values.append(1.0 if i == j else np.sqrt(2.0))
            row += 1
    A = sparse.csc_matrix((values, (rows, columns)), (row, len(moments) - 1))
    F = np.zeros((n, len(moments) - 1))
    for i in range(n):
        F[i, moments[tuple(int(i == j) for j in range(n))]] = 1.0
    cones = (Cone("nonnegative", 1), Cone("semidefinite", order * (order + 1) // 2))
    return ConicForm(F, np.zeros(n), A, np.array(b), cones)


def convexity_margin(exponents: Exponents, coefficients: Array) -> float:
    """Return the largest t such that the Hessian form of a quartic minus t is a sum of squares.

    The form ``y' H(x) y`` of an even quartic is ``y'Ay`` plus a form in the products ``y_i x_j``. t
    is the lesser of the smallest eigenvalue of A (if there is a quadratic part) and of the best
    Gram matrix of the second; relative to the largest coefficient. Convexity is certified if
    t >= 0, up to the solver's tolerance.
    """
    n = exponents.shape[1]
    scale = float(np.abs(coefficients).max())
    quadratic = np.zeros((n, n))
    quartic: dict[tuple[tuple[int, ...], tuple[int, ...]], float] = {}
    for e, c in zip(exponents, coefficients / scale, strict=True):
        for i in range(n):
            for j in range(n):
                left = e - np.eye(n, dtype=np.int64)[i]
                factor = c * e[i] * left[j]
                rest = left - np.eye(n, dtype=np.int64)[j]
                if factor == 0:
                    continue
                if e.sum() == 2:
                    quadratic[i, j] += factor
                else:
                    y = tuple(sorted((i, j)))
                    x = tuple(int(k) for k in np.repeat(np.arange(n), rest))
                    quartic[y, x] = quartic.get((y, x), 0.0) + factor
    margins = []
    if quadratic.any():
        margins.append(float(np.linalg.eigvalsh(quadratic)[0]))
    if quartic:
        margins.append(_gram_margin(n, quartic))
    return min(margins)


def _gram_margin(n: int, form: dict[tuple[tuple[int, ...], tuple[int, ...]], float]) -> float:
    """Return ``max t`` with ``Q - t I`` semidefinite and ``z'Qz`` the form, ``z = (y_i x_j)``."""
    import cvxpy as cp

    pairs = [(i, j) for i in range(n) for j in range(n)]
    Q, t = cp.Variable((n * n, n * n), symmetric=True), cp.Variable()
    terms: dict[tuple[tuple[int, ...], tuple[int, ...]], list[tuple[int, int]]] = {}
    for a, (i, j) in enumerate(pairs):
        for b, (k, m) in enumerate(pairs):
            terms.setdefault((tuple(sorted((i, k))), tuple(sorted((j, m)))), []).append((a, b))
    matches = [
        sum(Q[a, b] for a, b in places) == form.get(key, 0.0) for key, places in terms.items()
    ]
    program = cp.Problem(cp.Maximize(t), [Q - t * np.eye(n * n) >> 0, *matches])
    program.solve(solver=cp.CLARABEL)
    return float(t.value) if t.value is not None else -np.inf
