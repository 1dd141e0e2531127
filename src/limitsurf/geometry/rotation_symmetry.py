"""The rotational symmetry of a polygon about its centroid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from limitsurf.geometry.outlines import ring_starts

__all__ = ["rotation_order"]

Complex = NDArray[np.complex128]

_SAME = 1e-9  # distance between points that are one, at area 1
_STRAIGHT = 1e-13  # height of a corner over the line past it that is no corner, at area 1


def rotation_order(edges: NDArray[np.float64]) -> int:
    """Return the largest r such that a turn by 2 pi / r changes nothing.

    A turn moves each corner to another one as far from the centre. So r divides the number of
    corners at any distance, which leaves few candidates, and none for most parts. A candidate is
    tried by turning whole rings: one corner says which ring they fall on, and where.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges of area 1 about the centroid, ring by ring.
    """
    vertices = edges[:, 0] + 1j * edges[:, 1]
    rings = [_corners(ring) for ring in np.split(vertices, ring_starts(edges)[1:])]
    radii = np.sort(np.abs(np.concatenate(rings)))
    borders = np.flatnonzero(np.diff(radii) > _SAME) + 1
    sizes = np.diff(np.concatenate([[0], borders, [len(radii)]]))
    common = math.gcd(*sizes.tolist())
    divisors = {
        d for k in range(1, math.isqrt(common) + 1) if common % k == 0 for d in (k, common // k)
    }
    return next(r for r in sorted(divisors, reverse=True) if r == 1 or _fits(rings, r))


def _corners(ring: Complex) -> Complex:
    """Drop vertices on the straight line between their neighbours."""
    along = np.roll(ring, -1) - np.roll(ring, 1)
    height = np.abs(np.imag((ring - np.roll(ring, 1)) * np.conj(along)))
    corner = height > _STRAIGHT * np.abs(along)
    return ring[corner] if np.count_nonzero(corner) >= 3 else ring


def _fits(rings: list[Complex], order: int) -> bool:
    """Return whether a turn by 2 pi / order moves each ring onto a ring."""
    turn = np.exp(2j * np.pi / order)
    return all(any(_falls_on(ring * turn, other) for other in rings) for ring in rings)


def _falls_on(ring: Complex, other: Complex) -> bool:
    if len(ring) != len(other):
        return False
    shifts = np.flatnonzero(np.abs(other - ring[0]) <= _SAME)
    return any(np.abs(np.roll(other, -shift) - ring).max() <= _SAME for shift in shifts.tolist())
