"""Solve projection, distance and support over a conic form with Clarabel: the slow truth.

Projection is a quadratic program, distance a second-order cone program, and neither is defined
through the other: the first locates points outside better, the second points on the boundary.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm, triangle_order
from limitsurf.errors import SolveFailed

__all__ = ["ConicSolution", "conic_distance", "conic_projection", "conic_support"]

Array = NDArray[np.float64]

_TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class ConicSolution:
    """Outcome of one conic solve.

    Attributes
    ----------
    point : (n,) float
        The point of the set.
    value : float
        Objective: distance, or support.
    gap : float
        ``|primal - dual objective|``, recomputed.
    residual : float
        Largest violation of an equation, recomputed.
    iterations : int
        Iterations of the solver.
    status : str
        The solver's word.
    """

    point: Array
    value: float
    gap: float
    residual: float
    iterations: int
    status: str


def conic_projection(form: ConicForm, p: Array, W: Array) -> ConicSolution:
    """Return the point of the set closest to p: ``min 1/2 (x - p)' W (x - p)``."""
    n, k = form.F.shape
    P = sparse.block_diag([sparse.csc_matrix((k, k)), W])
    solution = _solve(P, np.concatenate([np.zeros(k), -W @ p]), *_rows(form, 0), k, n)
    e = solution.point - p
    return _with_value(solution, float(np.sqrt(max(float(e @ W @ e), 0.0))))


def conic_distance(form: ConicForm, p: Array, W: Array) -> ConicSolution:
    """Return the distance of p from the set: ``min t`` with ``|C (x - p)| <= t``, ``W = C'C``."""
    n, k = form.F.shape
    C = np.linalg.cholesky(W).T
    A, b, cones = _rows(form, 1)
    ball = sparse.csc_matrix(
        np.block([[np.zeros((1, k + n)), np.ones((1, 1))], [np.zeros((n, k)), C, np.zeros((n, 1))]])
    )
    solution = _solve(
        sparse.csc_matrix((k + n + 1, k + n + 1)),
        np.concatenate([np.zeros(k + n), [1.0]]),
        sparse.vstack([A, ball]),
        np.concatenate([b, [0.0], -C @ p]),
        (*cones, Cone("second-order", n + 1)),
        k,
        n,
    )
    return _with_value(solution, max(solution.value, 0.0))


def conic_support(form: ConicForm, d: Array) -> ConicSolution:
    """Return a point of the set farthest along d, and the support ``max d.x``."""
    n, k = form.F.shape
    q = np.concatenate([np.zeros(k), -d])
    solution = _solve(sparse.csc_matrix((k + n, k + n)), q, *_rows(form, 0), k, n)
    return _with_value(solution, float(d @ solution.point))


def _rows(form: ConicForm, extra: int) -> tuple[sparse.csc_matrix, Array, tuple[Cone, ...]]:
    """Return the constraints on ``(y, x, extra variables)``: ``x = F y + f`` and the form's own."""
    n, _k = form.F.shape
    link = sparse.hstack([sparse.csc_matrix(form.F), -sparse.eye(n), sparse.csc_matrix((n, extra))])
    own = sparse.hstack([form.A, sparse.csc_matrix((len(form.b), n + extra))])
    A = sparse.csc_matrix(sparse.vstack([link, own]))
    return A, np.concatenate([form.f, form.b]), (Cone("zero", n), *form.cones)


def _with_value(solution: ConicSolution, value: float) -> ConicSolution:
    return ConicSolution(
        solution.point,
        value,
        solution.gap,
        solution.residual,
        solution.iterations,
        solution.status,
    )


def _solve(
    P: sparse.csc_matrix,
    q: Array,
    A: sparse.csc_matrix,
    b: Array,
    cones: tuple[Cone, ...],
    first: int,
    n: int,
) -> ConicSolution:
    """Solve ``min 1/2 z'Pz + q.z`` with ``A z + b`` in K; the point is ``z[first:first+n]``."""
    import clarabel

    matrix = sparse.csc_matrix(-A)
    upper = sparse.csc_matrix(sparse.triu(P))
    raw = clarabel.DefaultSolver(
        upper, q, matrix, b, [_clarabel_cone(cone) for cone in cones], _settings()
    ).solve()
    z, s, y = np.array(raw.x), np.array(raw.s), np.array(raw.z)
    quadratic = float(z @ (P @ z))
    solution = ConicSolution(
        point=z[first : first + n],
        value=0.5 * quadratic + float(q @ z),
        gap=abs(quadratic + float(q @ z) + float(b @ y)),
        residual=float(np.max(np.abs(matrix @ z + s - b), initial=0.0)),
        iterations=int(raw.iterations),
        status=str(raw.status),
    )
    if solution.status not in ("Solved", "AlmostSolved"):
        raise SolveFailed(
            f"Clarabel ended with {solution.status}; the set may be empty or unbounded, "
            "or badly scaled: divide its lengths by their size",
            best=solution,
        )
    return solution


@cache
def _settings():  # type: ignore[no-untyped-def]
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _TOLERANCE
    return settings


def _clarabel_cone(cone: Cone):  # type: ignore[no-untyped-def]
    import clarabel

    if cone.kind == "semidefinite":
        return clarabel.PSDTriangleConeT(triangle_order(cone.size))
    kinds = {
        "zero": clarabel.ZeroConeT,
        "nonnegative": clarabel.NonnegativeConeT,
        "second-order": clarabel.SecondOrderConeT,
    }
    return kinds[cone.kind](cone.size)
