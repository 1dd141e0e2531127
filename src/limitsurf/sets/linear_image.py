"""Linear images of sets, and the transport of loads."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.conic.form import ConicForm, image
from limitsurf.sets.arguments import Metric, as_array
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.projection import Status

__all__ = ["LinearImage", "transport"]

Array = NDArray[np.float64]

_SINGULAR = 1e8  # condition beyond which a map to the preimage loses half of the digits
_ROUNDING = 8 * float(np.finfo(np.float64).eps)  # of the map to the preimage and back


def transport(r: ArrayLike) -> Array:
    """Return ``T_r``, which turns a load about the point r = (x, y) into the load about the origin.

    ``T_r = [[1, 0, 0], [0, 1, 0], [-y, x, 1]]``. Transports compose: ``T_a T_b = T_(a+b)``.
    """
    x, y = as_array("r", r, 2)
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-y, x, 1.0]])


class LinearImage(ConvexSet):
    """The set ``{M x + c : x in S}``.

    Parameters
    ----------
    matrix : (m, n) float
        Matrix M.
    set : ConvexSet
        The set S in n dimensions.
    offset : (m,) float, optional
        Offset c.

    Notes
    -----
    Where S has a closed form for its images (ellipsoids, polytopes, zonotopes), queries use it.
    Otherwise, if M is invertible, projecting on the image in W is projecting on S in M'WM.
    """

    def __init__(
        self,
        matrix: ArrayLike,
        set: ConvexSet,  # noqa: A002
        offset: ArrayLike | None = None,
    ) -> None:
        self._set = set
        self._matrix = as_array("matrix", matrix, None, set.dim)
        m = len(self._matrix)
        self._offset = as_array("offset", np.zeros(m) if offset is None else offset, m)

    @property
    def matrix(self) -> Array:
        """Matrix M."""
        return self._matrix

    @property
    def set(self) -> ConvexSet:
        """The set S."""
        return self._set

    @property
    def offset(self) -> Array:
        """Offset c."""
        return self._offset

    @property
    def dim(self) -> int:
        """Dimension m of the image space."""
        return len(self._matrix)

    @cached_property
    def closed_form(self) -> ConvexSet | None:
        """The same set as an ellipsoid, polytope or zonotope, if it is one."""
        return self._set.linear_image(self._matrix, self._offset)

    def conic_form(self) -> ConicForm:
        """Return the image of the form of S."""
        return image(self._set.conic_form(), self._matrix, self._offset)

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the image of the face of S with normal ``M'd``."""
        direction = as_array("d", d, self.dim)
        return LinearImage(
            self._matrix, self._set.face(self._matrix.T @ direction, tol), self._offset
        )

    def by_vertices(self) -> ConvexSet | None:
        """Return the image as a polytope by its vertices, if S is a polytope."""
        inner = self._set.by_vertices()
        return None if inner is None else inner.linear_image(self._matrix, self._offset)

    def linear_image(self, matrix: Array, offset: Array) -> ConvexSet | None:
        """Return the image of the image in closed form, if S has one."""
        return self._set.linear_image(matrix @ self._matrix, matrix @ self._offset + offset)

    def _support_points(self, directions: Array) -> Array:
        inner = self._set.support_point(directions @ self._matrix)
        return np.asarray(inner @ self._matrix.T + self._offset)

    def _supports(self, directions: Array) -> Array:
        return np.asarray(self._set.support(directions @ self._matrix) + directions @ self._offset)

    @cached_property
    def _invertible(self) -> bool:
        square = self._matrix.shape[0] == self._matrix.shape[1]
        return square and bool(np.linalg.cond(self._matrix) < _SINGULAR)

    def _pulled_back(self, points: Array, metric: Metric) -> tuple[Array, Metric]:
        """Return the preimages of points, and the metric M'WM.

        With ``C M = Q R`` the preimage is ``R^-1 Q'C (p - c)``: M'WM is never formed to be factored
        again, which would square its condition.
        """
        Q, R = np.linalg.qr(metric.C @ self._matrix)
        inner = Metric(R.T @ R, R, identity=False)
        local = inner.back(metric.into(points - self._offset) @ Q)
        return np.ascontiguousarray(local), inner  # kernels are compiled for rows

    def _project(self, points: Array, metric: Metric) -> Rows:
        if self.closed_form is not None:
            return self.closed_form._project(points, metric)
        if not self._invertible:
            return super()._project(points, metric)
        inner, pulled = self._pulled_back(points, metric)
        rows = self._set._project(inner, pulled)
        there = rows.point @ self._matrix.T + self._offset
        there[rows.status == Status.INSIDE] = points[rows.status == Status.INSIDE]
        lengths = np.linalg.norm(inner, axis=1) + np.linalg.norm(rows.point, axis=1)
        outer = np.linalg.norm(points, axis=1) + np.linalg.norm(self._offset)
        size = np.linalg.norm(pulled.C) * lengths + np.linalg.norm(metric.C) * outer
        return replace(rows, point=there, error_bound=rows.error_bound + _ROUNDING * size)

    def _distances(self, points: Array, metric: Metric) -> Array:
        if self.closed_form is not None:
            return self.closed_form._distances(points, metric)
        if not self._invertible:
            return super()._distances(points, metric)
        return self._set._distances(*self._pulled_back(points, metric))

    def __repr__(self) -> str:
        """Return the set that is mapped."""
        return f"LinearImage(of {self._set!r} in {self.dim} dimensions)"
