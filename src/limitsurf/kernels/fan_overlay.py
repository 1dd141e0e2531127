r"""Overlay of two normal fans: the combinatorics of a Minkowski sum, in time of its size.

The normal fan of P + Q is the overlay of the fans of P and Q (Guibas and Seidel, "Computing
convolutions by reciprocal search", Discrete Comput. Geom. 2, 1987). Its points are the facets:
a facet of P that lies in the cell of a vertex of Q, the reverse, or a crossing of the arcs of an
edge e of P and f of Q, which is a parallelogram. Every arc of P is walked through the cells of Q,
so that the work is one search around a cell for each arc and each crossing.

All decisions come from signs of heights, ``n . f`` and ``m . e`` with facet normals n of P and m
of Q. With L, R the facets left and right of e and A, B those of f, the arcs cross just where

.. math:: s(L, f) = -s(R, f) = -s(A, e) = s(B, e) .

A height below rounding is taken as zero, and zeros get the sign they would have after an
infinitesimal rotation of Q about `spin`: :math:`n\cdot(w \times f) = w\cdot(f \times n)`. So
there are no special cases: facets that are coplanar come out in pieces, to be merged afterwards.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.fan_links import link_p, link_q
from limitsurf.kernels.merge_faces import Mesh
from limitsurf.kernels.normal_fan import Arc, Fan, arc_of, signed_height, some_edge

__all__ = ["Axis", "Overlay", "lay_over"]

Axis = tuple[float, float, float]


class Overlay(NamedTuple):
    """Patches of the sum: facets of P, facets of Q, and one parallelogram for each crossing.

    Row c of `crossings` is ``(e, f)``; the origin of half-edge h of `mesh` is the sum of vertices
    ``p_vertex[h]`` and ``q_vertex[h]``.
    """

    mesh: Mesh
    crossings: Ints
    p_vertex: Ints
    q_vertex: Ints


@compiled
def _rises(normals: Floats, i: int, arc: Arc, spin: Axis) -> bool:
    """Whether an edge rises in direction i of the other polytope; `spin` turns the edge."""
    height = signed_height(normals, i, arc)
    if height > arc[3]:
        return True
    if height < -arc[3]:
        return False
    (x, y, z, _), nx, ny, nz = arc, normals[i, 0], normals[i, 1], normals[i, 2]
    turn = spin[0] * (y * nz - z * ny) + spin[1] * (z * nx - x * nz) + spin[2] * (x * ny - y * nx)
    return bool(turn > 0.0)


@compiled
def _climb(normals: Floats, facet: int, q: Fan, spin: Axis) -> int:
    """Return the vertex of Q that is extreme in the direction of a facet of P; -1 on failure."""
    vertex = 0
    for _ in range(q.first.shape[0]):
        top = True
        for k in range(q.first[vertex], q.first[vertex + 1]):
            f = q.around[k]
            if _rises(normals, facet, arc_of(q.edge, f), spin):
                vertex = q.origin[q.twin[f]]
                top = False
                break
        if top:
            return vertex
    return -1


@compiled
def _exit(arc: Arc, normals: Floats, ring: Ints, start: int, end: int, back: Axis) -> int:
    """Return where, among the edges of a vertex of Q, the circle of an arc leaves the cell.

    `ring` holds the facets to the left of these edges. They lie left of the circle (the edge of P
    rises) in one run and right of it in another. Strides that halve find one of each kind,
    bisection the change between them.
    """
    n = end - start
    left0 = _rises(normals, ring[start], arc, back)
    other = 0
    step = n
    while step > 1 and other == 0:
        step = (step + 1) // 2
        for k in range(step, n, step):
            if _rises(normals, ring[start + k], arc, back) != left0:
                other = k
                break
    if other == 0:
        return -1
    low, high = (other, n) if left0 else (0, other)  # from right to left
    while high - low > 1:
        middle = (low + high) // 2
        if _rises(normals, ring[start + middle], arc, back):
            high = middle
        else:
            low = middle
    return start + (high if high < n else 0)


@compiled
def _trace(p: Fan, q: Fan, spin: Axis) -> tuple[Ints, Ints, bool]:
    """Walk all arcs of P through Q; return crossings ``(e, f)`` and the cells of P's facets.

    An arc runs from the facet on the left, whose cell is known, to the right one. If the cell of
    that is known too, it must be the one where the walk ends, else the trace has failed.
    """
    edge, face, after, twin, normals = p.edge, p.face, p.next, p.twin, p.normals
    q_edge, q_normals, q_twin, q_origin = q.edge, q.normals, q.twin, q.origin
    first, around, ring, back = q.first, q.around, q.ring, (-spin[0], -spin[1], -spin[2])
    n, walked = normals.shape[0], np.zeros(face.shape[0], np.bool_)
    crossings, count = np.empty((face.shape[0] + q_twin.shape[0], 2), np.int32), 0
    cell, some = np.full(n, -1, np.int32), some_edge(face, n)
    stack, depth = np.zeros(n, np.int32), 1
    cell[0] = _climb(normals, 0, q, spin)
    while depth > 0 and cell[0] >= 0:
        depth -= 1
        e = some[stack[depth]]
        while not walked[e]:
            walked[e] = True
            if not walked[twin[e]]:
                arc, vertex, right = arc_of(edge, e), cell[face[e]], face[twin[e]]
                for steps in range(first.shape[0] + 1):
                    k = _exit(arc, q_normals, ring, first[vertex], first[vertex + 1], back)
                    if k < 0 or steps == first.shape[0]:
                        return crossings[:0], cell, False
                    f = around[k]
                    if not _rises(normals, right, arc_of(q_edge, f), spin):
                        break
                    if count == crossings.shape[0]:
                        crossings = np.concatenate((crossings, crossings))
                    crossings[count, 0], crossings[count, 1] = e, f
                    count += 1
                    vertex = q_origin[q_twin[f]]
                if cell[right] < 0:
                    cell[right], stack[depth] = vertex, right
                    depth += 1
                elif cell[right] != vertex:
                    return crossings[:0], cell, False
            e = after[e]
    return crossings[:count], cell, cell[0] >= 0


@compiled
def _lay_facets(
    fan: Fan, cell: Ints, mesh: Mesh, at: tuple[int, int], own: Ints, other: Ints
) -> None:
    """Copy the facets of one summand to the patches from number `at`: half-edge, facet."""
    face, after, before, origin = fan.face, fan.next, fan.previous, fan.origin
    to_face, to_after, to_before, h0, i0 = mesh.face, mesh.next, mesh.previous, at[0], at[1]
    for h in range(face.shape[0]):
        to_face[h0 + h], to_after[h0 + h], to_before[h0 + h] = (
            i0 + face[h],
            h0 + after[h],
            h0 + before[h],
        )
        own[h0 + h], other[h0 + h] = origin[h], cell[face[h]]


@compiled
def _lay_crossings(p: Fan, q: Fan, overlay: Overlay, at: tuple[int, int]) -> None:
    """Fill in the parallelograms, from half-edge and facet number `at`; see `link_p`."""
    p_origin, p_after, q_origin, q_after = p.origin, p.next, q.origin, q.next
    face, after, before, _ = overlay.mesh
    crossings, p_vertex, q_vertex = overlay.crossings, overlay.p_vertex, overlay.q_vertex
    for c in range(crossings.shape[0]):
        e, f = crossings[c, 0], crossings[c, 1]
        p1, p2, q1, q2 = p_origin[e], p_origin[p_after[e]], q_origin[f], q_origin[q_after[f]]
        h = at[0] + 4 * c
        for k in range(4):
            face[h + k] = at[1] + c
            after[h + k], before[h + k] = h + (k + 1) % 4, h + (k + 3) % 4
            p_vertex[h + k] = p1 if k < 2 else p2
            q_vertex[h + k] = q2 if k in (1, 2) else q1


@compiled
def lay_over(p: Fan, q: Fan, spin: Axis) -> tuple[Overlay, bool]:
    """Return the overlay of two fans and whether all parts of it agree.

    Parameters
    ----------
    p, q : Fan
        Normal fans of the summands, neither of them a point.
    spin : Axis
        Axis of the infinitesimal rotation of Q that decides ties.
    """
    crossings, p_cell, agree = _trace(p, q, spin)
    a, b = p.origin.shape[0], q.origin.shape[0]
    n, faces = a + b + 4 * crossings.shape[0], p.normals.shape[0]
    mesh = Mesh(
        np.empty(n, np.int32), np.empty(n, np.int32), np.empty(n, np.int32), np.empty(n, np.int32)
    )
    overlay = Overlay(mesh, crossings, np.empty(n, np.int32), np.empty(n, np.int32))
    mesh.twin[:a], mesh.twin[a : a + b] = p.twin, a + q.twin
    if agree:
        link_p(p.twin, crossings, a + b, mesh.twin)
        q_cell, agree = link_q(p, q, crossings, (a, a + b), mesh.twin)
        _lay_facets(p, p_cell, mesh, (0, 0), overlay.p_vertex, overlay.q_vertex)
        _lay_facets(q, q_cell, mesh, (a, faces), overlay.q_vertex, overlay.p_vertex)
        _lay_crossings(p, q, overlay, (a + b, faces + q.normals.shape[0]))
    return overlay, agree
