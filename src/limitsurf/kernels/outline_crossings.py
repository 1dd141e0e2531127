r"""When points of the plane cross the outline of a moving part, exactly, and none is missed.

The pose moves along polynomials :math:`q(\tau)`, :math:`0 \le \tau \le 1`. In the frame of the part
a point p of the plane lies at :math:`b = R^T (p - c)`; its signed distance to the line of an edge
is :math:`d = n \cdot (b - a)`, positive on the part's side. With bounds V, A on the first two
derivatives of c, and :math:`\Omega, \Gamma` on those of the angle,

.. math:: |b'| \le V + \Omega |b|, \qquad
          |b''| \le A + 2 \Omega V + (\Gamma + \Omega^2) |b| =: K .

On an interval of half width r about its middle there is no crossing if
:math:`|d| > |d'| r + K r^2 / 2`, and at most one if :math:`|d'| > K r`; other intervals are halved.
The corners of the part and the walls of the array are the same problem in the frame of the array.
"""

from __future__ import annotations

import math

from limitsurf.kernels.compile import Bools, Floats, Ints, compiled
from limitsurf.kernels.pose_arc import (
    Arc,
    Line,
    arc_bounds,
    arc_pose,
    line_of,
    point_in_part,
    side_of,
)

__all__ = ["first_crossing", "first_exit", "points_on_outline"]

_NARROW = 2.0**-44


@compiled
def _root(
    arc: Arc, low: float, high: float, x: float, y: float, line: Line, fixed: bool, side: int
) -> float:
    """Return where d leaves `side` in an interval in which it does once: Newton and halving."""
    tau = 0.5 * (low + high)
    for _ in range(200):
        at = side_of(arc, tau, x, y, line, fixed)
        if at.d * side > 0.0:
            low = tau
        else:
            high = tau
        step = tau - at.d / at.dd if at.dd != 0.0 else low
        if not low < step < high:
            step = 0.5 * (low + high)
        if step == tau or high - low <= 1e-17 or at.d == 0.0:
            return tau
        tau = step
    return tau


@compiled
def _first_root(
    arc: Arc,
    x: float,
    y: float,
    line: Line,
    fixed: bool,
    side: int,
    curvature: float,
    near: float,
    best: float,
) -> float:
    """Return the first tau below `best` at which a point leaves `side` through an edge, or `best`.

    `side` = 0 is unknown, that of the first interval that tells. Closer than `near` to the line
    nothing tells.
    """
    low, width = 0.0, 1.0
    while low < best:
        r = 0.5 * width
        at = side_of(arc, low + r, x, y, line, fixed)
        change = abs(at.dd) * r + 0.5 * curvature * r * r
        shift = abs(at.ds) * r + 0.5 * curvature * r * r
        beyond = at.s + shift < -near or at.s - shift > line.length + near
        apart, monotone = abs(at.d) > change, abs(at.dd) > curvature * r
        if change > near and not (apart or beyond or monotone) and width > _NARROW:
            width = r
            continue
        end = at.d if apart else side_of(arc, low + width, x, y, line, fixed).d
        after = side if abs(end) <= near else (1 if end > 0.0 else -1)
        if side != 0 and after != side and not beyond:
            tau = low
            if not apart and side_of(arc, low, x, y, line, fixed).d * side > 0.0:
                tau = _root(arc, low, low + width, x, y, line, fixed, side)
            s = side_of(arc, tau, x, y, line, fixed).s
            if -near <= s <= line.length + near:
                return min(tau, best)
        side = after
        low += width
        while width < 1.0 and low % (2.0 * width) == 0.0:
            width *= 2.0
    return best


@compiled
def _far(bx: float, by: float, line: Line, reach: float) -> bool:
    """Return whether a point is farther than `reach` from an edge."""
    x, y = bx - line.ax, by - line.ay
    s = line.ny * x - line.nx * y
    s -= min(max(s, 0.0), line.length)
    d = line.nx * x + line.ny * y
    return bool(s * s + d * d > reach * reach)


@compiled
def _start_side(arc: Arc, x: float, y: float, line: Line, known: int, near: float) -> int:
    """Return on which side of a line a point starts: `known` if it lies on the edge."""
    at = side_of(arc, 0.0, x, y, line, True)
    if abs(at.d) > near:
        return 1 if at.d > 0.0 else -1
    if near < at.s < line.length - near:
        return known
    return 0


@compiled
def first_crossing(
    arc: Arc, edges: Floats, points: Floats, inside: Bools, skip: Bools, near: float
) -> tuple[float, int, int]:
    """Return the first tau < 1 at which a point crosses the outline, with point and edge.

    Parameters
    ----------
    arc : Arc
        The motion.
    edges : (E, 4) float
        Directed edges of the part about its reference point, the inside on their left.
    points : (n, 2) float
        Points of the plane.
    inside, skip : (n,) bool
        Which start inside, also those on the outline; which are left out.
    near : float
        Up to this distance from the outline the side at the start is what `inside` says.

    Returns
    -------
    tau, point, edge
        ``(2, -1, -1)`` if there is none.
    """
    bounds, best, which, where = arc_bounds(arc), 1.0, -1, -1
    reach = 0.0
    for e in range(edges.shape[0]):
        reach = max(reach, math.hypot(edges[e, 0], edges[e, 1]))
    x, y, _ = arc_pose(arc, 0.5)
    for i in range(points.shape[0]):
        px, py = points[i, 0], points[i, 1]
        far = math.hypot(px - x, py - y) + 0.5 * bounds.speed
        if skip[i] or far - bounds.speed > reach + near:
            continue
        speed = bounds.speed + bounds.turn * far
        curvature = bounds.acceleration + 2.0 * bounds.turn * bounds.speed
        curvature += (bounds.spin + bounds.turn**2) * far
        bx, by, _, _ = point_in_part(arc, 0.5, px, py)
        for e in range(edges.shape[0]):
            line = line_of(edges[e])
            if _far(bx, by, line, 0.5 * speed + near):
                continue
            side = _start_side(arc, px, py, line, 1 if inside[i] else -1, near)
            tau = _first_root(arc, px, py, line, True, side, curvature, near, best)
            if tau < best:
                best, which, where = tau, i, e
    return best if which >= 0 else 2.0, which, where


@compiled
def first_exit(arc: Arc, edges: Floats, walls: Floats, near: float) -> float:
    """Return the first tau < 1 at which a corner of the part leaves a convex polygon, or 2.

    Parameters
    ----------
    arc, edges, near
        As for `first_crossing`.
    walls : (W, 4) float
        Directed edges of the polygon, the inside on their left; all corners start inside.
    """
    bounds, best = arc_bounds(arc), 1.0
    for e in range(edges.shape[0]):
        ax, ay = edges[e, 0], edges[e, 1]
        arm = math.hypot(ax, ay)
        speed = bounds.speed + bounds.turn * arm
        curvature = bounds.acceleration + (bounds.spin + bounds.turn**2) * arm
        for w in range(walls.shape[0]):
            line = line_of(walls[w])
            if side_of(arc, 0.0, ax, ay, line, False).d <= speed + near:
                best = _first_root(arc, ax, ay, line, False, 1, curvature, near, best)
    return best if best < 1.0 else 2.0


@compiled
def points_on_outline(pose: Floats, edges: Floats, points: Floats, near: float, found: Ints) -> int:
    """List the points on the outline, up to `near`, with their edges; return how many pairs.

    `found` (K, 2) receives pairs ``point, edge``; pairs beyond its length are counted only.
    """
    cos, sin, count = math.cos(pose[2]), math.sin(pose[2]), 0
    for i in range(points.shape[0]):
        rx, ry = points[i, 0] - pose[0], points[i, 1] - pose[1]
        bx, by = cos * rx + sin * ry, cos * ry - sin * rx
        for e in range(edges.shape[0]):
            if not _far(bx, by, line_of(edges[e]), near):
                if count < found.shape[0]:
                    found[count, 0], found[count, 1] = i, e
                count += 1
    return count
