r"""A triangle clipped by half-planes: its moments, and where it was cut.

Polygons are sums of the signed triangles that their edges span with one point; each is clipped on
its own (I. E. Sutherland, G. W. Hodgman, *Reentrant polygon clipping*, Comm. ACM 17, 1974), so that
holes, pieces and non-convex outlines need nothing special. Every edge of the result knows
the half-plane that made it, -1 if none did.

Two polygons are kept, before and after a cut: corners (2, n, 2) and labels of edges (2, n).
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["Moments", "clip", "moments", "new_clip", "start_triangle", "triangle"]

#: ``integral (1, x, y, xx, xy, yy) dA``
Moments = tuple[float, float, float, float, float, float]


@compiled
def new_clip(planes: int) -> tuple[Floats, Ints]:
    """Return room for a triangle cut by so many half-planes: each adds at most one corner."""
    return np.empty((2, planes + 4, 2)), np.empty((2, planes + 4), np.int32)


@compiled
def start_triangle(
    corners: Floats, labels: Ints, x0: float, y0: float, x1: float, y1: float
) -> None:
    """Fill the first polygon with the triangle of the origin and two points."""
    corners[0, 0, 0], corners[0, 0, 1] = 0.0, 0.0
    corners[0, 1, 0], corners[0, 1, 1] = x0, y0
    corners[0, 2, 0], corners[0, 2, 1] = x1, y1
    labels[0, 0], labels[0, 1], labels[0, 2] = -1, -1, -1


@compiled
def clip(
    corners: Floats, labels: Ints, k: int, n: int, nx: float, ny: float, bound: float, label: int
) -> int:
    """Cut the polygon in place k, of n corners, by ``nx x + ny y <= bound``; return those left.

    The result is in the other place. A corner on the line is inside.
    """
    if n == 0:
        return 0
    to, left = 1 - k, 0
    first = nx * corners[k, 0, 0] + ny * corners[k, 0, 1] - bound
    e = first
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        x, y, d = corners[k, i, 0], corners[k, i, 1], e
        e = nx * corners[k, j, 0] + ny * corners[k, j, 1] - bound if j > 0 else first
        if d <= 0.0:
            corners[to, left, 0], corners[to, left, 1] = x, y
            labels[to, left] = labels[k, i]
            left += 1
        if (d <= 0.0) != (e <= 0.0):
            t = d / (d - e)
            corners[to, left, 0] = x + t * (corners[k, j, 0] - x)
            corners[to, left, 1] = y + t * (corners[k, j, 1] - y)
            labels[to, left] = label if d <= 0.0 else labels[k, i]
            left += 1
    return left


@compiled
def triangle(x0: float, y0: float, x1: float, y1: float) -> Moments:
    """Return the moments of the triangle of the origin and two points; see `moments`."""
    a, x, y = 0.5 * (x0 * y1 - x1 * y0), x0 + x1, y0 + y1
    return (
        a,
        a * x / 3.0,
        a * y / 3.0,
        a * (x0 * x0 + x1 * x1 + x * x) / 12.0,
        a * (x0 * y0 + x1 * y1 + x * y) / 12.0,
        a * (y0 * y0 + y1 * y1 + y * y) / 12.0,
    )


@compiled
def moments(corners: Floats, k: int, n: int) -> Moments:
    """Return the moments of the convex polygon in place k, of n corners.

    Triangles of area a whose corners add up to s have first moments ``a s / 3`` and second moments
    ``a (sum p p' + s s') / 12``.
    """
    area = mx = my = xx = xy = yy = 0.0
    for i in range(1, n - 1):
        x0, y0 = corners[k, 0, 0], corners[k, 0, 1]
        x1, y1 = corners[k, i, 0], corners[k, i, 1]
        x2, y2 = corners[k, i + 1, 0], corners[k, i + 1, 1]
        a = 0.5 * ((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0))
        x, y = x0 + x1 + x2, y0 + y1 + y2
        area += a
        mx += a * x / 3.0
        my += a * y / 3.0
        xx += a * (x0 * x0 + x1 * x1 + x2 * x2 + x * x) / 12.0
        xy += a * (x0 * y0 + x1 * y1 + x2 * y2 + x * y) / 12.0
        yy += a * (y0 * y0 + y1 * y1 + y2 * y2 + y * y) / 12.0
    return area, mx, my, xx, xy, yy
