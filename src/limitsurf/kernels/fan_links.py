"""Join the patches of a Minkowski sum along the arcs of the overlay (`fan_overlay`)."""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Ints, compiled
from limitsurf.kernels.normal_fan import Fan, some_edge

__all__ = ["link_p", "link_q"]


@compiled
def _join(twin: Ints, a: int, b: int) -> None:
    twin[a], twin[b] = b, a


@compiled
def link_p(p_twin: Ints, crossings: Ints, base: int, twin: Ints) -> None:
    """Join the patches along each arc of P: facet on the left, crossings in order, right facet.

    Corners of parallelogram c: p1 q1, p1 q2, p2 q2, p2 q1; its sides are f, e, -f, -e.
    """
    n = crossings.shape[0]
    c = 0
    while c < n:
        e = crossings[c, 0]
        last = e
        while c < n and crossings[c, 0] == e:
            side = base + 4 * c
            _join(twin, last, side + 3)
            last = side + 1
            c += 1
        _join(twin, last, p_twin[e])


@compiled
def _passages(p: Fan, q_twin: Ints, crossings: Ints, base: int) -> tuple[Ints, Ints]:
    """Return, for each crossing, its passage along the arc of Q; and lists of them for each edge.

    A passage is: edge g of Q, vertex of P whose cell the arc comes from and that where it goes,
    the sides of the parallelogram there, and the next passage of g. The list starts at
    ``head[g]``; g is the half-edge of the lower number.
    """
    p_origin, after = p.origin, p.next
    table, head = (
        np.empty((crossings.shape[0], 6), np.int32),
        np.full(q_twin.shape[0], -1, np.int32),
    )
    for c in range(crossings.shape[0]):
        e, f = crossings[c, 0], crossings[c, 1]
        g, flip = min(f, q_twin[f]), 2 if f < q_twin[f] else 0
        p1, p2 = p_origin[e], p_origin[after[e]]
        table[c, 0], table[c, 5], head[g] = g, head[g], c
        table[c, 1], table[c, 2] = (p2, p1) if flip else (p1, p2)
        table[c, 3], table[c, 4] = base + 4 * c + flip, base + 4 * c + 2 - flip
    return table, head


@compiled
def _chain(
    table: Ints, leaver: Ints, reached: Ints, c: int, ends: tuple[int, int], twin: Ints
) -> tuple[int, int]:
    """Join the patches along the arc of an edge of Q, from half-edge to half-edge.

    The passages come in no order, but each leads from one vertex of P to another: `leaver` of a
    vertex is the one that leads away from it, `reached` tells to where some passage leads.
    Returns the vertices where the chain starts and ends, -1 if it is broken.
    """
    g, left, begin = table[c, 0], 0, c
    while c >= 0:
        leaver[table[c, 1]], reached[table[c, 2]] = c, g
        left += 1
        c = table[c, 5]
    c = begin
    while c >= 0 and reached[table[c, 1]] == g:
        c = table[c, 5]
    start, vertex, last = table[max(c, 0), 1], 0, ends[0]
    while left > 0:
        if c < 0 or table[c, 0] != g:
            return -1, -1
        _join(twin, last, table[c, 3])
        last, vertex = table[c, 4], table[c, 2]
        left -= 1
        c = leaver[vertex]
    _join(twin, last, ends[1])
    return start, vertex


@compiled
def link_q(
    p: Fan, q: Fan, crossings: Ints, bases: tuple[int, int], twin: Ints
) -> tuple[Ints, bool]:
    """Join the patches along each arc of Q; return the cells of Q's facets in P.

    Facets whose arcs are not crossed get the cell of their neighbours.
    """
    face, q_twin, n_vertices = q.face, q.twin, p.first.shape[0] - 1
    cell = np.full(q.normals.shape[0], -1, np.int32)
    table, head = _passages(p, q_twin, crossings, bases[1])
    leaver, reached = np.full(n_vertices, -1, np.int32), np.full(n_vertices, -1, np.int32)
    for g in range(head.shape[0]):
        if head[g] < 0:
            continue
        ends = (bases[0] + g, bases[0] + q_twin[g])
        start, end = _chain(table, leaver, reached, head[g], ends, twin)
        a, b = face[g], face[q_twin[g]]
        if start < 0 or (cell[a] >= 0 and cell[a] != start) or (cell[b] >= 0 and cell[b] != end):
            return cell, False
        cell[a], cell[b] = start, end
    return cell, _flood(face, q.next, q_twin, head, cell)


@compiled
def _flood(face: Ints, after: Ints, twin: Ints, head: Ints, cell: Ints) -> bool:
    """Give facets without a cell that of a neighbour across an arc that nothing crosses."""
    n = cell.shape[0]
    stack, some = np.empty(n, np.int32), some_edge(face, n)
    depth = 0
    for i in range(n):
        if cell[i] >= 0:
            stack[depth] = i
            depth += 1
    done = depth
    while depth > 0:
        depth -= 1
        here = stack[depth]
        h = some[here]
        while True:
            i = face[twin[h]]
            if cell[i] < 0 and head[min(h, twin[h])] < 0:
                cell[i], stack[depth] = cell[here], i
                depth += 1
                done += 1
            h = after[h]
            if h == some[here]:
                break
    return bool(done == n)
