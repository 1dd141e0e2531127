r"""Least squares over the convex forms of even degree in n variables.

A form H of degree d, ``H(x) = sum_k c_k x^e_k`` with all ``|e_k| = d``, is convex if its Hessian
form is a sum of squares: ``y' H''(x) y = z'Qz`` with Q positive semidefinite and z the products of
one y and a monomial in x of degree ``d/2 - 1``. In three variables every convex quartic form has
such a Q (Ahmadi and Parrilo, SIAM J. Optim. 23, 2013). Matching coefficients leaves
``Q = S c + N u`` with u free: a small program, whatever the number of data behind P and q.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse

from limitsurf.conic.form import unpacking
from limitsurf.errors import SolveFailed

__all__ = ["FLOOR", "form_exponents", "hessian_squares", "minimize_over_convex_forms"]

Array = NDArray[np.float64]
Exponents = NDArray[np.int64]

#: Least eigenvalue of Q by degree. More than solver tolerance, so that what comes out is certified
#: convex; and no ellipsoid is longer than a hundred units, where data say nothing of its length.
FLOOR = {2: 1e-4, 4: 1e-6}

_TOLERANCES = 1e-9, 1e-8  # the second where rounding stops the first


def form_exponents(n: int, degree: int) -> Exponents:
    """Return the exponents (m, n) of all monomials of a degree."""
    choices = combinations_with_replacement(range(n), degree)
    return np.array([[c.count(i) for i in range(n)] for c in choices], dtype=np.int64)


def minimize_over_convex_forms(P: Array, q: Array, degree: int, n: int = 3) -> Array:
    """Return the minimiser of ``1/2 x'Px + q.x``, whose first entries are a convex form.

    Parameters
    ----------
    P, q : (m + k, m + k) and (m + k,) float
        Positive semidefinite P; the first m unknowns are the coefficients of `form_exponents`, the
        other k are free.
    degree, n : int
        Degree of the form, 2 or 4, and number of variables.

    Raises
    ------
    SolveFailed
        Clarabel found no minimum.
    """
    import clarabel

    S, N = hessian_squares(n, degree)
    size = max(float(np.abs(np.diag(P)).max()), 1e-300)
    k, free = len(q) - S.shape[1], N.shape[1]
    quadratic = sparse.block_diag([np.triu(P / size), sparse.csc_matrix((free, free))], "csc")
    A = sparse.csc_matrix(-np.hstack([S, np.zeros((len(S), k)), N]))
    order = _order(len(S))
    b = -FLOOR[degree] * _triangle(np.eye(order))
    linear = np.concatenate([q / size, np.zeros(free)])
    for tolerance in _TOLERANCES:
        cones = [clarabel.PSDTriangleConeT(order)]
        raw = clarabel.DefaultSolver(quadratic, linear, A, b, cones, _settings(tolerance)).solve()
        if str(raw.status) in ("Solved", "AlmostSolved"):
            return _polished(P, q, np.array(raw.x), degree, n)
    raise SolveFailed(f"convex form: Clarabel ended with {raw.status}", best=np.array(raw.x))


def _polished(P: Array, q: Array, found: Array, degree: int, n: int) -> Array:
    """Return the minimum without the cone, if the Gram matrix found shows that it lies inside.

    A solver that closes its gap to 1e-9 knows the minimiser only to the root of that.
    """
    S, N = hessian_squares(n, degree)
    free = np.asarray(linalg.lstsq(P, -q)[0])
    Q = S @ free[: S.shape[1]] + N @ found[len(q) :]
    order = _order(len(S))
    inside = np.linalg.eigvalsh((unpacking(order) @ Q).reshape(order, order))[0] >= FLOOR[degree]
    return free if inside else found[: len(q)]


def _settings(tolerance: float):  # type: ignore[no-untyped-def]
    """Return settings without scaling of rows: it makes a well-scaled program worse."""
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = settings.equilibrate_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    return settings


@cache
def hessian_squares(n: int, degree: int) -> tuple[Array, Array]:
    """Return S and N: scaled triangles of all matrices Q of the Hessian form of c are S c + N u."""
    exponents = form_exponents(n, degree)
    units = np.eye(n, dtype=np.int64)
    basis = [(i, x) for i in range(n) for x in form_exponents(n, degree // 2 - 1)]
    terms: dict[tuple[int, ...], int] = {}  # monomials in y and x, each a row of the matching

    def row(y: Exponents, x: Exponents) -> int:
        return terms.setdefault((*y, *x), len(terms))

    match: list[tuple[int, int, float]] = []
    for b, (j, right) in enumerate(basis):
        for a, (i, left) in enumerate(basis[: b + 1]):
            scale = 1.0 if a == b else np.sqrt(2.0)
            match.append((row(units[i] + units[j], left + right), len(match), scale))
    second: list[tuple[int, int, float]] = []
    for c, e in enumerate(exponents):
        for i in range(n):
            for j in range(n):
                left = e - units[i]
                if (factor := e[i] * left[j]) > 0:
                    second.append((row(units[i] + units[j], left - units[j]), c, float(factor)))
    M = _matrix(match, len(terms), len(match))
    S = linalg.lstsq(M, _matrix(second, len(terms), len(exponents)))[0]
    return np.asarray(S), np.asarray(linalg.null_space(M))


def _matrix(entries: list[tuple[int, int, float]], rows: int, columns: int) -> Array:
    matrix = np.zeros((rows, columns))
    for i, j, value in entries:
        matrix[i, j] += value
    return matrix


def _order(size: int) -> int:
    return int(np.sqrt(2 * size))


def _triangle(matrix: Array) -> Array:
    """Return the upper triangle by columns, off-diagonal entries times sqrt(2)."""
    k = len(matrix)
    scale = np.sqrt(2.0)
    return np.array(
        [matrix[i, j] * (1.0 if i == j else scale) for j in range(k) for i in range(j + 1)]
    )
