r"""A triangle clipped by half-planes: its moments, and where it was cut.

Polygons are sums of the signed triangles that their edges span with one point; each is clipped on
its own (I. E. Sutherland, G. W. Hodgman, *Reentrant polygon clipping*, Comm. ACM 17, 1974), so that
holes, pieces and non-convex outlines need nothing special. Every edge of the result knows
the half-plane that made it, -1 if none did.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["Clip", "clip", "moments", "new_clip", "start_triangle"]

Moments = tuple[float, float, float, float, float, float]


class Clip(NamedTuple):
    """Two convex polygons (2, n, 2) with labels of their edges (2, n): before and after a cut."""

    corners: Floats
    labels: Ints


@compiled
def new_clip(planes: int) -> Clip:
    """Return room for a triangle cut by so many half-planes: each adds at most one corner."""
    return Clip(np.empty((2, 2 * planes + 6, 2)), np.empty((2, 2 * planes + 6), np.int32))


@compiled
def start_triangle(room: Clip, x0: float, y0: float, x1: float, y1: float) -> int:
    """Fill the first polygon with the triangle of the origin and two points; return 3."""
    here, labels = room.corners[0], room.labels[0]
    here[0, 0], here[0, 1] = 0.0, 0.0
    here[1, 0], here[1, 1] = x0, y0
    here[2, 0], here[2, 1] = x1, y1
    for i in range(3):
        labels[i] = -1
    return 3


@compiled
def clip(room: Clip, k: int, n: int, normal: Floats, bound: float, label: int) -> int:
    """Cut the polygon in place k, of n corners, by ``normal.r <= bound``; return the corners left.

    The result is in the other place. A corner on the line is inside.
    """
    here, there = room.corners[k], room.corners[1 - k]
    before, after = room.labels[k], room.labels[1 - k]
    left = 0
    if n == 0:
        return 0
    last = normal[0] * here[0, 0] + normal[1] * here[0, 1] - bound
    first = last
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        d, e = last, first
        if j > 0:
            e = normal[0] * here[j, 0] + normal[1] * here[j, 1] - bound
        last = e
        if d <= 0.0:
            there[left, 0], there[left, 1] = here[i, 0], here[i, 1]
            after[left] = before[i]
            left += 1
        if (d <= 0.0) != (e <= 0.0):
            t = d / (d - e)
            there[left, 0] = here[i, 0] + t * (here[j, 0] - here[i, 0])
            there[left, 1] = here[i, 1] + t * (here[j, 1] - here[i, 1])
            after[left] = label if d <= 0.0 else before[i]
            left += 1
    return left


@compiled
def moments(corners: Floats, n: int) -> Moments:
    """Return ``integral (1, x, y, xx, xy, yy) dA`` of a convex polygon of n corners.

    Triangles of area a whose corners add up to s have first moments ``a s / 3`` and second moments
    ``a (sum p p' + s s') / 12``.
    """
    area = mx = my = xx = xy = yy = 0.0
    for i in range(1, n - 1):
        x0, y0 = corners[0, 0], corners[0, 1]
        x1, y1 = corners[i, 0], corners[i, 1]
        x2, y2 = corners[i + 1, 0], corners[i + 1, 1]
        a = 0.5 * ((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0))
        x, y = x0 + x1 + x2, y0 + y1 + y2
        area += a
        mx += a * x / 3.0
        my += a * y / 3.0
        xx += a * (x0 * x0 + x1 * x1 + x2 * x2 + x * x) / 12.0
        xy += a * (x0 * y0 + x1 * y1 + x2 * y2 + x * y) / 12.0
        yy += a * (y0 * y0 + y1 * y1 + y2 * y2 + y * y) / 12.0
    return area, mx, my, xx, xy, yy
