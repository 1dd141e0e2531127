"""The active tips under a moving part, kept up to date at the cost of what changes.

A tip has a small width b. Its share of the load rises linearly from 0 to 1 while the outline
crosses it: ``share = clip(1/2 + d/b, 0, 1)`` with d the signed distance to the outline (positive
inside). This is the continuous form of "a contact under the outline carries any share between
none and its own", so forces stay continuous while the part moves.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled, inlined
from limitsurf.kernels.lattice import (
    Lattice,
    distance_to_edge,
    first_site,
    last_site,
    reach_in_row,
)
from limitsurf.kernels.row_spans import Spans, row_spans, span_sites
from limitsurf.kernels.tip_list import (
    AGE,
    BORDER,
    COUNT,
    Tips,
    add_tip,
    add_up,
    make_room,
    remove_tip,
    set_share,
    share_of,
)

__all__ = ["move_tips"]

_FRESH = 64  # moves after which sums are added up anew, for rounding
_FAR = 0.25  # the anchor is left behind by that much of the part's reach
_MOST = float(np.nextafter(1.0, 0.0))  # a partial share is less than 1: it is listed once


@compiled
def move_tips(lattice: Lattice, edges: Floats, x: float, y: float, tips: Tips, old: Spans) -> Spans:
    """Bring the list up to date for a part with its reference point at (x, y); return its spans.

    Parameters
    ----------
    lattice : Lattice
        The sites.
    edges : (E, 4) float
        Directed edges ``x0, y0, x1, y1`` of the part in array coordinates.
    x, y : float
        Where the part is.
    tips : Tips
        The list; whatever is in it must stem from `old`.
    old : Spans
        What the last call returned, or `no_spans`.
    """
    rows, columns = lattice.active.shape
    new = row_spans(edges, lattice.origin_x, lattice.origin_y, lattice.pitch, rows, columns)
    if not math.hypot(x - tips.anchor[0], y - tips.anchor[1]) < _FAR * tips.reach:
        _list_anew(lattice, x, y, tips, new)
    else:
        _drop_shares(lattice, tips)
        _change(old, new, lattice, tips, False)
        _change(new, old, lattice, tips, True)
    if lattice.tip_width > 0.0:
        _share_along_outline(edges, lattice, tips)
    tips.numbers[AGE] += 1
    if tips.numbers[AGE] >= _FRESH:
        add_up(lattice, tips)
    return new


@compiled
def _list_anew(lattice: Lattice, x: float, y: float, tips: Tips, spans: Spans) -> None:
    """List all tips about a new anchor."""
    for k in range(tips.numbers[COUNT]):
        tips.slot[tips.rows[k], tips.columns[k]] = -1
    sites = span_sites(spans)
    tips.anchor[0], tips.anchor[1] = x, y
    tips.sums[:] = 0.0
    tips.numbers[:] = 0
    running = 0
    for i in range(sites.shape[0]):
        running += 1 if lattice.active[sites[i, 0], sites[i, 1]] else 0
    make_room(tips, running)
    for i in range(sites.shape[0]):
        if lattice.active[sites[i, 0], sites[i, 1]]:
            add_tip(lattice, tips, sites[i, 0], sites[i, 1], 1.0)


@inlined
def _change(a: Spans, b: Spans, lattice: Lattice, tips: Tips, enter: bool) -> None:
    """Let the active sites of a that are not in b enter the list, or leave it."""
    active, rows, shift = lattice.active, b.offsets.shape[0] - 1, a.first_row - b.first_row
    starts, others = a.offsets, b.offsets
    a_left, a_right, b_left, b_right = a.left, a.right, b.left, b.right
    for k in range(starts.shape[0] - 1):
        j = stop = 0
        if 0 <= k + shift < rows:
            j, stop = others[k + shift], others[k + shift + 1]
        first = starts[k]
        single = starts[k + 1] == first + 1 and stop == j + 1
        if single and a_left[first] == b_left[j] and a_right[first] == b_right[j]:
            continue
        for i in range(first, starts[k + 1]):
            c, end = a_left[i], a_right[i]
            while c < end:
                while j < stop and b_right[j] <= c:
                    j += 1
                free = end if j == stop else min(max(b_left[j], c), end)
                for column in range(c, free):
                    if active[a.first_row + k, column]:
                        _enter_or_leave(lattice, tips, a.first_row + k, column, enter)
                c = end if j == stop else min(max(b_right[j], free), end)


@inlined
def _enter_or_leave(lattice: Lattice, tips: Tips, r: int, c: int, enter: bool) -> None:
    if enter:
        add_tip(lattice, tips, r, c, 1.0)
    else:
        remove_tip(lattice, tips, r, c)


@inlined
def _drop_shares(lattice: Lattice, tips: Tips) -> None:
    """Undo the partial shares at the outline."""
    for i in range(tips.numbers[BORDER]):
        r, c = tips.border[i, 0], tips.border[i, 1]
        if tips.border[i, 2] > 0:
            remove_tip(lattice, tips, r, c)
        else:
            set_share(lattice, tips, tips.slot[r, c], 1.0)
    tips.numbers[BORDER] = 0


@inlined
def _share_along_outline(edges: Floats, lattice: Lattice, tips: Tips) -> None:
    """Give the tips within b/2 of the outline their partial share."""
    rows, columns = lattice.active.shape
    half, active = 0.5 * lattice.tip_width, lattice.active
    x0, y0, pitch = lattice.origin_x, lattice.origin_y, lattice.pitch
    per_pitch = 1.0 / pitch
    for i in range(edges.shape[0]):
        edge = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        low, high = min(edge[1], edge[3]) - half, max(edge[1], edge[3]) + half
        slope = (edge[2] - edge[0]) / (edge[3] - edge[1]) if edge[1] != edge[3] else 0.0
        for r in range(first_site(low, y0, per_pitch), last_site(high, y0, per_pitch, rows) + 1):
            left, right = reach_in_row(edge, slope, y0 + pitch * r, half)
            c = first_site(left, x0, per_pitch)
            while c < columns and x0 + pitch * c <= right:
                if active[r, c]:
                    distance = distance_to_edge(x0 + pitch * c, y0 + pitch * r, edge)
                    if distance < half:
                        _share_tip(lattice, tips, r, c, distance / lattice.tip_width)
                c += 1


@inlined
def _share_tip(lattice: Lattice, tips: Tips, r: int, c: int, distance: float) -> None:
    """Set the share of a tip at a distance, in tip widths, from an edge: the nearest counts."""
    k = tips.slot[r, c]
    share = share_of(tips, k) if k >= 0 else 0.0
    if k < 0 or share == 1.0:
        i = tips.numbers[BORDER]
        tips.border[i, 0], tips.border[i, 1], tips.border[i, 2] = r, c, 1 if k < 0 else 0
        tips.numbers[BORDER] = i + 1
    if k < 0:
        add_tip(lattice, tips, r, c, 0.5 - distance)
    elif share >= 0.5:  # inside
        set_share(lattice, tips, k, min(share, 0.5 + distance, _MOST))
    else:
        set_share(lattice, tips, k, max(share, 0.5 - distance))
