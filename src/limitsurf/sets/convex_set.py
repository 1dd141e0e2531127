"""The one base class of convex sets.

A set has to give its dimension and its conic form; every query then works, slowly, through
Clarabel. Closed forms and kernels override the hooks ``_support_points`` and ``_project``, which
get checked rows of points, in coordinates in which the metric is the identity where they say so.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.conic.form import ConicForm, constraints
from limitsurf.conic.solve import conic_distance, conic_projection, conic_support
from limitsurf.errors import InputError, SolveFailed
from limitsurf.kernels.residuals import residuals
from limitsurf.sets.arguments import Metric, as_points, read_metric
from limitsurf.sets.mesh import hull_mesh, sphere_directions
from limitsurf.sets.projection import Projection, Status

__all__ = ["ConvexSet", "Rows"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rows:
    """What a projection hook returns for k points: closest points, bounds, iterations, status."""

    point: Array
    error_bound: Array
    iterations: NDArray[np.integer[Any]]
    status: NDArray[np.integer[Any]]
    active: NDArray[np.integer[Any]] | None = None


class ConvexSet(ABC):
    """A non-empty, closed, bounded convex set in n dimensions. Immutable.

    All queries take arrays of shape (..., n) and return arrays of the same leading shape.
    """

    @property
    @abstractmethod
    def dim(self) -> int:
        """Dimension n of the space."""

    @abstractmethod
    def conic_form(self) -> ConicForm:
        """Return the set as conic data, ``{ F y + f : A y + b in K }``."""

    def constraints(self, variable: Any) -> list[Any]:
        """Return cvxpy constraints that hold exactly if `variable`, of shape (n,), is in the set.

        Examples
        --------
        >>> import cvxpy as cp
        >>> from limitsurf.sets.ellipsoid import Ellipsoid
        >>> F = cp.Variable(2)
        >>> disk = Ellipsoid([0, 0], [[2, 0], [0, 2]])
        >>> round(float(cp.Problem(cp.Maximize(F[0]), disk.constraints(F)).solve("CLARABEL")), 6)
        2.0
        """
        if getattr(variable, "shape", None) != (self.dim,):
            raise InputError(
                "variable", f"has shape {getattr(variable, 'shape', None)}, not ({self.dim},)"
            )
        return constraints(self.conic_form(), variable)

    def support_point(self, d: ArrayLike) -> Array:
        """Return a point of the set farthest along each direction d.

        While a part slides with twist v, ``support_point(-v)`` is the frictional load: maximum
        work. Not unique where the set has a flat face with normal d; see `face`.
        """
        directions, shape = as_points("d", d, self.dim)
        return self._support_points(directions).reshape(*shape, self.dim)

    def support(self, d: ArrayLike) -> Array:
        """Return the support function ``h(d) = max d.x``; ``h(-v)`` is the dissipated power."""
        directions, shape = as_points("d", d, self.dim)
        values: Array = self._supports(directions).reshape(shape)
        return values

    @abstractmethod
    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d, shape (n,): all points farthest along d.

        `tol` is relative to the size of the set. d = 0 gives the set itself.
        """

    def by_vertices(self) -> ConvexSet | None:
        """Return the same set as a polytope given by its vertices, or None if it is none."""
        return None

    def linear_image(self, matrix: Array, offset: Array) -> ConvexSet | None:
        """Return ``{M x + c : x in S}`` as a set with a closed form of its own, or None."""
        del matrix, offset
        return None

    def project(
        self, p: ArrayLike, metric: ArrayLike | None = None, *, throw: bool = True
    ) -> Projection:
        """Return the closest points of the set, with certified errors.

        Parameters
        ----------
        p : (..., n) float
            Points.
        metric : (n, n) or (n,) float, optional
            Symmetric positive definite W, or its diagonal; distance^2 is ``e' W e``.
        throw : bool
            Raise `SolveFailed` if a solver stops early; False returns its best point, with status
            `Status.FAILED`.
        """
        points, shape = as_points("p", p, self.dim)
        W = read_metric(metric, self.dim)
        rows = self._project(points, W)
        inside = rows.status == Status.INSIDE
        distance, normal, twist = residuals(points, rows.point, W.W, inside)
        projection = Projection(
            point=rows.point.reshape(*shape, self.dim),
            distance=distance.reshape(shape),
            normal=normal.reshape(*shape, self.dim),
            twist=twist.reshape(*shape, self.dim),
            error_bound=rows.error_bound.reshape(shape),
            iterations=rows.iterations.reshape(shape),
            status=rows.status.reshape(shape),
            active=_reshaped(rows.active, shape),
        )
        if throw and (failed := int((rows.status == Status.FAILED).sum())):
            raise SolveFailed(
                f"project: {failed} of {len(points)} points {Status.FAILED!s}",
                best=projection,
            )
        return projection

    def distance(self, p: ArrayLike, metric: ArrayLike | None = None) -> Array:
        """Return the distances of points from the set in the norm of the metric, 0 inside."""
        points, shape = as_points("p", p, self.dim)
        return self._distances(points, read_metric(metric, self.dim)).reshape(shape)

    def contains(self, p: ArrayLike, tol: float = 1e-9) -> NDArray[np.bool_]:
        """Return whether points lie in the set, up to a Euclidean distance `tol`."""
        if not tol >= 0.0:
            raise InputError("tol", "must be at least 0", value=tol)
        return np.asarray(self.distance(p) <= tol)

    def to_mesh(self, directions: int = 2000) -> tuple[Array, NDArray[np.int64]]:
        """Return vertices (k, 3) and outward triangles (t, 3) of a set in three dimensions.

        The mesh is the convex hull of the support points in evenly spread directions; polytopes
        give their own.
        """
        if self.dim != 3:
            raise InputError("set", f"has dimension {self.dim}", remedy="meshes need 3")
        if (same := self.by_vertices()) is not None:
            return same.to_mesh()
        return hull_mesh(self.support_point(sphere_directions(directions)))

    def _support_points(self, directions: Array) -> Array:
        form = self.conic_form()
        return np.array([conic_support(form, d).point for d in directions]).reshape(-1, self.dim)

    def _supports(self, directions: Array) -> Array:
        return np.asarray((directions * self._support_points(directions)).sum(axis=1))

    def _project(self, points: Array, metric: Metric) -> Rows:
        """Project through Clarabel; the bound is its duality gap, ``|x - x*|^2 <= 2 gap``."""
        form = self.conic_form()
        solutions, solved = [], []
        for p in points:
            try:
                solutions.append(conic_projection(form, p, metric.W))
                solved.append(True)
            except SolveFailed as failure:
                solutions.append(failure.best)
                solved.append(False)
        closest = np.array([s.point for s in solutions]).reshape(-1, self.dim)
        bound = np.array([np.sqrt(2 * s.gap) + s.residual for s in solutions])
        inside = np.array([s.value for s in solutions]) <= bound
        status = np.where(inside, Status.INSIDE, Status.OUTSIDE)
        return Rows(
            closest,
            bound,
            np.array([s.iterations for s in solutions], dtype=np.int64),
            np.where(solved, status, Status.FAILED).astype(np.int64),
        )

    def _projected_distances(self, points: Array, metric: Metric) -> Array:
        """Return distances of closest points, for sets in which these have a closed form."""
        rows = self._project(points, metric)
        if (rows.status == Status.FAILED).any():
            raise SolveFailed(f"distance: {Status.FAILED!s}", best=rows)
        distances = np.linalg.norm(metric.into(points - rows.point), axis=1)
        return np.where(rows.status == Status.INSIDE, 0.0, distances)

    def _distances(self, points: Array, metric: Metric) -> Array:
        form = self.conic_form()
        return np.array([conic_distance(form, p, metric.W).value for p in points])


def _reshaped(
    active: NDArray[np.integer[Any]] | None, shape: tuple[int, ...]
) -> NDArray[np.integer[Any]] | None:
    return None if active is None else active.reshape(*shape, active.shape[1])
