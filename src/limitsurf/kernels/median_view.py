r"""The median in the middle of a cell of directions, and bounds that hold in all of the cell.

The line turns about the middle ``s_m`` of its chords (``z' = -s_m``), so that no point of the part
at distance at most R from the centroid comes nearer to the line, in directions ``theta +- h``, than
``|n.x - z| - 2 R h``. Edges beyond the strip ``|n.x - z| <= w = 2 R h`` stay on their side.

J = min_c of the integral of ``(s - c)^2`` over the chords grows with the set of chords. At
directions ``theta +- h`` that set differs from the one at theta only where edges pass through the
strip, which encloses J, and with it U'' (``docs/planning.md``).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.median_cell import Cell, Known, median_at, state_in

__all__ = ["View", "halves", "look", "median_in"]


class View(NamedTuple):
    """The median in the middle of a cell, and what holds in all of it."""

    left: float
    right: float
    theta: float
    half: float
    z: float
    energy: float
    slope: float
    second: float  # J
    chord: float
    middle: float  # s_m
    strip: float  # w
    low: float  # U'' lies between low and high
    high: float
    drift: float  # s_m, seen along u(theta), moves by at most this
    known: Known


@compiled
def median_in(
    edges: Floats, kept: Ints, view: View, theta: float
) -> tuple[float, float, float, float, float, float]:
    """Return ``(z, U, U', J, chord length, s_m)`` in a direction inside a cell looked at.

    Within the bounds of z the edges that are no longer listed are on the side that was noted.
    """
    low, high = view.z - 0.5 * view.strip, view.z + 0.5 * view.strip  # |z'| <= R
    guess = view.z - view.middle * (theta - view.theta)
    z = median_at(edges, kept, view.known, theta, guess, low, high)
    energy, slope, second, chord, middle = state_in(edges, kept, view.known, theta, z)
    return z, energy, slope, second, chord, middle


@compiled
def _narrow(
    edges: Floats, kept: Ints, known: Known, theta: float, z: float, middle: float, w: float
) -> tuple[Known, float, float, float]:
    """List the edges in the strip behind those known so far.

    Returns what is known then, and what the shadows of the edges in the strip on the line add up
    to: length, and integrals of ``|s - s_m|`` (a bound) and of its square.
    """
    cos, sin = np.cos(theta), np.sin(theta)
    top = known.first + known.number
    number = 0
    area, mx, my = known.area, known.mx, known.my
    shadow0, shadow1, shadow2 = 0.0, 0.0, 0.0
    for k in range(known.first, top):
        i = kept[k]
        x0, y0, x1, y1 = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        t0 = cos * y0 - sin * x0 - z
        t1 = cos * y1 - sin * x1 - z
        if t0 > w and t1 > w:
            triangle = 0.5 * (x0 * (y1 - y0) - y0 * (x1 - x0))
            area += triangle
            mx += triangle * (x0 + x1) / 3
            my += triangle * (y0 + y1) / 3
        elif not (t0 < -w and t1 < -w):
            kept[top + number] = i
            number += 1
            s0 = cos * x0 + sin * y0 - middle
            run = cos * (x1 - x0) + sin * (y1 - y0)
            from_t, to_t = min(max(t0, -w), w), min(max(t1, -w), w)
            a = s0 if from_t == t0 else s0 + run * ((from_t - t0) / (t1 - t0))
            b = s0 + run if to_t == t1 else s0 + run * ((to_t - t0) / (t1 - t0))
            a, b = min(a, b), max(a, b)
            shadow0 += b - a
            shadow1 += (b - a) * max(abs(a), abs(b))
            shadow2 += (b - a) * (a * a + a * b + b * b) / 3
    return Known(area, mx, my, top, number), shadow0, shadow1, shadow2


@compiled
def look(edges: Floats, radius: float, kept: Ints, cell: Cell) -> View:
    """Return the median in the middle of a cell, and bounds of U'' in all of it."""
    theta = 0.5 * (cell.left + cell.right)
    half = 0.5 * (cell.right - cell.left)
    z = median_at(edges, kept, cell.known, theta, cell.z, cell.low, cell.high)
    energy, slope, second, chord, middle = state_in(edges, kept, cell.known, theta, z)
    strip = 2.0 * radius * (half * (1 + 1e-9) + 1e-15)
    known, shadow0, shadow1, shadow2 = _narrow(edges, kept, cell.known, theta, z, middle, strip)
    least, most = 0.0, (second + shadow2) / np.cos(half) ** 3
    drift = 2.0 * radius
    if shadow0 < chord:
        least = max(second - shadow2 - shadow1 * shadow1 / (chord - shadow0), 0.0)
        drift = shadow1 / (chord - shadow0)
    change = half * (abs(slope) + half * max(2.0 * most, radius))  # of U; 0 <= U <= radius
    low, high = 2.0 * least - energy - change, 2.0 * most - energy + change
    return View(
        cell.left,
        cell.right,
        theta,
        half,
        z,
        energy,
        slope,
        second,
        chord,
        middle,
        strip,
        low,
        high,
        drift,
        known,
    )


@compiled
def halves(view: View) -> tuple[Cell, Cell]:
    """Return the halves of a cell, the right one first: a stack then gives the left one first."""
    low, high = view.z - 0.5 * view.strip, view.z + 0.5 * view.strip  # |z'| <= R
    turn = 0.5 * view.half * view.middle
    return (
        Cell(view.theta, view.right, view.z - turn, low, high, view.known),
        Cell(view.left, view.theta, view.z + turn, low, high, view.known),
    )
