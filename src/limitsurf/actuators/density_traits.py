"""What the pieces of a density say about its potential: convexity, flat directions, bounds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.density_piece import DensityPiece
from limitsurf.geometry.part import Part

__all__ = ["centers_of", "flat_directions", "known_convex", "turning_bound"]

Array = NDArray[np.float64]

_ROUNDING = 1e-12


def known_convex(pieces: Sequence[DensityPiece]) -> bool:
    """Return whether the potential of a density is convex for sure.

    It is if pieces without borders pull inwards (minus their slopes are positive semidefinite) and
    the others come in pairs of half-planes, without slope, that push towards their border.
    """
    everywhere = [piece for piece in pieces if len(piece.bounds) == 0]
    halves = [piece for piece in pieces if len(piece.bounds)]
    inwards = all(
        np.linalg.eigvalsh(-piece.slope)[0] >= -_ROUNDING * np.abs(piece.slope).max()
        for piece in everywhere
    )
    if len(halves) % 2 or any(len(piece.bounds) > 1 for piece in halves):
        return False
    return inwards and all(map(_is_squeeze, halves[::2], halves[1::2]))


def _is_squeeze(left: DensityPiece, right: DensityPiece) -> bool:
    n = right.normals[0]  # towards the left piece
    jump = right.force - left.force
    size = _ROUNDING * np.abs(jump).max()
    return bool(
        not left.slope.any()
        and not right.slope.any()
        and np.array_equal(left.normals[0], -n)
        and left.bounds[0] == -right.bounds[0]
        and abs(n[0] * jump[1] - n[1] * jump[0]) <= size
        and n @ jump >= -size
    )


def flat_directions(pieces: Sequence[DensityPiece]) -> Array:
    """Return orthonormal directions (d, 2) along which no piece changes."""
    rows = [piece.normals for piece in pieces]
    rows += [piece.slope / (np.abs(piece.slope).max() or 1.0) for piece in pieces]
    _, size, ways = np.linalg.svd(np.vstack([np.zeros((2, 2)), *rows]))
    return np.asarray(ways[size <= _ROUNDING])


def centers_of(pieces: Sequence[DensityPiece]) -> Array:
    """Return the anchors (c, 2) of pieces that change from place to place, on their borders [m]."""
    found = [np.empty((0, 2))]
    for piece in pieces:
        if len(piece.bounds):
            n, b = piece.normals[0], piece.bounds[0]
            found.append((piece.anchor + (b - n @ piece.anchor) * n)[None])
        elif piece.slope.any():
            found.append(piece.anchor[None])
    return np.unique(np.vstack(found), axis=0)


def turning_bound(
    pieces: Sequence[DensityPiece], part: Part, center: Array | None, reach: float
) -> float:
    r"""Return a bound on the second derivative of the potential under turns about a point [J].

    For centroids at most `reach` from the point; with None about the centroid, wherever it is.
    With arms a from the point, forces f and their slopes A it is
    :math:`\int (a \cdot f - (\hat z \times a)^T A\, (\hat z \times a))\, dA` over the regions, plus
    :math:`|f| \int a_t^2\, ds` along the chords of borders, at most ``2 R reach^2 + 2/3 R^3`` each.
    Infinite where a piece with borders has a slope.
    """
    R, area = part.circumradius, part.area
    reach = 0.0 if center is None else reach
    chord = 2.0 * R * reach**2 + 2.0 / 3.0 * R**3
    total = 0.0
    for piece in pieces:
        if len(piece.bounds):
            if piece.slope.any():
                return np.inf
            push = float(np.hypot(*piece.force))
            total += push * (len(piece.bounds) * chord + area * (R + reach))
        else:
            spread = float(np.ptp(np.linalg.eigvalsh(piece.slope)))
            if center is not None:
                at_center = piece.force + piece.slope @ (center - piece.anchor)
                total += float(np.hypot(*at_center)) * area * reach
            total += spread * (part.polar_moment + area * reach**2)
    return total
