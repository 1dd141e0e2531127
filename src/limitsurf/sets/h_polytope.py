"""Polytopes given by their facets."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm
from limitsurf.errors import InputError
from limitsurf.kernels.dual_active_set import closest_on_facets
from limitsurf.kernels.holding_facets import holding_facets
from limitsurf.sets.arguments import Metric, as_array, lifted
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.hulls import chebyshev_center, is_bounded, vertices_of
from limitsurf.sets.projection import Status
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["HPolytope"]

Array = NDArray[np.float64]

_TIGHT = 1e-9  # slack of a facet at a vertex, relative to the size, that Qhull may leave
_MANY = 16  # facets from which walking over the vertex form beats scanning facets


class HPolytope(ConvexSet):
    """The set ``{x : A x <= b}``; must not be empty.

    Parameters
    ----------
    A : (m, n) float
        Outer normals of the facets, one a row, of any length but zero.
    b : (m,) float
        Offsets.

    Raises
    ------
    InputError
        The polytope is empty; or it is unbounded where a bounded one is needed (`to_v`,
        `support`, `face`).

    Examples
    --------
    >>> square = HPolytope([[1, 0], [-1, 0], [0, 1], [0, -1]], [1, 1, 1, 1])
    >>> square.project([3.0, 0.5]).point
    array([1. , 0.5])
    """

    def __init__(self, A: ArrayLike, b: ArrayLike) -> None:
        self._A = as_array("A", A, None, None)
        self._b = as_array("b", b, len(self._A))
        if self._A.size == 0:
            raise InputError("A", "has no rows", remedy="give at least one facet")
        if not np.linalg.norm(self._A, axis=1).all():
            raise InputError("A", "has a zero row", remedy="drop it")
        ball = chebyshev_center(self._A, self._b)
        if ball is None:
            raise InputError("A, b", "describe an empty polytope", remedy="check signs of b")
        self._ball = ball

    @property
    def A(self) -> Array:  # noqa: N802
        """Outer normals."""
        return self._A

    @property
    def b(self) -> Array:
        """Offsets."""
        return self._b

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return int(self._A.shape[1])

    @cached_property
    def bounded(self) -> bool:
        """Whether the polytope is bounded."""
        return is_bounded(self._A)

    def conic_form(self) -> ConicForm:
        """Return ``{x : b - A x >= 0}``."""
        n = self.dim
        A = sparse.csc_matrix(-self._A)
        return ConicForm(np.eye(n), np.zeros(n), A, self._b, (Cone("nonnegative", len(self._b)),))

    @cached_property
    def _vertex_form(self) -> VPolytope:
        if not self.bounded:
            raise InputError("A", "describes an unbounded polytope", remedy="add facets")
        return VPolytope(vertices_of(self._A, self._b, *self._ball))

    def to_v(self) -> VPolytope:
        """Return the polytope by its vertices."""
        return self._vertex_form

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d, by its vertices."""
        return self.to_v().face(d, tol)

    def by_vertices(self) -> VPolytope | None:
        """Return the polytope by its vertices, None if it is unbounded."""
        return self.to_v() if self.bounded else None

    def linear_image(self, matrix: Array, offset: Array) -> ConvexSet | None:
        """Return ``{M x + c : x in S}`` by its vertices."""
        return self.to_v().linear_image(matrix, offset) if self.bounded else None

    def _support_points(self, directions: Array) -> Array:
        return self.to_v().support_point(directions)

    @cached_property
    def _flat(self) -> bool:
        """Whether the largest ball is small beside the polytope: facets locate it badly then."""
        if not (self.bounded and np.isfinite(self._ball[1])):
            return False
        return bool(self._ball[1] < 1e-3 * np.ptp(self.to_v().vertices, axis=0).max())

    def _unit_facets(self, metric: Metric) -> tuple[Array, Array]:
        """Return facets with unit normals in coordinates in which the metric is the identity."""
        if metric.identity:
            return self._own_unit_facets
        normals = np.asarray(np.linalg.solve(metric.C.T, self._A.T).T, dtype=np.float64)
        return _normalised(normals, self._b)

    @cached_property
    def _own_unit_facets(self) -> tuple[Array, Array]:
        return _normalised(self._A, self._b)

    def _project(self, points: Array, metric: Metric) -> Rows:
        if self.dim > 3:
            return super()._project(points, metric)
        A, b = self._unit_facets(metric)
        if self._flat or (len(self._b) > _MANY and self.bounded):
            rows = self.to_v()._project(points, metric)
            around = self._facets_of_vertices
            simplex = np.asarray(rows.active, dtype=np.int32)
            held = holding_facets(lifted(metric.into(points)), simplex, A, b, *around)
            return replace(rows, active=held)
        closest, active, _, count, failed, bound = closest_on_facets(
            lifted(metric.into(points)), A, b
        )
        inside = active[:, 0] < 0
        status = np.where((failed != 0) | np.isinf(bound), Status.FAILED, inside)  # True is INSIDE
        return Rows(metric.unlifted(closest, points, inside), bound, count, status, active)

    @cached_property
    def _facets_of_vertices(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """For vertex i of `to_v`, the facets through it: ``facets[ptr[i]:ptr[i + 1]]``."""
        A, b = self._own_unit_facets
        vertices = self.to_v().vertices
        slack = b - vertices @ A[:, : self.dim].T
        rows, facets = np.nonzero(slack <= _TIGHT * (np.abs(b).max() + np.abs(vertices).max()))
        ptr = np.searchsorted(rows, np.arange(len(vertices) + 1))
        return ptr.astype(np.int32), facets.astype(np.int32)

    def _distances(self, points: Array, metric: Metric) -> Array:
        if self.dim > 3:
            return super()._distances(points, metric)
        return self._projected_distances(points, metric)

    def __repr__(self) -> str:
        """Return the number of facets."""
        return f"HPolytope({len(self._b)} facets in {self.dim} dimensions)"


def _normalised(A: Array, b: Array) -> tuple[Array, Array]:
    lengths = np.linalg.norm(A, axis=1)
    return lifted(A / lengths[:, None]), b / lengths
