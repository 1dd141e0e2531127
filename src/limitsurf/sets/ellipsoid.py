"""Ellipsoids of any rank."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.linalg.lapack import dgejsv

from limitsurf.conic.form import Cone, ConicForm
from limitsurf.errors import SolveFailed
from limitsurf.kernels.trust_region import closest_on_ellipsoid
from limitsurf.sets.arguments import Metric, as_array
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.projection import Status

__all__ = ["Ellipsoid"]

Array = NDArray[np.float64]

_RANK = 4e-16  # singular values below this, relative to the largest, are rounding
_HIGH_ACCURACY, _WANTED, _LEFT_OUT = 2, 0, 3  # xGEJSV's JOBA = F, JOBU = U or JOBV = V, and N


class Ellipsoid(ConvexSet):
    r"""The set ``{c + A u : |u| <= 1}``; never empty.

    Parameters
    ----------
    center : (n,) float
        Centre c, in the unit of the space (loads: [N, N, N m]).
    axes : (n, k) float
        Matrix A; for orthogonal columns these are the semi-axes. Rank below n gives a flat set,
        k = 0 a point.

    Examples
    --------
    The load of a Coulomb contact at (0, 1) with mu N = 1, a disk tilted by 45 degrees:

    >>> contact = Ellipsoid([0, 0, 0], [[1, 0], [0, 1], [-1, 0]])
    >>> contact.project([2.0, 0.0, 0.0]).point
    array([ 1.,  0., -1.])
    """

    def __init__(self, center: ArrayLike, axes: ArrayLike) -> None:
        self._center = as_array("center", center, None)
        n = len(self._center)
        self._axes = as_array(
            "axes", np.reshape(axes, (n, 0)) if np.size(axes) == 0 else axes, n, None
        )

    @property
    def center(self) -> Array:
        """Centre c."""
        return self._center

    @property
    def axes(self) -> Array:
        """Matrix A."""
        return self._axes

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return len(self._center)

    @cached_property
    def _decomposition(self) -> tuple[Array, Array]:
        return _decompose(self._axes)

    @property
    def rank(self) -> int:
        """Dimension of the set itself."""
        return len(self._decomposition[1])

    def conic_form(self) -> ConicForm:
        """Return ``{c + A u : (1, u) in a second-order cone}``."""
        k = self._axes.shape[1]
        A = sparse.vstack([sparse.csc_matrix((1, k)), sparse.eye(k)])
        b = np.concatenate([[1.0], np.zeros(k)])
        return ConicForm(
            self._axes, self._center, sparse.csc_matrix(A), b, (Cone("second-order", k + 1),)
        )

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d: a point, or the whole set if it is normal to d."""
        direction = as_array("d", d, self.dim)
        size = np.linalg.norm(self._axes) * np.linalg.norm(direction)
        if np.linalg.norm(direction @ self._axes) <= tol * size:
            return self
        return Ellipsoid(self._support_points(direction[None])[0], np.empty((self.dim, 0)))

    def linear_image(self, matrix: Array, offset: Array) -> Ellipsoid:
        """Return ``{M x + c : x in S}``, again an ellipsoid."""
        return Ellipsoid(matrix @ self._center + offset, matrix @ self._axes)

    def _support_points(self, directions: Array) -> Array:
        u = directions @ self._axes
        length = np.linalg.norm(u, axis=1, keepdims=True)
        u = np.divide(u, length, out=np.zeros_like(u), where=length > 0.0)
        return np.asarray(self._center + u @ self._axes.T)

    def _supports(self, directions: Array) -> Array:
        lengths = np.linalg.norm(directions @ self._axes, axis=1)
        return np.asarray(directions @ self._center + lengths)

    def _project(self, points: Array, metric: Metric) -> Rows:
        center = metric.into(self._center[None])[0].copy()
        U, s = self._decomposition if metric.identity else _decompose(metric.C @ self._axes)
        scaled = metric.into(points)
        closest, bound = np.empty_like(scaled), np.empty(len(points))
        count = np.empty(len(points), dtype=np.int32)
        closest_on_ellipsoid(scaled, center, U, s, closest, bound, count)
        inside = (count == 0) & (np.linalg.norm(scaled - closest, axis=1) <= bound)
        status = np.where(count < 0, Status.FAILED, np.where(inside, Status.INSIDE, Status.OUTSIDE))
        point = np.where(inside[:, None], points, metric.back(closest))
        return Rows(point, bound, count, status)

    def _distances(self, points: Array, metric: Metric) -> Array:
        return self._projected_distances(points, metric)

    def __repr__(self) -> str:
        """Return centre and semi-axes."""
        center = np.array2string(self._center, precision=4, separator=", ")
        axes = np.array2string(self._decomposition[1], precision=4, separator=", ")
        return f"Ellipsoid(center {center}, semi-axes {axes})"


def _decompose(axes: Array) -> tuple[Array, Array]:
    """Return orthonormal columns and singular values, those of rounding size left out.

    One-sided Jacobi (Drmac and Veselic, SIAM J. Matrix Anal. Appl. 29, 2008; LAPACK's xGEJSV with
    row pivoting) finds small semi-axes and their directions to full relative precision where rows
    and columns of A are of very different sizes, as forces and moments are.
    """
    n, k = axes.shape
    if k == 0 or not axes.any():
        return np.empty((n, 0)), np.empty(0)
    options = {"joba": _HIGH_ACCURACY, "jobp": 0}
    if k <= n:
        s, U, _, work, _, info = dgejsv(axes, jobu=_WANTED, jobv=_LEFT_OUT, **options)
    else:
        s, _, U, work, _, info = dgejsv(axes.T, jobu=_LEFT_OUT, jobv=_WANTED, **options)
    if info != 0:
        raise SolveFailed(f"axes: singular values not found (xGEJSV returns {info})")
    s = s * (work[0] / work[1])
    keep = s > _RANK * s[0]
    return np.ascontiguousarray(U[:, keep]), s[keep]
