"""Polytopes fitted to measured loads and motions: from inside and from outside."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.fitting.base import LimitSurfaceModel
from limitsurf.fitting.pairs import Pairs
from limitsurf.fitting.polytope_fit import consistent_points
from limitsurf.sets.h_polytope import HPolytope
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["PolytopeModel"]

Array = NDArray[np.float64]

_FLAT = 1e-6  # size, relative, below which loads lie in a plane through the offset


class PolytopeModel(LimitSurfaceModel):
    r"""The convex set nearest to the pairs, assuming nothing of its shape.

    The loads are moved as little as possible, until each is the support point along its motion (see
    `consistent_points`). Every convex set with these support points holds their hull, ``inner_``,
    and lies in the intersection of their half-spaces, ``outer_``.

    Parameters
    ----------
    rho : float
        Length that makes moments forces [m].
    kind : {"inner", "outer"}
        Which of the two is `surface_`, and predicts.
    symmetric : bool
        Symmetric about the origin, as of passive contacts: each pair counts with both signs.

    Attributes
    ----------
    surface_ : VPolytope
        What the contacts exert on the part.
    inner_, outer_ : VPolytope, HPolytope
        Both bounds of it. Where motions do not span all directions, `outer_` is unbounded.

    Examples
    --------
    >>> v = np.random.default_rng(0).normal(size=(200, 3))
    >>> cube = VPolytope([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    >>> model = PolytopeModel(1.0).fit(cube.support_point(v), v)
    >>> model.surface_
    VPolytope(8 vertices in 3 dimensions)
    """

    def __init__(
        self,
        rho: float = 0.05,
        *,
        kind: Literal["inner", "outer"] = "inner",
        symmetric: bool = True,
    ) -> None:
        self.rho = rho
        self.kind = kind
        self.symmetric = symmetric

    @property
    def _least_pairs(self) -> int:
        return 3 if self.symmetric else 4

    @property
    def _passive(self) -> bool:
        return self.symmetric

    def _fit(self, pairs: Pairs) -> VPolytope:
        if self.kind not in ("inner", "outer"):
            raise InputError("kind", "is unknown", value=self.kind, remedy="inner or outer")
        v = pairs.motions
        x = consistent_points(pairs.loads, v, pairs.weight, self.symmetric)
        offsets = (v * x).sum(axis=1)
        if self.symmetric:
            x, v, offsets = np.vstack([x, -x]), np.vstack([v, -v]), np.tile(offsets, 2)
        _check_solid(x)
        size = np.array([1.0, 1.0, pairs.rho])
        self.inner_ = VPolytope(-x * size)
        self.outer_ = HPolytope(-v / size, offsets)
        if self.kind == "outer" and not self.outer_.bounded:
            raise InputError("twists", "leave the outer polytope unbounded", remedy="kind inner")
        inner = VPolytope(x).to_h()
        A, b = (inner.A, inner.b) if self.kind == "inner" else (v, offsets)
        self._center = np.zeros(3) if self.symmetric else x.mean(axis=0)
        self._facets = A / np.maximum(b - A @ self._center, 1e-12 * np.abs(b).max())[:, None]
        return self.inner_ if self.kind == "inner" else self.outer_.to_v()

    def _directions(self, loads: Array) -> Array:
        """Return the normal of the facet through which the ray from the centre leaves."""
        out = (loads - self._center) @ self._facets.T
        return np.asarray(self._facets[np.argmax(out, axis=1)])


def _check_solid(x: Array) -> None:
    spread = np.linalg.svd(x - x.mean(axis=0), compute_uv=False)
    if spread[2] <= _FLAT * spread[0]:
        raise InputError("loads", "lie in a plane", remedy="measure loads in all directions")
