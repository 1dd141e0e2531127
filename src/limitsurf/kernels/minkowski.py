r"""Minkowski sums of convex polytopes: explicit vertices and facets, in time of their number.

Limit surfaces of contacts add (Lemma 10 of Boehringer, Donald, Mihailovich and MacDonald, "A
theory of manipulation and control for microfabricated actuator arrays", 1994): the loads that a
part's contacts can take together are

.. math:: P + Q = \{p + q : p \in P, q \in Q\} .

Its facets are those of P and of Q, each plus the other's face in that direction, and the
parallelograms of the edges whose arcs cross (`fan_overlay`). Where facets or edges are parallel
the overlay breaks facets into patches; here these get a common label and are merged.

Everything that lies less than ``ANGLE * length + rounding`` over a plane counts as lying in it.
So the result differs from the exact sum by no more than a few times that height; flat and thin sums
are found another way (`thin_sum`), for there such heights decide about the rim. Where facets of
P and Q are parallel to within about 100 times ANGLE but not to within ANGLE, thin facets may come
out whose normals are only good to that angle.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial import QhullError

from limitsurf.errors import InputError, SolveFailed
from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.fan_overlay import Axis, Overlay, lay_over
from limitsurf.kernels.flat_polytope import flat_polytope
from limitsurf.kernels.merge_faces import merge_faces, number_vertices
from limitsurf.kernels.normal_fan import ANGLE, Polytope, normal_fan, rounding
from limitsurf.kernels.sum_facets import attach_slivers, label_patches, violation
from limitsurf.kernels.thin_sum import FLAT, flat_sum, hull_of_sums, widths

__all__ = ["add_polygon", "minkowski_sum", "minkowski_sum_of_all", "zonotope"]

#: Axes of the rotation that decides ties, in no special position to each other or to the axes,
#: and factors on the tolerances, tried in turn until all parts of the overlay agree.
_SPINS = ((0.5427, 0.3711, 0.7535), (-0.6613, 0.7193, 0.2128), (0.2387, -0.8231, 0.5154))
_FACTORS = (1.0, 1.0, 30.0, 1e-3, 1000.0)

#: Certified error, relative to the size of the sum, with which an attempt is good, the worst that
#: is accepted when no attempt is, and when there are too many vertex sums for a hull. Only sums
#: with facets that are parallel to within 1e-13 to 1e-10 need more than one attempt.
_GOOD = 4e-12
_FAIR = 1e-10
_BAD = 1e-9
_FEW = 1_000_000

#: Ten times the ratio of least to greatest width, from which on the overlay is not even tried.
_THIN = 1e-4


@compiled
def _sum_vertices(p: Floats, q: Floats, overlay: Overlay) -> tuple[Floats, Ints, bool]:
    """Return the vertices of the overlay's patches and check that the patches form a sphere."""
    vertex, count = number_vertices(overlay.mesh)
    points = np.empty((count, 3))
    p_vertex, q_vertex = np.full(count, -1, np.int32), np.empty(count, np.int32)
    agree, p_of, q_of = True, overlay.p_vertex, overlay.q_vertex
    for h in range(vertex.shape[0]):
        v, i, j = vertex[h], p_of[h], q_of[h]
        if p_vertex[v] < 0:
            p_vertex[v], q_vertex[v] = i, j
            for k in range(3):
                points[v, k] = p[i, k] + q[j, k]
        agree = agree and p_vertex[v] == i and q_vertex[v] == j
    faces = overlay.mesh.face[-1] + 1
    return points, vertex, agree and count - vertex.shape[0] // 2 + faces == 2


@compiled
def _rows(table: Floats, picks: Ints) -> Floats:
    """Return some rows of a table of points (`table[picks]` compiles to something slower)."""
    rows = np.empty((picks.shape[0], 3))
    for i in range(picks.shape[0]):
        for k in range(3):
            rows[i, k] = table[picks[i], k]
    return rows


@compiled
def _sum_once(
    p: Polytope, q: Polytope, noise: tuple[float, float], angle: float, spin: Axis
) -> tuple[Polytope, float]:
    """Return the sum and how far it may be wrong, infinite if its facets do not close up."""
    p_fan, q_fan = normal_fan(p, angle, noise[0]), normal_fan(q, angle, noise[1])
    overlay, agree = lay_over(p_fan, q_fan, spin)
    if not agree:
        return p, math.inf
    points, vertex, agree = _sum_vertices(p.vertices, q.vertices, overlay)
    label, normals = label_patches(p_fan, q_fan, overlay.crossings)
    attach_slivers(overlay.mesh.face, overlay.mesh.twin, label)
    if not agree or label.min() < 0:
        return p, math.inf
    vertices, offsets, indices, labels, twins, sound = merge_faces(
        overlay.mesh, vertex, points, label, angle, noise[0] + noise[1]
    )
    total = Polytope(vertices, offsets, indices, _rows(normals, labels), twins)
    if not sound:
        return p, math.inf
    return total, violation(
        (p.vertices, p_fan), (q.vertices, q_fan), overlay, points, vertex, total, labels
    )


def minkowski_sum(p: Polytope, q: Polytope) -> Polytope:
    """Return the Minkowski sum of two convex polytopes.

    Parameters
    ----------
    p, q : Polytope
        The summands; points, segments and flat polygons are fine (`flat_polytope`).

    Raises
    ------
    SolveFailed
        If the facets do not close up to within 1e-9 of the size, and the vertex sums are too many
        (a million) for a hull: many facets parallel to within 1e-13 to 1e-10, but not less.

    Examples
    --------
    >>> from limitsurf.kernels.flat_polytope import flat_polytope
    >>> square = flat_polytope([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> prism = minkowski_sum(square, flat_polytope([[0, 0, 0], [0, 0, 3]]))
    >>> len(prism.vertices), len(prism.normals)
    (8, 6)
    """
    if len(p.vertices) > len(q.vertices):
        p, q = q, p  # walk the fewer arcs
    if len(p.vertices) == 1:
        return q._replace(vertices=q.vertices + p.vertices)
    noise = rounding(p.vertices), rounding(q.vertices)
    if len(q.vertices) == 2 and (line := _sum_on_line(p, q, noise)) is not None:
        return line
    axes, extents = widths(p, q)
    if extents[2] <= FLAT * extents[0]:
        return flat_sum(p, q, axes)
    few = len(p.vertices) * len(q.vertices) <= _FEW
    thin = min(1.0, 10.0 * float(extents[2] / extents[0]))
    if thin > _THIN or not few:
        best, least = _best_overlay(p, q, noise, thin)
        worst = _FAIR if few else _BAD
        if least <= thin * (worst * float(extents[0]) + 4 * sum(noise)):
            return best
    if few:
        with contextlib.suppress(InputError, QhullError):
            return hull_of_sums(p, q, axes, extents)
    raise SolveFailed(
        "Minkowski sum: its facets do not close up; merge nearly coplanar facets of the summands"
    )


def _best_overlay(
    p: Polytope, q: Polytope, noise: tuple[float, float], thin: float
) -> tuple[Polytope, float]:
    """Return the best of several attempts at the overlay, and its certified error."""
    span = float((np.ptp(p.vertices, axis=0) + np.ptp(q.vertices, axis=0)).max())
    best, least = p, np.inf
    for attempt, factor in enumerate(_FACTORS):
        heights = noise[0] * factor, noise[1] * factor
        spin = _SPINS[attempt % len(_SPINS)]
        total, wrong = _sum_once(p, q, heights, ANGLE * factor, spin)
        if wrong < least:
            best, least = total, wrong
        if least <= thin * (_GOOD * span + 4 * sum(noise)):
            break
    return best, least


def _sum_on_line(p: Polytope, q: Polytope, noise: tuple[float, float]) -> Polytope | None:
    """Return the sum of two parallel segments; None if they are not parallel."""
    a, b = p.vertices[1] - p.vertices[0], q.vertices[1] - q.vertices[0]
    lengths = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    sine = float(np.linalg.norm(np.cross(a / lengths[0], b / lengths[1])))
    if sine > ANGLE + noise[0] / lengths[0] + noise[1] / lengths[1]:
        return None
    return flat_polytope(p.vertices + (q.vertices if a @ b > 0 else q.vertices[::-1]))


def add_polygon(total: Polytope, corners: Floats) -> Polytope:
    """Return the sum with one more contact: a convex polygon or segment given by its corners.

    Takes time linear in the size of `total`.
    """
    return minkowski_sum(total, flat_polytope(corners))


def minkowski_sum_of_all(summands: Sequence[Polytope]) -> Polytope:
    """Return the sum of several polytopes, added in pairs, then pairs of pairs."""
    if len(summands) == 0:
        raise InputError("summands", "must not be empty")
    level = list(summands)
    while len(level) > 1:
        paired = [minkowski_sum(a, b) for a, b in zip(level[::2], level[1::2], strict=False)]
        level = paired + level[len(paired) * 2 :]
    return level[0]


def zonotope(segments: Floats) -> Polytope:
    """Return the sum of segments ``[0, s_i]``, in time of its size, O(N^2).

    Parameters
    ----------
    segments : (N, 3) float
        Vectors s_i; zero vectors are left out.
    """
    segments = np.ascontiguousarray(segments, dtype=float).reshape(-1, 3)
    origin = np.zeros((1, 3))
    kept = segments[segments.any(axis=1)]
    if len(kept) == 0:
        return flat_polytope(origin)
    return minkowski_sum_of_all([flat_polytope(np.vstack([origin, s])) for s in kept])
