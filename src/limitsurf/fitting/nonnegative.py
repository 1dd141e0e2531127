r"""Non-negative weights from residuals in groups of three: least squares, or Huber's loss.

.. math:: \min_{m \ge 0}\; \sum_i w_i\, \ell_\delta(|X_i m - y_i|) + |s m|^2 + |C m|^2

with :math:`\ell_\delta(r) = r^2` up to :math:`\delta` and :math:`2 \delta r - \delta^2` beyond: a
convex problem. Weights :math:`\min(1, \delta/r)` on groups that are far off turn it into least
squares, again and again (iteratively reweighted), each solved by the active-set method of Lawson
and Hanson (`scipy.optimize.nnls`) on the columns that may be in use.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls

from limitsurf.errors import SolveFailed

__all__ = ["Penalty", "Residuals", "least_squares", "nonnegative_weights"]

Array = NDArray[np.float64]

_ROUNDS, _SETTLED = 100, 1e-9  # reweightings, and the relative fall at which they end
_ENTRIES, _STILL = 300, 1e-11  # times that columns enter, and slopes that are rounding


@dataclass(frozen=True, eq=False)
class Residuals:
    """Groups of residuals ``X_i m - y_i``, linear in the weights m, and their loss.

    Attributes
    ----------
    X : (n, d, N) float
        Slopes.
    y : (n, d) float
        Targets.
    weight : (n,) float
        Weights w_i.
    delta : float
        Where Huber's loss turns from squares to lengths; infinity for least squares.
    """

    X: Array
    y: Array
    weight: Array
    delta: float

    def norms(self, m: Array) -> Array:
        """Return the lengths (n,) of the residuals."""
        return np.asarray(np.linalg.norm(self.X @ m - self.y, axis=1))

    def loss(self, m: Array) -> float:
        """Return ``sum w l(|X m - y|)``."""
        return float(self.weight @ huber_loss(self.norms(m), self.delta))

    def rows(self, m: Array | None) -> tuple[Array, Array]:
        """Return rows and targets of the least squares that stand for the loss around m."""
        near = 1.0 if m is None else huber_weight(self.norms(m), self.delta)
        scale = np.sqrt(self.weight * near)[:, None]
        X = (self.X * scale[:, :, None]).reshape(-1, self.X.shape[2])
        return X, (self.y * scale).ravel()


@dataclass(frozen=True, eq=False)
class Penalty:
    """The penalty ``|s m|^2 + |C m|^2``.

    Attributes
    ----------
    s : (N,) float
        Ridge.
    C : (k, N) float
        Rows that should vanish.
    """

    s: Array
    C: Array

    def loss(self, m: Array) -> float:
        """Return the penalty."""
        return float(np.sum((self.s * m) ** 2) + np.sum((self.C @ m) ** 2))

    def added_to(self, X: Array, y: Array) -> tuple[Array, Array, Array]:
        """Return rows, targets and ridge of least squares with the penalty."""
        return np.vstack([X, self.C]), np.concatenate([y, np.zeros(len(self.C))]), self.s


def huber_loss(r: Array, delta: float) -> Array:
    """Return ``r^2`` up to delta, ``2 delta r - delta^2`` beyond."""
    s = np.minimum(r, delta)
    return np.asarray(s * (2.0 * r - s))


def huber_weight(r: Array, delta: float) -> Array:
    """Return the weights ``min(1, delta/r)`` of squares that stand for Huber's loss around r."""
    return np.asarray(np.minimum(1.0, delta / np.maximum(r, np.finfo(np.float64).tiny)))


def least_squares(X: Array, y: Array, strength: Array, start: Array) -> Array:
    r"""Return the m >= 0 of least ``|X m - y|^2 + |strength m|^2``.

    Few weights are positive: the program is solved for some columns, and those along which the loss
    would still fall are added, until there are none. That proves the answer: a gradient that is
    non-negative, and zero where m is positive.

    Parameters
    ----------
    X : (d, N) float
        Columns.
    y : (d,) float
        Target.
    strength : (N,) float
        Ridge on each weight.
    start : (N,) float
        Weights whose columns are tried first.

    Raises
    ------
    SolveFailed
        Columns enter without end, or `scipy.optimize.nnls` does not end.
    """
    least = _STILL * np.linalg.norm(X, axis=0) * np.linalg.norm(y)
    gram = (X.T @ X, X.T @ y) if len(X) > 2 * X.shape[1] else None
    used = np.flatnonzero(start > 0.0)
    for _ in range(_ENTRIES):
        m = np.zeros(X.shape[1])
        if len(used):
            m[used] = _of_columns(X, y, strength, gram, used)
        fall = X.T @ (y - X @ m) - strength**2 * m
        fall[used] = 0.0
        enter = np.flatnonzero(fall > least)
        if not len(enter):
            return m
        most = np.argsort(fall[enter])[::-1][: max(8, len(used) // 2)]
        used = np.concatenate([np.flatnonzero(m > 0.0), enter[most]])
    raise SolveFailed("fit: non-negative weights did not settle; give more smoothing", best=m)


def _of_columns(
    X: Array, y: Array, strength: Array, gram: tuple[Array, Array] | None, used: NDArray[np.intp]
) -> Array:
    """Solve the program for the columns used, by the Cholesky factor of their Gram matrix if given.

    Where that is singular, and for few rows, by the rows themselves.
    """
    ridge = np.diag(strength[used])
    rows, target = np.vstack([X[:, used], ridge]), np.concatenate([y, np.zeros(len(used))])
    if gram is not None:
        G, g = gram
        with contextlib.suppress(np.linalg.LinAlgError):
            R = cholesky(G[np.ix_(used, used)] + ridge**2)
            rows, target = R, solve_triangular(R, g[used], trans="T")
    try:
        return np.asarray(nnls(rows, target, maxiter=30 * len(used))[0])
    except RuntimeError as error:
        raise SolveFailed(
            "fit: non-negative least squares did not end; give more smoothing", best=None
        ) from error


def nonnegative_weights(
    residuals: Residuals, penalty: Penalty, start: Array | None = None
) -> Array:
    """Return the weights m >= 0 of least loss and penalty: a convex program.

    Raises
    ------
    SolveFailed
        See `least_squares`.
    """
    m = np.zeros(residuals.X.shape[2]) if start is None else start
    lowest = np.inf
    for _ in range(_ROUNDS):
        X, y = residuals.rows(m if np.isfinite(lowest) or start is not None else None)
        m = least_squares(*penalty.added_to(X, y), m)
        before, lowest = lowest, residuals.loss(m) + penalty.loss(m)
        if not np.isfinite(residuals.delta) or before - lowest <= _SETTLED * lowest:
            break
    return m
