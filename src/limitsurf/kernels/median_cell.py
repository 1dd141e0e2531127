r"""Medians and squeeze energy over an interval of directions: only edges near the line are read.

A cell of directions knows which edges the median may cross in any of them. Edges on the left for
certain have given their area and first moment once and for all; those on the right are forgotten;
`limitsurf.kernels.median_view` says how that is known. With the area 1, the centroid at the origin
and M the first moment of the left half,

.. math::
    U = 2\, n \cdot M, \qquad U' = -2\, u \cdot M, \qquad U'' = 2 J - U
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled

__all__ = ["CELLS", "LEAST", "START", "Cell", "Known", "median_at", "state_in", "whole_turn"]

CELLS = 16  # into which a half turn is cut to begin with
LEVELS = 60  # of halvings, at most; LEAST ends them before
LEAST = 2.0**-50  # half width of a cell [rad] that is not cut any more
_AREA_ROUNDING = 2e-16  # of half the area
START = 0.5772156649015329  # no direction that a symmetric part might single out


class Known(NamedTuple):
    """What a half-plane holds for certain, and which edges need a look: `kept[first:][:number]`."""

    area: float  # sums over the edges that stay on the left
    mx: float
    my: float
    first: int
    number: int


class Cell(NamedTuple):
    """Directions ``[left, right]``, a guess and bounds of z, and what is known for all of them."""

    left: float
    right: float
    z: float
    low: float
    high: float
    known: Known


@compiled
def whole_turn(edges: Floats, radius: float) -> tuple[Ints, list[Cell]]:
    """Return room for lists of edges, and cells that cover half a turn, the first one last."""
    n = edges.shape[0]
    kept = np.empty(LEVELS * n, dtype=np.int32)
    for i in range(n):
        kept[i] = i
    width = np.pi / CELLS
    everything = Known(0.0, 0.0, 0.0, 0, n)
    stack = [
        Cell(START + k * width, START + (k + 1) * width, 0.0, -radius, radius, everything)
        for k in range(CELLS - 1, -1, -1)
    ]
    return kept, stack


@compiled
def _left_area(
    edges: Floats, kept: Ints, known: Known, theta: float, z: float
) -> tuple[float, float]:
    """Return the area left of the line that the kept edges add, and the length of the chords."""
    cos, sin = np.cos(theta), np.sin(theta)
    area = 0.0
    chord = 0.0
    for k in range(known.first, known.first + known.number):
        i = kept[k]
        x0, y0, x1, y1 = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        t0 = cos * y0 - sin * x0
        t1 = cos * y1 - sin * x1
        if t0 > z or t1 > z:
            triangle = 0.5 * (x0 * (y1 - y0) - y0 * (x1 - x0))
            if t0 > z and t1 > z:
                area += triangle
            else:
                share = (t0 - z) / (t0 - t1)
                s = cos * x0 + sin * y0 + share * (cos * (x1 - x0) + sin * (y1 - y0))
                area += triangle * (share if t0 > z else 1.0 - share)
                chord += s if t1 > z else -s
    return area - 0.5 * z * chord, chord


@compiled
def median_at(
    edges: Floats, kept: Ints, known: Known, theta: float, guess: float, low: float, high: float
) -> float:
    """Return z of the median in direction theta: Newton steps kept inside a bracket."""
    z = min(max(guess, low), high)
    reach = 2e-16 * max(abs(low), abs(high))
    last = np.inf
    for _ in range(200):
        more, chord = _left_area(edges, kept, known, theta, z)
        excess = known.area + more - 0.5
        step = z + excess / chord if chord > 0.0 else np.inf
        if abs(excess) <= _AREA_ROUNDING:
            return step if low < step < high else z
        if excess > 0.0:
            low = z
        else:
            high = z
        # where chords appear or vanish Newton's steps may shrink the bracket too slowly
        if not low < step < high or abs(step - z) > 0.5 * last:
            step = 0.5 * (low + high)
        last = abs(step - z)
        if last <= reach or step in (low, high):
            return step
        z = step
    return z


@compiled
def state_in(
    edges: Floats, kept: Ints, known: Known, theta: float, z: float
) -> tuple[float, float, float, float, float]:
    """Return ``(U, U', J, chord length, s_m)`` at the median ``n.x = z``."""
    cos, sin = np.cos(theta), np.sin(theta)
    mx, my = known.mx, known.my
    length = 0.0
    first = 0.0
    second = 0.0
    for k in range(known.first, known.first + known.number):
        i = kept[k]
        x0, y0, x1, y1 = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        t0 = cos * y0 - sin * x0
        t1 = cos * y1 - sin * x1
        if t0 > z or t1 > z:
            dx, dy = x1 - x0, y1 - y0
            sixth = (x0 * dy - y0 * dx) / 6
            if t0 > z and t1 > z:
                mx += sixth * (x0 + x1)
                my += sixth * (y0 + y1)
            else:
                share = (t0 - z) / (t0 - t1)
                x, y = x0 + share * dx, y0 + share * dy
                s = cos * x + sin * y
                if t0 > z:
                    mx += sixth * share * (x0 + x)
                    my += sixth * share * (y0 + y)
                    s_signed = -s
                else:
                    mx += sixth * (1.0 - share) * (x + x1)
                    my += sixth * (1.0 - share) * (y + y1)
                    s_signed = s
                length += s_signed
                first += s_signed * s / 2
                second += s_signed * s * s / 3
    energy = 2.0 * (cos * my - sin * mx - z * z * length / 3)
    slope = -2.0 * (cos * mx + sin * my - z * first / 3)
    middle = first / length if length > 0.0 else 0.0
    return energy, slope, max(second - first * middle, 0.0), length, middle
