"""Merge the coplanar patches of a closed convex surface into its facets."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Bools, Floats, Ints, compiled

__all__ = ["Mesh", "merge_faces", "number_vertices"]


class Mesh(NamedTuple):
    """Half-edges of a closed surface: patch, next and previous in the patch, and twin."""

    face: Ints
    next: Ints
    previous: Ints
    twin: Ints


@compiled
def number_vertices(mesh: Mesh) -> tuple[Ints, int]:
    """Return the vertex from which each half-edge starts, and how many vertices there are."""
    previous, twin, n = mesh.previous, mesh.twin, mesh.face.shape[0]
    vertex = np.full(n, -1, np.int32)
    count = 0
    for start in range(n):
        if vertex[start] >= 0:
            continue
        h = start
        while vertex[h] < 0:
            vertex[h] = count
            h = twin[previous[h]]
        count += 1
    return vertex, count


@compiled
def _on_outline(mesh: Mesh, label: Ints) -> Bools:
    """Tell for each half-edge whether the patches on its sides belong to different facets."""
    face, twin = mesh.face, mesh.twin
    outline = np.empty(face.shape[0], np.bool_)
    for h in range(face.shape[0]):
        outline[h] = label[face[h]] != label[face[twin[h]]]
    return outline


@compiled
def _follow(after: Ints, twin: Ints, outline: Bools, h: int) -> int:
    """Return the half-edge after h on the outline of its facet."""
    h = after[h]
    while not outline[h]:
        h = after[twin[h]]
    return h


@compiled
def _is_straight(vertices: Floats, a: int, b: int, c: int, angle: float, noise: float) -> bool:
    """Whether b lies on the way from a to c."""
    u, v = vertices[b] - vertices[a], vertices[c] - vertices[b]
    x, y, z = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
    lu, lv = np.sqrt(np.sum(u * u)), np.sqrt(np.sum(v * v))
    return bool(np.sqrt(x * x + y * y + z * z) <= angle * lu * lv + noise * (lu + lv))


@compiled
def _corners(
    mesh: Mesh, outline: Bools, vertex: Ints, vertices: Floats, angle: float, noise: float
) -> Bools:
    """Tell which vertices stay: those where three facets meet; in a flat body, where it turns."""
    _, after, _, twin = mesh
    n = twin.shape[0]
    degree = np.zeros(vertices.shape[0], np.int32)
    corner = np.zeros(vertices.shape[0], np.bool_)
    flat = True
    for h in range(n):
        if outline[h]:
            degree[vertex[h]] += 1
            flat = flat and degree[vertex[h]] < 3
    for h in range(n):
        if flat and outline[h]:
            k = _follow(after, twin, outline, h)
            b, c = vertex[k], vertex[after[k]]
            corner[b] = not _is_straight(vertices, vertex[h], b, c, angle, noise)
        elif outline[h]:
            corner[vertex[h]] = degree[vertex[h]] > 2
    return corner


@compiled
def merge_faces(
    mesh: Mesh, vertex: Ints, vertices: Floats, label: Ints, angle: float, noise: float
) -> tuple[Floats, Ints, Ints, Ints, Ints, bool]:
    """Merge patches of equal label; drop vertices inside facets and on straight edges.

    Parameters
    ----------
    mesh : Mesh
        Half-edges of the patches.
    vertex : (n,) int
        Vertex where each half-edge starts.
    vertices : (k, 3) float
        Their coordinates.
    label : (m,) int
        Facet to which each patch belongs.
    angle, noise : float
        Sine and height below which the outline of a flat body is straight.

    Returns
    -------
    vertices, offsets, indices, labels, twins
        The facets as in `Polytope`, with the label of each.
    sound : bool
        Whether the facets close up to a sphere (Euler's formula) and have an area.
    """
    face, after, _, twin = mesh
    n = face.shape[0]
    outline = _on_outline(mesh, label)
    corner = _corners(mesh, outline, vertex, vertices, angle, noise)
    new_vertex = np.full(vertices.shape[0], -1, np.int32)
    new_edge, last = np.full(n, -1, np.int32), np.empty(n, np.int32)
    indices, offsets, labels = (
        np.empty(n, np.int32),
        np.zeros(n + 1, np.int32),
        np.empty(n, np.int32),
    )
    points = np.empty_like(vertices)
    n_edges = n_vertices = n_facets = 0
    sound = True
    for start in range(n):
        if not (outline[start] and corner[vertex[start]]) or new_edge[start] >= 0:
            continue
        h = start
        while new_edge[h] < 0:
            v = vertex[h]
            if new_vertex[v] < 0:
                new_vertex[v] = n_vertices
                points[n_vertices] = vertices[v]
                n_vertices += 1
            indices[n_edges], new_edge[h] = new_vertex[v], n_edges
            k = h
            h = _follow(after, twin, outline, h)
            while not corner[vertex[h]]:
                k = h
                h = _follow(after, twin, outline, h)
            last[n_edges] = k
            n_edges += 1
        labels[n_facets] = label[face[start]]
        n_facets += 1
        offsets[n_facets] = n_edges
        sound = sound and n_edges - offsets[n_facets - 1] > 2
    sound = sound and n_vertices - n_edges // 2 + n_facets == 2
    twins = np.empty(n_edges, np.int32)
    for k in range(n_edges):
        twins[k] = new_edge[twin[last[k]]]
        sound = sound and twins[k] >= 0
    return (
        points[:n_vertices].copy(),
        offsets[: n_facets + 1].copy(),
        indices[:n_edges].copy(),
        labels[:n_facets].copy(),
        twins,
        sound,
    )
