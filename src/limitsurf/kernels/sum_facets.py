"""Which patches of a Minkowski sum form one facet, and a certificate for the facets."""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.fan_overlay import Overlay
from limitsurf.kernels.normal_fan import Arc, Fan, Polytope, arc_of, signed_height, some_edge

__all__ = ["attach_slivers", "label_patches", "violation"]

_THIN = 1e-5  # area over squared length of facets whose neighbours say little about their normal


@compiled
def _parallelogram(e: Arc, f: Arc, normal: Floats) -> float:
    """Fill in the unit normal ``f x e``, square to e even if thin; return the area."""
    x, y, z = f[1] * e[2] - f[2] * e[1], f[2] * e[0] - f[0] * e[2], f[0] * e[1] - f[1] * e[0]
    area = math.sqrt(x * x + y * y + z * z)
    if area == 0.0:
        return 0.0
    x, y, z = x / area, y / area, z / area
    slope = (x * e[0] + y * e[1] + z * e[2]) / (e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
    x, y, z = x - slope * e[0], y - slope * e[1], z - slope * e[2]
    norm = math.sqrt(x * x + y * y + z * z)
    normal[0], normal[1], normal[2] = x / norm, y / norm, z / norm
    return area


@compiled
def _root(parent: Ints, i: int) -> int:
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@compiled
def _tilt(normals: Floats, real: Ints, i: int, own: int, arc: Arc) -> float:
    """Return the angle of an edge to the plane of facet i, in parts of its level.

    Infinite unless it counts as zero and patch `own` looks the same way.
    """
    height = abs(signed_height(normals, i, arc))
    same = 0.0
    for k in range(3):
        same += normals[i, k] * normals[own, k]
    return height / arc[3] if height <= arc[3] and same > 0.0 and real[i] == 1 else math.inf


@compiled
def _unite_parallel(
    normals: Floats, facets: Ints, tilts: Floats, blur: float, parent: Ints
) -> None:
    """Unite those of the first two facets and of the last two that are in one plane."""
    for k in range(2):
        for j in range(2, 4):
            gap = 0.0
            for x in range(3):
                gap += (normals[facets[k], x] - normals[facets[j], x]) ** 2
            if max(tilts[k], tilts[j]) < math.inf and gap <= blur * blur:
                parent[_root(parent, facets[j])] = _root(parent, facets[k])


@compiled
def _own_labels(p: Fan, q: Fan, n: int) -> tuple[Ints, Ints, Floats]:
    """Return the labels, reality and normals of the facets, with room for n patches."""
    a, b = p.normals.shape[0], q.normals.shape[0]
    label, real, normals = np.arange(n).astype(np.int32), np.ones(n, np.int32), np.zeros((n, 3))
    normals[:a], normals[a : a + b] = p.normals, q.normals
    real[:a], real[a : a + b] = p.real, q.real
    for i in range(a + b):
        if real[i] == 0:
            label[i] = -1
    return label, real, normals


@compiled
def label_patches(p: Fan, q: Fan, crossings: Ints) -> tuple[Ints, Floats]:
    """Return the facet of each patch, -1 for those without area, and the normals of all patches.

    A parallelogram belongs to a facet at one of its edges if the other edge is level with that.
    """
    e_edge, e_length, e_face, e_twin = p.edge, p.length, p.face, p.twin
    f_edge, f_length, f_face, f_twin = q.edge, q.length, q.face, q.twin
    a = p.normals.shape[0]
    first = a + q.normals.shape[0]
    n = first + crossings.shape[0]
    label, real, normals = _own_labels(p, q, n)
    parent, facets, tilts = np.arange(n).astype(np.int32), np.empty(4, np.int32), np.empty(4)
    for c in range(crossings.shape[0]):
        e, f = crossings[c, 0], crossings[c, 1]
        u, v = arc_of(e_edge, e), arc_of(f_edge, f)
        area = _parallelogram(u, v, normals[first + c])
        if area <= u[3] * f_length[f] + v[3] * e_length[e]:
            label[first + c] = -1
            continue
        facets[0], facets[1] = e_face[e], e_face[e_twin[e]]
        facets[2], facets[3] = a + f_face[f], a + f_face[f_twin[f]]
        for k in range(4):
            tilts[k] = _tilt(normals, real, facets[k], first + c, v if k < 2 else u)
        best = np.argmin(tilts)
        if tilts[best] < math.inf:
            label[first + c] = facets[best]
            blur = u[3] / e_length[e] + v[3] / f_length[f]
            _unite_parallel(normals, facets, tilts, blur, parent)
    for i in range(n):
        if label[i] >= 0:
            label[i] = _root(parent, label[i])
    return label, normals


@compiled
def attach_slivers(face: Ints, twin: Ints, label: Ints) -> None:
    """Give patches without area the label of a neighbour that has one."""
    changed = True
    while changed:
        changed = False
        for h in range(face.shape[0]):
            i = face[h]
            if label[i] < 0 and label[face[twin[h]]] >= 0:
                label[i] = label[face[twin[h]]]
                changed = True


@compiled
def _rise(normals: Floats, i: int, edge: Floats, around: Ints, start: int, end: int) -> float:
    """Return how far the neighbours of a vertex lie above it in direction i."""
    rise = 0.0
    for k in range(start, end):
        rise = max(rise, signed_height(normals, i, arc_of(edge, around[k])))
    return rise


@compiled
def _far_rise(normals: Floats, i: int, vertices: Floats, v: int) -> float:
    """Return how far any vertex lies above v in direction i."""
    rise = 0.0
    for k in range(vertices.shape[0]):
        height = 0.0
        for x in range(3):
            height += normals[i, x] * (vertices[k, x] - vertices[v, x])
        rise = max(rise, height)
    return rise


@compiled
def _is_sliver(total: Polytope, i: int) -> bool:
    """Whether facet i is so thin that its normal may be far from those of its neighbours."""
    vertices, offsets, indices, normals, _ = total
    start, area, longest = offsets[i], 0.0, 0.0
    o = indices[start]
    for k in range(start + 1, offsets[i + 1] - 1):
        p, q = indices[k], indices[k + 1]
        x = vertices[p, 0] - vertices[o, 0]
        y = vertices[p, 1] - vertices[o, 1]
        z = vertices[p, 2] - vertices[o, 2]
        u = vertices[q, 0] - vertices[o, 0]
        v = vertices[q, 1] - vertices[o, 1]
        w = vertices[q, 2] - vertices[o, 2]
        area += normals[i, 0] * (y * w - z * v)
        area += normals[i, 1] * (z * u - x * w) + normals[i, 2] * (x * v - y * u)
        longest = max(longest, x * x + y * y + z * z, u * u + v * v + w * w)
    return area < _THIN * longest


@compiled
def violation(
    p: tuple[Floats, Fan],
    q: tuple[Floats, Fan],
    overlay: Overlay,
    points: Floats,
    vertex: Ints,
    total: Polytope,
    labels: Ints,
) -> float:
    """Return by how much the facets of the sum fail to support it: a certificate.

    The vertices are sums of vertices. If the two vertices that make up a point (of a patch) are
    extreme in the direction of a facet, and the facet's corners are as high as that point, the sum
    lies below its plane; then the surface bounds the sum, unless it is thin (`thin_sum`).

    Parameters
    ----------
    p, q : (k, 3) float and Fan
        Vertices and fans of the summands.
    overlay, points, vertex
        Patches, their vertices, and the one from which each half-edge starts.
    total, labels
        The sum, and the patch after which each of its facets is named.
    """
    _, offsets, indices, normals, _ = total
    some = some_edge(overlay.mesh.face, overlay.mesh.face.max() + 1)
    p_of, q_of, vertices = overlay.p_vertex, overlay.q_vertex, total.vertices
    (p_vertices, p_fan), (q_vertices, q_fan) = p, q
    p_edge, p_first, p_around = p_fan.edge, p_fan.first, p_fan.around
    q_edge, q_first, q_around = q_fan.edge, q_fan.first, q_fan.around
    worst = 0.0
    for i in range(labels.shape[0]):
        h = some[labels[i]]
        v, w, base = p_of[h], q_of[h], vertex[h]
        if _is_sliver(total, i):
            rise = _far_rise(normals, i, p_vertices, v) + _far_rise(normals, i, q_vertices, w)
        else:
            rise = _rise(normals, i, p_edge, p_around, p_first[v], p_first[v + 1])
            rise += _rise(normals, i, q_edge, q_around, q_first[w], q_first[w + 1])
        for k in range(offsets[i], offsets[i + 1]):
            height = 0.0
            for x in range(3):
                height += normals[i, x] * (vertices[indices[k], x] - points[base, x])
            worst = max(worst, abs(rise - height))
    return worst
