"""Polytopes given by their vertices."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm
from limitsurf.errors import InputError
from limitsurf.kernels.closest_on_vertices import closest_on_vertices
from limitsurf.kernels.hill_climbing import (
    Cells,
    Graph,
    direction_cells,
    vertex_graph,
)
from limitsurf.kernels.hull_polytope import hull_polytope
from limitsurf.kernels.normal_fan import Polytope, triangles
from limitsurf.kernels.surface_walk import Surface, triangle_surface
from limitsurf.sets.arguments import Metric, as_array, lifted
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.hulls import Hull, convex_hull
from limitsurf.sets.mesh import hull_mesh
from limitsurf.sets.projection import Status

if TYPE_CHECKING:
    from limitsurf.sets.h_polytope import HPolytope

__all__ = ["VPolytope"]

Array = NDArray[np.float64]


class VPolytope(ConvexSet):
    """The convex hull of points; never empty. Flat ones, segments and points are fine.

    Parameters
    ----------
    vertices : (m, n) float
        Points, one a row; those that are not extreme are dropped.

    Examples
    --------
    >>> triangle = VPolytope([[0, 0], [2, 0], [0, 2]])
    >>> triangle.project([2.0, 2.0]).point
    array([1., 1.])
    """

    def __init__(self, vertices: ArrayLike) -> None:
        points = as_array("vertices", vertices, None, None)
        if points.size == 0:
            raise InputError("vertices", "are missing", remedy="give at least one point")
        hull = convex_hull(points)
        renumber = np.full(len(points), -1)
        renumber[hull.vertices] = np.arange(len(hull.vertices))
        self._hull = Hull(
            np.arange(len(hull.vertices)),
            hull.normals,
            hull.offsets,
            renumber[hull.triangles],
            hull.rank,
        )
        self._vertices = as_array("vertices", points[hull.vertices], None, None)

    @classmethod
    def from_surface(cls, surface: Polytope) -> VPolytope:
        """Return the polytope with an explicit surface, without a hull being computed again."""
        if len(surface.normals) < 4:
            return cls(surface.vertices)
        made = cls.__new__(cls)
        corner = surface.vertices[surface.indices[surface.offsets[:-1]]]
        made._hull = Hull(
            np.arange(len(surface.vertices)),
            surface.normals,
            np.einsum("ij,ij->i", surface.normals, corner),
            triangles(surface).astype(np.int64),
            3,
        )
        made._vertices = as_array("vertices", surface.vertices, None, 3)
        made.surface = surface
        return made

    @cached_property
    def surface(self) -> Polytope:
        """Vertices, facets and normals of a polytope in three dimensions, coplanar parts merged."""
        return hull_polytope(self._vertices)

    @property
    def vertices(self) -> Array:
        """Extreme points (k, n)."""
        return self._vertices

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return int(self._vertices.shape[1])

    @property
    def rank(self) -> int:
        """Dimension of the polytope itself."""
        return self._hull.rank

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Surface triangles (t, 3), outwards, of a solid in three dimensions; else empty."""
        return self._hull.triangles

    def to_mesh(self, directions: int = 0) -> tuple[Array, NDArray[np.int64]]:
        """Return the vertices and outward triangles of a polytope in three dimensions."""
        del directions
        if self.dim != 3:
            raise InputError("set", f"has dimension {self.dim}", remedy="meshes need 3")
        return hull_mesh(self._vertices)

    def conic_form(self) -> ConicForm:
        """Return ``{V'w : w >= 0, sum w = 1}``."""
        k = len(self._vertices)
        A = sparse.csc_matrix(sparse.vstack([np.ones((1, k)), sparse.eye(k)]))
        b = np.concatenate([[-1.0], np.zeros(k)])
        cones = (Cone("zero", 1), Cone("nonnegative", k))
        return ConicForm(self._vertices.T, np.zeros(self.dim), A, b, cones)

    def face(self, d: ArrayLike, tol: float = 1e-9) -> VPolytope:
        """Return the face with outer normal d: the vertices farthest along d."""
        direction = as_array("d", d, self.dim)
        along = (self._vertices - self._vertices[0]) @ direction
        size = np.linalg.norm(direction) * float(np.ptp(self._vertices, axis=0).max())
        return VPolytope(self._vertices[along >= along.max() - tol * size])

    def to_h(self) -> HPolytope:
        """Return the polytope by its facets; a flat one gets pairs of opposite facets."""
        from limitsurf.sets.h_polytope import HPolytope  # each converts to the other

        size = np.abs(self._vertices).max(initial=0.0) or 1.0
        rows = np.round(np.column_stack([self._hull.normals, self._hull.offsets / size]), 14)
        _, first = np.unique(rows, axis=0, return_index=True)  # triangles of one facet
        return HPolytope(self._hull.normals[first], self._hull.offsets[first])

    def by_vertices(self) -> VPolytope:
        """Return the polytope itself."""
        return self

    def linear_image(self, matrix: Array, offset: Array) -> VPolytope:
        """Return ``{M x + c : x in S}``, again a polytope."""
        return VPolytope(self._vertices @ matrix.T + offset)

    def _support_points(self, directions: Array) -> Array:
        best = np.argmax(directions @ self._vertices.T, axis=1)
        points: Array = self._vertices[best]
        return points

    @cached_property
    def _graph(self) -> Graph:
        return vertex_graph(len(self._vertices), self._hull.triangles)

    @cached_property
    def _surface(self) -> Surface:
        return triangle_surface(self._hull.triangles, self._graph)

    @cached_property
    def _kernel_data(self) -> tuple[Array, Cells]:
        corners = lifted(self._vertices)
        return corners, direction_cells(corners, self._graph)

    def _project(self, points: Array, metric: Metric) -> Rows:
        if self.dim > 3:
            return super()._project(points, metric)
        corners, cells = self._kernel_data
        if not metric.identity:
            corners = lifted(metric.into(self._vertices))
            cells = direction_cells(corners, self._graph)
        closest, simplex, _, count, failed, bound = closest_on_vertices(
            lifted(metric.into(points)), corners, self._graph, cells, self._surface
        )
        inside = simplex[:, 0] < 0
        status = np.where(failed != 0, Status.FAILED, inside)  # True is INSIDE
        return Rows(metric.unlifted(closest, points, inside), bound, count, status, simplex)

    def _distances(self, points: Array, metric: Metric) -> Array:
        if self.dim > 3:
            return super()._distances(points, metric)
        return self._projected_distances(points, metric)

    def __repr__(self) -> str:
        """Return the number of vertices and the rank."""
        flat = "" if self.rank == self.dim else f" of rank {self.rank}"
        return f"VPolytope({len(self._vertices)} vertices{flat} in {self.dim} dimensions)"
