"""Zonotopes: sums of segments."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm
from limitsurf.sets.arguments import Metric, as_array
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.polytope_sum import polytope_sum
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["Zonotope"]

Array = NDArray[np.float64]


class Zonotope(ConvexSet):
    """The set ``{c + sum_i t_i g_i : -1 <= t_i <= 1}``; never empty.

    Parameters
    ----------
    center : (n,) float
        Centre c.
    generators : (m, n) float
        Generators g_i, one a row; m = 0 gives a point.

    Examples
    --------
    >>> Zonotope([0, 0], [[1, 0], [0, 2]]).support([1.0, 1.0])
    array(3.)
    """

    def __init__(self, center: ArrayLike, generators: ArrayLike) -> None:
        self._center = as_array("center", center, None)
        self._generators = as_array("generators", generators, None, len(self._center))

    @property
    def center(self) -> Array:
        """Centre c."""
        return self._center

    @property
    def generators(self) -> Array:
        """Generators, one a row."""
        return self._generators

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return len(self._center)

    def conic_form(self) -> ConicForm:
        """Return ``{c + G't : 1 + t >= 0, 1 - t >= 0}``."""
        m = len(self._generators)
        A = sparse.csc_matrix(sparse.vstack([sparse.eye(m), -sparse.eye(m)]))
        cones = (Cone("nonnegative", 2 * m),) if m else ()
        return ConicForm(self._generators.T, self._center, A, np.ones(2 * m), cones)

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d: the zonotope of the generators normal to d."""
        direction = as_array("d", d, self.dim)
        along = self._generators @ direction
        lengths = np.linalg.norm(self._generators, axis=1) * np.linalg.norm(direction)
        flat = np.abs(along) <= tol * lengths
        tip = self._center + np.sign(along[~flat]) @ self._generators[~flat]
        return Zonotope(tip, self._generators[flat])

    def _support_points(self, directions: Array) -> Array:
        signs = np.sign(directions @ self._generators.T)
        return np.asarray(self._center + signs @ self._generators)

    def _supports(self, directions: Array) -> Array:
        reach = np.abs(directions @ self._generators.T).sum(axis=1)
        return np.asarray(directions @ self._center + reach)

    def by_vertices(self) -> VPolytope | None:
        """Return the zonotope by its vertices in up to three dimensions, None beyond."""
        return None if self.dim > 3 else self._polytope

    @cached_property
    def _polytope(self) -> VPolytope:
        segments = [VPolytope([-g, g]) for g in self._generators if g.any()]
        return polytope_sum([VPolytope(self._center[None]), *segments])

    def _project(self, points: Array, metric: Metric) -> Rows:
        solve = super()._project if self.dim > 3 else self._polytope._project
        return solve(points, metric)

    def _distances(self, points: Array, metric: Metric) -> Array:
        solve = super()._distances if self.dim > 3 else self._polytope._distances
        return solve(points, metric)

    def linear_image(self, matrix: Array, offset: Array) -> Zonotope:
        """Return ``{M x + c : x in S}``, again a zonotope."""
        return Zonotope(matrix @ self._center + offset, self._generators @ matrix.T)

    def __repr__(self) -> str:
        """Return the number of generators."""
        return f"Zonotope({len(self._generators)} generators in {self.dim} dimensions)"
