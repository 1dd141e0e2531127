"""Minkowski sums: the limit surface of several contacts is the sum of theirs (Lemma 10)."""

from __future__ import annotations

from functools import cached_property, reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.conic.form import ConicForm, minkowski_sum
from limitsurf.errors import InputError
from limitsurf.sets.arguments import Metric, as_array
from limitsurf.sets.contact_terms import sum_of_contacts
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.polytope_sum import polytope_sum
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["MinkowskiSum"]

Array = NDArray[np.float64]


class MinkowskiSum(ConvexSet):
    """The set ``{x_1 + ... + x_k : x_i in S_i}``; support functions add.

    Parameters
    ----------
    *sets : ConvexSet
        At least one, all of one dimension.

    Notes
    -----
    The sum of polytopes and zonotopes in up to three dimensions is made explicit when a
    projection first needs it; flat ellipsoids of loads become a `ContactSum`. Other sums are
    projected through the conic form.

    Examples
    --------
    >>> from limitsurf.sets.ellipsoid import Ellipsoid
    >>> disk = Ellipsoid([0, 0], [[1, 0], [0, 1]])
    >>> MinkowskiSum(disk, disk, disk).support([3.0, 4.0])
    array(15.)
    """

    def __init__(self, *sets: ConvexSet) -> None:
        if not sets:
            raise InputError("sets", "are missing", remedy="give at least one set")
        dims = [s.dim for s in sets]
        if len(set(dims)) > 1:
            raise InputError("sets", f"have different dimensions {dims}")
        self._sets = tuple(sets)

    @property
    def sets(self) -> tuple[ConvexSet, ...]:
        """The terms."""
        return self._sets

    @property
    def dim(self) -> int:
        """Dimension n of the space."""
        return self._sets[0].dim

    @cached_property
    def explicit(self) -> VPolytope | None:
        """The sum as one polytope, if all terms are polytopes in up to three dimensions."""
        if self.dim > 3:
            return None
        terms = [term for s in self._sets if isinstance(term := s.by_vertices(), VPolytope)]
        return polytope_sum(terms) if len(terms) == len(self._sets) else None

    def by_vertices(self) -> VPolytope | None:
        """Return the explicit sum."""
        return self.explicit

    def conic_form(self) -> ConicForm:
        """Return the sum of the forms."""
        return minkowski_sum([s.conic_form() for s in self._sets])

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the sum of the faces with normal d."""
        direction = as_array("d", d, self.dim)
        return MinkowskiSum(*[s.face(direction, tol) for s in self._sets])

    def linear_image(self, matrix: Array, offset: Array) -> ConvexSet | None:
        """Return the sum of the images in closed form, if all terms have one."""
        zero = np.zeros(len(matrix))
        images = [
            s.linear_image(matrix, offset if i == 0 else zero) for i, s in enumerate(self._sets)
        ]
        return MinkowskiSum(*[s for s in images if s is not None]) if all(images) else None

    def _support_points(self, directions: Array) -> Array:
        return reduce(np.add, [s.support_point(directions) for s in self._sets])

    def _supports(self, directions: Array) -> Array:
        return reduce(np.add, [s.support(directions) for s in self._sets])

    @cached_property
    def closed_form(self) -> ConvexSet | None:
        """The same set as a polytope or a sum of contacts, if it is one."""
        return self.explicit or sum_of_contacts(self._sets)

    def _project(self, points: Array, metric: Metric) -> Rows:
        same = self.closed_form
        return super()._project(points, metric) if same is None else same._project(points, metric)

    def _distances(self, points: Array, metric: Metric) -> Array:
        same = self.closed_form
        if same is None:
            return super()._distances(points, metric)
        return same._distances(points, metric)

    def __repr__(self) -> str:
        """Return the terms."""
        terms = ", ".join(repr(s) for s in self._sets[:4])
        more = f", and {len(self._sets) - 4} more" if len(self._sets) > 4 else ""
        return f"MinkowskiSum({terms}{more})"
