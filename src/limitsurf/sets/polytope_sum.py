"""Explicit Minkowski sums of polytopes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from limitsurf.kernels.minkowski import minkowski_sum_of_all
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["polytope_sum"]


def polytope_sum(terms: Sequence[VPolytope]) -> VPolytope:
    """Return the sum of polytopes in up to three dimensions by its vertices.

    In three dimensions by the overlay of the normal fans, in time of the sum's size (Lemma 10);
    so adding one contact to an explicit sum takes time linear in the size of the sum.
    """
    if terms[0].dim == 3:
        return VPolytope.from_surface(minkowski_sum_of_all([term.surface for term in terms]))
    return reduce(_sum_of_two, terms)


def _sum_of_two(a: VPolytope, b: VPolytope) -> VPolytope:
    return VPolytope((a.vertices[:, None] + b.vertices[None]).reshape(-1, a.dim))
