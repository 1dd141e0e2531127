"""Rigid motions of the plane: poses ``(x, y, theta)``, one after the other, and along a twist."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["compose", "displacement", "to_body", "to_world"]

Array = NDArray[np.float64]


def displacement(twist: Array, times: Array) -> Array:
    r"""Return the poses (..., 3) that a twist (3,), constant in the body frame, leads to from 0.

    With :math:`\phi = \omega t`, :math:`s = \sin\phi / \phi` and :math:`c = (1 - \cos\phi)/\phi`,

    .. math:: \exp(t v) = (t\,(s v_x - c v_y),\ t\,(c v_x + s v_y),\ \phi)

    without a division by small angles: s is a sinc, and :math:`c = \sin(\phi/2)\,
    \mathrm{sinc}(\phi/2)` (R. M. Murray, Z. Li, S. S. Sastry, *A Mathematical Introduction to
    Robotic Manipulation*, 1994, section 2.3).
    """
    vx, vy, omega = twist
    phi = omega * times
    s = np.sinc(phi / np.pi)
    c = np.sin(0.5 * phi) * np.sinc(0.5 * phi / np.pi)
    return np.stack([times * (s * vx - c * vy), times * (c * vx + s * vy), phi], axis=-1)


def compose(first: Array, then: Array) -> Array:
    """Return the poses (..., 3) after motions `then`, given in the frame of the poses `first`."""
    moved = to_world(then, first[..., 2])
    return np.asarray(first + moved)


def to_world(vectors: Array, theta: Array | float) -> Array:
    """Return twists, loads or displacements (..., 3) of the body frame in world axes."""
    c, s = np.cos(theta), np.sin(theta)
    x, y, last = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    turned = np.broadcast_arrays(c * x - s * y, s * x + c * y, last)
    return np.stack(turned, axis=-1)


def to_body(vectors: Array, theta: Array | float) -> Array:
    """Return twists, loads or displacements (..., 3) of the world in body axes."""
    return to_world(vectors, -theta)
