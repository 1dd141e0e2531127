r"""When a resting part starts to move under a load that changes, and how.

The loads that the contacts hold are a convex set, and a load stays within the Bernstein
coefficients of its pieces (``load_table``): an interval whose coefficients lie in a box that is
held is passed over as a whole; others are halved, until one is left at whose end the load is not
held. There Newton's method on the certified distance, the derivative of which is that of the load
along the normal, finds the instant.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.feet_hold import Holder, closest, size_of
from limitsurf.kernels.load_table import VARIES, Load, load_at, piece_of, turned
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = ["exit_time", "is_held", "start_moving"]

_SHORT, _SHORTEST = 1.0 / 64.0, 1.0 / 4096.0  # of a piece


@compiled
def _net(holder: Holder, load: Load, push: Vector, theta: float, t: float) -> Vector:
    """Return the acceleration that friction leaves to a resting part, zero if it is held."""
    F, _ = load_at(load, t)
    return closest(holder, along(turned(F, theta), 1.0, push))[0]


@compiled
def _is_zero(v: Vector) -> bool:
    return v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0


@compiled
def is_held(holder: Holder, load: Load, push: Vector, theta: float, t: float) -> bool:
    """Return whether the contacts hold the load at a time."""
    return _is_zero(_net(holder, load, push, theta, t))


@compiled
def _split(control: Floats, depth: int, s: float) -> None:
    """Put the left part of the interval at `depth` a level deeper; keep the right part.

    By P. de Casteljau's averages.
    """
    right, left = control[depth], control[depth + 1]
    n = right.shape[1]
    for c in range(3):
        for k in range(n):
            left[c, k] = right[c, 0]
            for j in range(n - 1 - k):
                right[c, j] = (1.0 - s) * right[c, j] + s * right[c, j + 1]


@compiled
def _holds_box(holder: Holder, push: Vector, theta: float, points: Floats) -> bool:
    """Return whether all loads in the box around points (3, K) are held."""
    low, high = np.empty(3), np.empty(3)
    for c in range(3):
        low[c], high[c] = points[c].min(), points[c].max()
    for corner in range(8):
        repeated = False
        for c in range(3):
            repeated = repeated or ((corner >> c) & 1 and low[c] == high[c])
        if repeated:
            continue
        x = high[0] if corner & 1 else low[0]
        y = high[1] if corner & 2 else low[1]
        m = high[2] if corner & 4 else low[2]
        if not _is_zero(closest(holder, along(turned((x, y, m), theta), 1.0, push))[0]):
            return False
    return True


@compiled
def _root(
    holder: Holder, load: Load, push: Vector, theta: float, low: float, high: float
) -> float:
    """Return the first instant at which a load held at `low` but not at `high` is not."""
    width = high - low
    guess = high
    for _ in range(80):
        F, dF = load_at(load, guess)
        a = closest(holder, along(turned(F, theta), 1.0, push))[0]
        if _is_zero(a):
            low = guess
            guess = 0.5 * (low + high)
        else:
            high = guess
            size = size_of(holder, a)
            slope = dot(a, turned(dF, theta)) / (holder.numbers[6] * size)
            guess = high - size / slope if slope > 0.0 else low
            if not low < guess < high:
                guess = 0.5 * (low + high)
            elif size <= slope * 1e-13 * (width + high):
                return high
        if high - low <= 1e-13 * (width + high):
            break
    return high


@compiled
def exit_time(holder: Holder, load: Load, push: Vector, theta: float, t: float) -> float:
    """Return when a load that is held at a time is first not held; infinity if that is never."""
    if load.kind != VARIES:
        return np.inf
    n, pieces = load.bernstein.shape[2], load.ends.shape[0] - 1
    control, ends = np.empty((14, 3, n)), np.empty(15)
    for i in range(piece_of(load.ends, t), pieces):
        begin, whole = load.ends[i], load.ends[i + 1] - load.ends[i]
        control[0] = load.bernstein[i]
        if t > begin:
            _split(control, 0, (t - begin) / whole)
            begin = t
        depth, ends[0] = 0, load.ends[i + 1]
        while depth >= 0:
            end = ends[depth]
            width = (end - begin) / whole
            if _holds_box(holder, push, theta, control[depth]):
                begin, depth = end, depth - 1
            elif width <= _SHORT and not is_held(holder, load, push, theta, end):
                return _root(holder, load, push, theta, begin, end)
            elif width <= _SHORTEST:
                begin, depth = end, depth - 1
            else:
                _split(control, depth, 0.5)
                ends[depth + 1] = 0.5 * (begin + end)
                depth += 1
    return np.inf


@compiled
def start_moving(
    holder: Holder, load: Load, push: Vector, theta: float, t: float, speed: float, longest: float
) -> tuple[float, Vector]:
    r"""Return after which time the part has about a given small speed, and its twist then.

    The acceleration is what friction leaves, :math:`a_0` at t and about :math:`a_0 + \gamma s`
    after a time s: the speed is :math:`a_0 s + \gamma s^2/2`. The twist is zero if the load is held
    again before.
    """
    now = _net(holder, load, push, theta, t)
    a0, s = size_of(holder, now), longest
    then = now
    for _ in range(60):
        then = _net(holder, load, push, theta, t + s)
        a = size_of(holder, then)
        if a == 0.0:
            s *= 0.25
            continue
        gamma = (a - a0) / s
        root = math.sqrt(max(a0 * a0 + 2.0 * gamma * speed, 0.0))
        wanted = 2.0 * speed / (a0 + root) if a0 + root > 0.0 else s
        if wanted >= 0.9 * s:
            break
        s = wanted
    return s, scaled(0.5 * s, along(now, 1.0, then))
