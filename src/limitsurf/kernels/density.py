r"""Load of a piecewise-linear force density on a polygon, its derivatives and its potential.

A piece is a convex region with the density :math:`f(x) = b + A (x - a)`. With the part at
:math:`q = (x, y, \theta)`, r the arm from its centre of mass, and :math:`\dot r` the velocity of a
point of it while :math:`q_j` grows,

.. math::
    L &= \sum \int_{P \cap R} (f,\; r \times f)\, dA, \\
    \frac{\partial L}{\partial q_j} &= \sum \int_{P \cap R}
        \Big(A \dot x,\; \frac{\partial r}{\partial q_j} \times f + r \times A \dot x\Big) dA
        - \sum \int_{P \cap \partial R} (f,\; r \times f)\,(n \cdot \dot x)\, ds :

the part sweeps over the borders of the regions, n their outer normals. Area integrals are moments
of clipped triangles up to the second; the border terms are cubic along a chord, for which
Gauss's rule with two nodes is exact.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.clipped_triangle import clip, moments, new_clip, start_triangle, triangle
from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["JACOBIAN", "LOAD", "POTENTIAL", "STATE", "Pieces", "density_states", "new_state"]

LOAD, POTENTIAL, JACOBIAN, STATE = 0, 3, 4, 13  # places in a state
_CLEAR = 1e-12  # of its size: a triangle that close to a border is clipped
_GAUSS = (0.5 - 0.5 / math.sqrt(3.0), 0.5 + 0.5 / math.sqrt(3.0))

Room = tuple[Floats, Ints]


class Pieces(NamedTuple):
    """Pieces of a density: piece k has the half-planes ``start[k]:start[k + 1]``.

    `start` (K + 1,), `normal` (H, 2) and `bound` (H,); `anchor`, `force` (K, 2), `slope` (K, 2, 2)
    and the potential at the anchor, `level` (K,).
    """

    start: Ints
    normal: Floats
    bound: Floats
    anchor: Floats
    force: Floats
    slope: Floats
    level: Floats


@compiled
def _add_area(m: Floats, b: Floats, A: Floats, level: float, out: Floats) -> None:
    """Add a region with moments m, where the density is ``b + A r`` and the potential `level`."""
    fx = b[0] * m[0] + A[0, 0] * m[1] + A[0, 1] * m[2]
    fy = b[1] * m[0] + A[1, 0] * m[1] + A[1, 1] * m[2]
    xfx = b[0] * m[1] + A[0, 0] * m[3] + A[0, 1] * m[4]
    yfx = b[0] * m[2] + A[0, 0] * m[4] + A[0, 1] * m[5]
    xfy = b[1] * m[1] + A[1, 0] * m[3] + A[1, 1] * m[4]
    yfy = b[1] * m[2] + A[1, 0] * m[4] + A[1, 1] * m[5]
    out[LOAD] += fx
    out[LOAD + 1] += fy
    out[LOAD + 2] += xfy - yfx
    square = A[0, 0] * m[3] + (A[0, 1] + A[1, 0]) * m[4] + A[1, 1] * m[5]
    out[POTENTIAL] += level * m[0] - b[0] * m[1] - b[1] * m[2] - 0.5 * square
    J = out[JACOBIAN:].reshape(3, 3)
    for k in range(2):
        J[k, 0] += A[k, 0] * m[0]
        J[k, 1] += A[k, 1] * m[0]
        J[k, 2] += A[k, 1] * m[1] - A[k, 0] * m[2]  # A (z x r)
        J[2, k] += A[1, k] * m[1] - A[0, k] * m[2]
    J[2, 2] += A[1, 1] * m[3] - (A[0, 1] + A[1, 0]) * m[4] + A[0, 0] * m[5] - xfx - yfy


@compiled
def _add_border(
    p: tuple[float, float],
    q: tuple[float, float],
    n: tuple[float, float],
    sign: float,
    work: Floats,
    A: Floats,
    J: Floats,
) -> None:
    """Subtract what the part loses over a chord from p to q of a border with outer normal n."""
    length = sign * math.sqrt((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2)
    for share in _GAUSS:
        x, y = p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
        fx = 0.5 * length * (work[6] + A[0, 0] * x + A[0, 1] * y)
        fy = 0.5 * length * (work[7] + A[1, 0] * x + A[1, 1] * y)
        m, turning = x * fy - y * fx, n[1] * x - n[0] * y
        J[0, 0] -= fx * n[0]
        J[0, 1] -= fx * n[1]
        J[0, 2] -= fx * turning
        J[1, 0] -= fy * n[0]
        J[1, 1] -= fy * n[1]
        J[1, 2] -= fy * turning
        J[2, 0] -= m * n[0]
        J[2, 1] -= m * n[1]
        J[2, 2] -= m * turning


@compiled
def _where(x0: float, y0: float, x1: float, y1: float, normals: Floats, bounds: Floats) -> int:
    """Return 1 if a triangle lies well within a region, -1 well outside, 0 where it may be cut."""
    place, slack = 1, _CLEAR * (abs(x0) + abs(y0) + abs(x1) + abs(y1))
    for h in range(bounds.shape[0]):
        one = normals[h, 0] * x0 + normals[h, 1] * y0
        two = normals[h, 0] * x1 + normals[h, 1] * y1
        if min(one, two, 0.0) > bounds[h] + slack:
            return -1
        if not max(one, two, 0.0) < bounds[h] - slack:
            place = 0
    return place


@compiled
def _add_cut(
    normals: Floats,
    bounds: Floats,
    corners: Floats,
    labels: Ints,
    sign: float,
    work: Floats,
    A: Floats,
    J: Floats,
) -> None:
    """Clip the triangle that lies in the first place; add its moments and what cut it."""
    k, n = 0, 3
    for h in range(bounds.shape[0]):
        n = clip(corners, labels, k, n, normals[h, 0], normals[h, 1], bounds[h], h)
        k = 1 - k
    parts = moments(corners, k, n)
    work[0] += parts[0]
    work[1] += parts[1]
    work[2] += parts[2]
    work[3] += parts[3]
    work[4] += parts[4]
    work[5] += parts[5]
    for i in range(n):
        h = labels[k, i]
        if h >= 0:
            j = i + 1 if i + 1 < n else 0
            p, q = (corners[k, i, 0], corners[k, i, 1]), (corners[k, j, 0], corners[k, j, 1])
            _add_border(p, q, (normals[h, 0], normals[h, 1]), sign, work, A, J)


@compiled
def _add_piece(
    edges: Floats, pieces: Pieces, k: int, pose: Floats, room: Room, work: Floats, out: Floats
) -> None:
    """Add one piece to the state of a part whose edges are placed about its centre of mass.

    `work` has room for the moments (6) and for the density at the centre of mass (2).
    """
    normals = pieces.normal[pieces.start[k] : pieces.start[k + 1]]
    bounds = pieces.bound[pieces.start[k] : pieces.start[k + 1]] - normals @ pose[:2]
    A, dx, dy = pieces.slope[k], pose[0] - pieces.anchor[k, 0], pose[1] - pieces.anchor[k, 1]
    sx, sy = A[0, 0] * dx + A[0, 1] * dy, A[1, 0] * dx + A[1, 1] * dy
    fx, fy = pieces.force[k, 0], pieces.force[k, 1]
    work[:6], work[6], work[7] = 0.0, fx + sx, fy + sy
    J, (corners, labels) = out[JACOBIAN:].reshape(3, 3), room
    m0 = mx = my = xx = xy = yy = 0.0
    for i in range(edges.shape[0]):
        x0, y0, x1, y1 = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        where = _where(x0, y0, x1, y1, normals, bounds)
        if where == 0:
            start_triangle(corners, labels, x0, y0, x1, y1)
            sign = 1.0 if x0 * y1 >= x1 * y0 else -1.0
            _add_cut(normals, bounds, corners, labels, sign, work, A, J)
        elif where == 1:
            parts = triangle(x0, y0, x1, y1)
            m0, mx, my = m0 + parts[0], mx + parts[1], my + parts[2]
            xx, xy, yy = xx + parts[3], xy + parts[4], yy + parts[5]
    for j, whole in enumerate((m0, mx, my, xx, xy, yy)):
        work[j] += whole
    level = pieces.level[k] - fx * dx - fy * dy - 0.5 * (dx * sx + dy * sy)
    _add_area(work[:6], work[6:8], A, level, out)


@compiled
def new_state() -> Floats:
    """Return room for the state at one pose, (1, 13)."""
    return np.empty((1, STATE))


@compiled
def density_states(edges: Floats, poses: Floats, pieces: Pieces, out: Floats) -> None:
    """Fill states (k, 13) at poses (k, 3): the load, the potential, the Jacobian by rows.

    `edges` (E, 4) are those of the part about its centre of mass. Where an edge of the part lies
    along a border the Jacobian has two values; it is that of one side.
    """
    most = 0
    for k in range(pieces.start.shape[0] - 1):
        most = max(most, pieces.start[k + 1] - pieces.start[k])
    room, work, placed = new_clip(most), np.empty(8), np.empty(edges.shape)
    for i in range(poses.shape[0]):
        cos, sin = math.cos(poses[i, 2]), math.sin(poses[i, 2])
        for j in range(edges.shape[0]):
            for c in (0, 2):
                placed[j, c] = cos * edges[j, c] - sin * edges[j, c + 1]
                placed[j, c + 1] = sin * edges[j, c] + cos * edges[j, c + 1]
        out[i] = 0.0
        for k in range(pieces.start.shape[0] - 1):
            _add_piece(placed, pieces, k, poses[i], room, work, out[i])
