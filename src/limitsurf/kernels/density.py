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

from limitsurf.kernels.clipped_triangle import Clip, clip, moments, new_clip, start_triangle
from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["JACOBIAN", "LOAD", "POTENTIAL", "STATE", "Pieces", "density_states", "new_state"]

LOAD, POTENTIAL, JACOBIAN, STATE = 0, 3, 4, 13  # places in a state
_GAUSS = (0.5 - 0.5 / math.sqrt(3.0), 0.5 + 0.5 / math.sqrt(3.0))


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
    p: Floats, q: Floats, n: Floats, weight: float, b: Floats, A: Floats, J: Floats
) -> None:
    """Subtract what the part loses over a chord from p to q of a border with outer normal n."""
    length = weight * math.hypot(q[0] - p[0], q[1] - p[1])
    for share in _GAUSS:
        x, y = p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
        fx = 0.5 * length * (b[0] + A[0, 0] * x + A[0, 1] * y)
        fy = 0.5 * length * (b[1] + A[1, 0] * x + A[1, 1] * y)
        for k in range(3):
            rate = n[k] if k < 2 else n[1] * x - n[0] * y
            J[0, k] -= fx * rate
            J[1, k] -= fy * rate
            J[2, k] -= (x * fy - y * fx) * rate


@compiled
def _add_piece(
    edges: Floats, pieces: Pieces, k: int, pose: Floats, room: Clip, work: Floats, out: Floats
) -> None:
    """Add one piece to the state of a part whose edges are placed about its centre of mass."""
    A, a, m = pieces.slope[k], pieces.anchor[k], work[:6]
    dx, dy = pose[0] - a[0], pose[1] - a[1]
    sx, sy = A[0, 0] * dx + A[0, 1] * dy, A[1, 0] * dx + A[1, 1] * dy
    b = work[6:8]
    b[0], b[1] = pieces.force[k, 0] + sx, pieces.force[k, 1] + sy
    level = pieces.level[k] - pieces.force[k, 0] * dx - pieces.force[k, 1] * dy
    level -= 0.5 * (dx * sx + dy * sy)
    J = out[JACOBIAN:].reshape(3, 3)
    m[:] = 0.0
    for i in range(edges.shape[0]):
        x0, y0, x1, y1 = edges[i]
        side = 0 if x0 * y1 >= x1 * y0 else 1
        place, n = 0, start_triangle(room, x0, y0, x1, y1)
        for h in range(pieces.start[k], pieces.start[k + 1]):
            c = pieces.normal[h]
            n = clip(room, place, n, c, pieces.bound[h] - c[0] * pose[0] - c[1] * pose[1], h)
            place = 1 - place
        corners, labels = room.corners[place], room.labels[place]
        parts = moments(corners, n)
        for j in range(6):
            m[j] += parts[j]
        for j in range(n):
            if labels[j] >= 0:
                to = corners[j + 1 if j + 1 < n else 0]
                sign = 1.0 if side == 0 else -1.0
                _add_border(corners[j], to, pieces.normal[labels[j]], sign, b, A, J)
    _add_area(m, b, A, level, out)


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
