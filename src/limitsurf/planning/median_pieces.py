"""Intervals of orientations in which the median crosses the same edges."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from limitsurf.geometry.outlines import ring_starts
from limitsurf.kernels.median import squeeze_states

__all__ = ["MedianPiece", "crossed_in_the_middle", "median_pieces"]

Array = NDArray[np.float64]

_SAME = 1e-12  # rad; events closer than this are one


@dataclass(frozen=True)
class MedianPiece:
    """An interval of orientations in which the median crosses the same edges.

    Attributes
    ----------
    left, right : float
        Ends [rad]; ``0 <= left < right``, and `right` may exceed pi in the last piece.
    edges : tuple of int
        The crossed edges: rows of `Part.edges`.
    """

    left: float
    right: float
    edges: tuple[int, ...]


def median_pieces(
    edges: Array, theta: Array, vertex: NDArray[np.int32], side: Array
) -> list[MedianPiece]:
    """Return the pieces between events, ascending in phi = -theta, one half turn in all.

    Parameters
    ----------
    edges : (E, 4) float
        Directed edges.
    theta : (k,) float
        Ascending directions within half a turn in which the median passes a vertex.
    vertex : (k,) int
        The vertices: the edges that start there.
    side : (E,) float
        Sides of all vertices before the first event, 1 left of the median and -1 right of it.
    """
    before = _edges_before(edges)
    crossed = {int(i) for i in np.flatnonzero(side[before] != side)}
    crossed = {int(before[i]) for i in crossed}  # an edge crosses if its ends differ
    after: list[tuple[float, tuple[int, ...]]] = []
    for k, (angle, v) in enumerate(zip(theta.tolist(), vertex.tolist(), strict=True)):
        crossed ^= {v}
        crossed ^= {int(before[v])}
        if k + 1 == len(theta) or theta[k + 1] - angle > _SAME:
            after.append((angle, tuple(sorted(crossed))))
    if len(after) > 1 and after[0][0] + np.pi - after[-1][0] <= _SAME:
        after.pop(0)
    ends = [angle for angle, _ in after[1:]] + [after[0][0] + np.pi]
    pieces = [(-end, -angle, crossing) for (angle, crossing), end in zip(after, ends, strict=True)]
    return sorted(
        (
            MedianPiece(left - shift, right - shift, crossing)
            for left, right, crossing in pieces
            for shift in [np.pi * np.floor(left / np.pi)]
        ),
        key=lambda piece: piece.left,
    )


def crossed_in_the_middle(edges: Array, pieces: list[MedianPiece]) -> list[MedianPiece]:
    """Return the pieces with the edges that a median in the middle of each crosses.

    For parts with halves on two sides of a gap, where the median is not unique and the events do
    not tell the edges; one sum over all edges a piece.
    """
    theta = np.array([-0.5 * (piece.left + piece.right) for piece in pieces])
    offsets = squeeze_states(edges, theta, 0.5)[:, 0]
    crossed = []
    for angle, z, piece in zip(theta, offsets, pieces, strict=True):
        left = np.cos(angle) * edges[:, 1::2] - np.sin(angle) * edges[:, ::2] > z
        cut = np.flatnonzero(left[:, 0] != left[:, 1])
        crossed.append(replace(piece, edges=tuple(cut.tolist())))
    return crossed


def _edges_before(edges: Array) -> NDArray[np.int64]:
    """Return the edge that ends where each edge starts; rings follow one another."""
    starts = ring_starts(edges)
    before = np.arange(len(edges)) - 1
    before[starts] = np.append(starts[1:], len(edges)) - 1
    return before
