r"""Convex polytopes as half-edges, and their normal fans on the Gauss sphere.

The normal fan of a polytope divides the sphere of directions into cells: the cell of a vertex v
holds the directions in which v is extreme. A facet is a point of the sphere (its normal), an edge
the great arc between the normals of its two facets; the edge's own direction is the pole of that
arc. A flat polygon has two facets, opposite normals and half circles for arcs; a segment is a
polygon with two corners, whose normals are any two opposite directions across it.

Half-edge h runs from ``indices[h]`` to the next corner of its facet, which lies to the left, seen
from outside; ``twins[h]`` is the same edge seen from the facet to the right.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from limitsurf.errors import InputError
from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = [
    "ANGLE",
    "Arc",
    "Fan",
    "Polytope",
    "arc_of",
    "facet_normals",
    "normal_fan",
    "pair_twins",
    "polytope_from_faces",
    "rounding",
    "signed_height",
    "some_edge",
    "triangles",
]

#: Height over a plane, relative to the length of an edge, below which the edge lies in it. Normals
#: of facets as small as 1e-3 of the polytope are known to about 2e-13 (rounding of the corners
#: over their distance); support functions and volumes are asked for to 1e-12.
ANGLE: Final = 2e-13

#: The vector along an edge and its level height, a row of `Fan.edge`.
Arc = tuple[float, float, float, float]

_EPS = float(np.finfo(np.float64).eps)


class Polytope(NamedTuple):
    """A convex polytope; corners of facet i are ``indices[offsets[i]:offsets[i + 1]]``.

    Facets are convex polygons, counter-clockwise seen from outside, no two of them coplanar. Flat
    polytopes have two facets of opposite normals, a point has none.
    """

    vertices: Floats
    offsets: Ints
    indices: Ints
    normals: Floats
    twins: Ints


class Fan(NamedTuple):
    """The normal fan: half-edges, and those that leave each vertex, counter-clockwise.

    Those of v are ``around[first[v]:first[v + 1]]``, and `ring` are the facets to their left.
    Rows of `edge` hold the vector along a half-edge, the pole of its arc, and the height below
    which its ends count as level. Facets are `real` unless they have only two corners. Kernels
    take the arrays out of the tuple first: in a loop that would cost more than the work itself.
    """

    normals: Floats
    real: Ints
    origin: Ints
    face: Ints
    next: Ints
    previous: Ints
    twin: Ints
    edge: Floats
    length: Floats
    first: Ints
    around: Ints
    ring: Ints


def rounding(vertices: Floats) -> float:
    """Return the height that rounding of the coordinates (and of a few sums) can make or hide."""
    return 16 * _EPS * float(np.abs(vertices).max(initial=0.0))


@compiled
def _cycles(offsets: Ints) -> tuple[Ints, Ints, Ints]:
    """Return facet, next and previous half-edge of every half-edge."""
    n = offsets[-1]
    face, after, before = np.empty(n, np.int32), np.empty(n, np.int32), np.empty(n, np.int32)
    for i in range(offsets.shape[0] - 1):
        start, end = offsets[i], offsets[i + 1]
        for h in range(start, end):
            face[h] = i
            after[h] = h + 1 if h + 1 < end else start
            before[h] = h - 1 if h > start else end - 1
    return face, after, before


@compiled
def _leaving(origin: Ints, previous: Ints, twin: Ints, n_vertices: int) -> tuple[Ints, Ints]:
    """Return the half-edges that leave each vertex, counter-clockwise, and where its run starts."""
    n = origin.shape[0]
    first = np.zeros(n_vertices + 1, np.int32)
    around = np.empty(n, np.int32)
    some = np.empty(n_vertices, np.int32)
    for h in range(n):
        first[origin[h] + 1] += 1
        some[origin[h]] = h
    for v in range(n_vertices):
        first[v + 1] += first[v]
        h = some[v]
        for k in range(first[v], first[v + 1]):
            around[k] = h
            h = twin[previous[h]]
    return first, around


@compiled
def normal_fan(polytope: Polytope, angle: float, noise: float) -> Fan:
    """Return the normal fan; heights up to ``angle * length + noise`` count as level."""
    vertices, offsets, origin = polytope.vertices, polytope.offsets, polytope.indices
    face, after, before = _cycles(offsets)
    first, around = _leaving(origin, before, polytope.twins, vertices.shape[0])
    n = origin.shape[0]
    ring = np.empty(n, np.int32)
    for k in range(n):
        ring[k] = face[around[k]]
    edge, length = np.empty((n, 4)), np.empty(n)
    for h in range(n):
        square = 0.0
        for k in range(3):
            edge[h, k] = vertices[origin[after[h]], k] - vertices[origin[h], k]
            square += edge[h, k] * edge[h, k]
        length[h] = np.sqrt(square)
        edge[h, 3] = angle * length[h] + noise
    real = np.empty(offsets.shape[0] - 1, np.int32)
    for i in range(real.shape[0]):
        real[i] = 1 if offsets[i + 1] - offsets[i] > 2 else 0
    return Fan(
        polytope.normals, real, origin, face, after, before, polytope.twins,
        edge, length, first, around, ring,
    )  # fmt: skip


@compiled
def facet_normals(vertices: Floats, offsets: Ints, indices: Ints) -> Floats:
    """Return unit normals from the area vectors, made square to the longest edge.

    The latter matters for thin facets: their area vector is known only to rounding of the edges,
    which would tilt the normal along the facet.
    """
    normals = np.zeros((offsets.shape[0] - 1, 3))
    for i in range(normals.shape[0]):
        start, end = offsets[i], offsets[i + 1]
        base = vertices[indices[start]]
        area, longest, size = np.zeros(3), np.zeros(3), 0.0
        for h in range(start, end):
            a = vertices[indices[h]] - base
            edge = vertices[indices[h + 1 if h + 1 < end else start]] - base - a
            square = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]
            if square > size:
                longest, size = edge, square
            area[0] += a[1] * edge[2] - a[2] * edge[1]
            area[1] += a[2] * edge[0] - a[0] * edge[2]
            area[2] += a[0] * edge[1] - a[1] * edge[0]
        area -= longest * (np.sum(area * longest) / size)
        normals[i] = area / np.sqrt(np.sum(area * area))
    return normals


@compiled
def arc_of(edge: Floats, h: int) -> Arc:
    """Return row h of the edges of a fan."""
    return edge[h, 0], edge[h, 1], edge[h, 2], edge[h, 3]


@compiled
def signed_height(normals: Floats, i: int, arc: Arc) -> float:
    """Return how much higher the end of an edge is than its origin in direction i."""
    return float(normals[i, 0] * arc[0] + normals[i, 1] * arc[1] + normals[i, 2] * arc[2])


@compiled
def some_edge(face: Ints, n_facets: int) -> Ints:
    """Return a half-edge of each facet."""
    some = np.empty(n_facets, np.int32)
    for h in range(face.shape[0]):
        some[face[h]] = h
    return some


def pair_twins(offsets: Ints, indices: Ints) -> Ints:
    """Return for every half-edge the one that runs the other way."""
    _, after, _ = _cycles(offsets)
    target = indices[after]
    low, high = np.minimum(indices, target), np.maximum(indices, target)
    order = np.lexsort((high, low))
    a, b = order[0::2], order[1::2]
    if len(a) != len(b) or np.any(indices[a] != target[b]) or np.any(indices[b] != target[a]):
        raise InputError("indices", "the facets do not close up: an edge without its reverse")
    twins = np.empty(len(indices), np.int32)
    twins[a], twins[b] = b, a
    return twins


def polytope_from_faces(vertices: Floats, offsets: Ints, indices: Ints) -> Polytope:
    """Return the polytope of these facets (see `Polytope`); every vertex must be used.

    Parameters
    ----------
    vertices : (k, 3) float
        Corners.
    offsets, indices : (m + 1,) and (n,) int
        Facet i has the corners ``indices[offsets[i]:offsets[i + 1]]``, counter-clockwise.
    """
    vertices = np.ascontiguousarray(vertices, dtype=float)
    offsets = np.ascontiguousarray(offsets, dtype=np.int32)
    indices = np.ascontiguousarray(indices, dtype=np.int32)
    if len(vertices) - len(indices) // 2 + len(offsets) - 1 != 2:
        raise InputError("indices", "not the facets of one polytope (V - E + F is not 2)")
    twins = pair_twins(offsets, indices)
    return Polytope(vertices, offsets, indices, facet_normals(vertices, offsets, indices), twins)


def triangles(polytope: Polytope) -> Ints:
    """Return the facets cut into triangles, (t, 3) vertex numbers, counter-clockwise."""
    sizes = np.diff(polytope.offsets)
    facet = np.repeat(np.arange(len(sizes)), sizes - 2)
    start = polytope.offsets[:-1][facet]
    step = np.arange(len(facet)) - np.concatenate([[0], np.cumsum(sizes - 2)])[facet]
    picks = np.column_stack([start, start + step + 1, start + step + 2])
    return np.asarray(polytope.indices[picks], np.int32)
