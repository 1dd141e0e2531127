r"""How loads and motions depend on the friction of contacts.

A part that moves along v under contacts at :math:`r_k` of friction radii :math:`m_k` needs the load
:math:`F = \sum m_k G_k e_k`, with :math:`e_k` the direction in which contact k slides: linear in m.
The motion under a load F minimises :math:`h_m(v)` in the plane F.v = 1, and its slopes follow from
the condition that the gradient stays along F. Where a contact is close to the centre of rotation
the direction of its force is not determined: both are smoothed to a width, a speed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.load_ray import motions_on_rays

__all__ = ["load_slopes", "motion_slopes", "motions_under", "unit_rows"]

Array = NDArray[np.float64]

_EXACT = 1e-9  # width of the smoothing that leaves motions exact to some 1e-8
_LIFT = 1e-3  # curvature, relative, that flat directions of h get: bounds the slopes there


def unit_rows(rows: Array) -> Array:
    """Return rows of length 1; zeros stay."""
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(np.divide(rows, length, out=np.zeros_like(rows), where=length > 0.0))


def _slips(v: Array, places: Array, width: float) -> tuple[Array, Array]:
    """Return directions of slip (n, 2, N), shortened near the centre of rotation, and speeds."""
    x, y = places.T
    u = np.stack([v[:, :1] - v[:, 2:] * y, v[:, 1:2] + v[:, 2:] * x], axis=1)
    speed = np.sqrt(u[:, 0] ** 2 + u[:, 1] ** 2 + width * width)
    return u / np.maximum(speed, np.finfo(np.float64).tiny)[:, None], speed


def _loads(force: Array, places: Array) -> Array:
    """Return the loads (n, 3, N) of forces (n, 2, N) at places (N, 2)."""
    x, y = places.T
    moment = x * force[:, 1] - y * force[:, 0]
    return np.concatenate([force, moment[:, None]], axis=1)


def load_slopes(v: Array, places: Array, width: float) -> Array:
    """Return the loads (n, 3, N) of contacts of unit friction, on a part that moves along v."""
    return _loads(_slips(v, places, width)[0], places)


def motions_under(loads: Array, places: Array, m: Array, width: float = _EXACT) -> Array:
    """Return motions v (n, 3) with F.v = 1 under loads along F, for F of unit length.

    Loads of length zero get no motion.
    """
    carries = np.flatnonzero(m > 0.0)
    contacts = np.ascontiguousarray(np.column_stack([places[carries], m[carries]]).T)
    F = unit_rows(loads)
    moves = np.linalg.norm(F, axis=1, keepdims=True) > 0.0
    motion, error = np.empty((len(F), 3)), np.empty((len(F), 2))
    motions_on_rays(F, contacts, width, motion, error)
    return np.where(moves, motion, 0.0)


def motion_slopes(
    loads: Array, places: Array, m: Array, width: float
) -> tuple[Array, Array, Array]:
    """Return unit motions (n, 3) under loads F, and their slopes in m (n, 3, N) and F (n, 3, 3).

    For F of length 1, P an orthonormal basis across it, g and H the gradient and Hessian of
    ``h_m``, the motion v in the plane F.v = 1 obeys ``P'g = 0``. From ``F.dv = -v.dF``,
    ``dv = P dz - F (v.dF)``, follows ``P' (H dv + dg) = (F.g) P' dF``.
    """
    v = motions_under(loads, places, m, width)
    e, speed = _slips(v, places, width)
    X, F = _loads(e, places), unit_rows(loads)
    H = _hessian(X, places, m / speed)
    P = np.linalg.svd(F[:, None, :])[2][:, 1:]
    A = P @ H @ P.transpose(0, 2, 1)
    lift = _LIFT * np.trace(A, axis1=1, axis2=2) + np.finfo(np.float64).tiny
    K = P.transpose(0, 2, 1) @ np.linalg.solve(A + lift[:, None, None] * np.eye(2), P)
    size = np.maximum(np.linalg.norm(v, axis=1), np.finfo(np.float64).tiny)
    unit = v / size[:, None]
    turn = (np.eye(3) - unit[:, :, None] * unit[:, None, :]) / size[:, None, None]
    across = P.transpose(0, 2, 1) @ P / np.linalg.norm(loads, axis=1)[:, None, None]
    strength = ((X @ m) * F).sum(axis=1)[:, None, None] * np.eye(3)
    plane = F[:, :, None] * v[:, None, :]
    return unit, -turn @ K @ X, turn @ (K @ (strength + H @ plane) - plane) @ across


def _hessian(X: Array, places: Array, q: Array) -> Array:
    """Return ``sum q_k (G G' - X X')`` (n, 3, 3), from loads X (n, 3, N) of unit forces."""
    G = _loads(np.broadcast_to(np.eye(2)[:, :, None], (2, 2, len(places))), places)
    square = np.einsum("aik,ajk->kij", G, G).reshape(-1, 9)
    return np.asarray((q @ square).reshape(-1, 3, 3) - (q[:, None] * X) @ X.transpose(0, 2, 1))
