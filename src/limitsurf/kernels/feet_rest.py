r"""When a resting part starts to move under a load that changes, and how.

The loads that the contacts hold are a convex set, and a load stays in the convex hull of its
Bernstein coefficients (``load_table``): an interval is passed over as a whole if they are held;
others are halved, until one is left at whose end the load is not held. There Newton's method on
the certified distance, the derivative of which is that of the load along the normal, finds the
instant.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.feet_hold import Holder, closest, size_of
from limitsurf.kernels.load_table import VARIES, Load, load_at, piece_of, turned
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = ["exit_time", "is_held", "start_moving"]

_SHORT, _SHORTEST = 1.0 / 32.0, 1.0 / 4096.0  # of a piece


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
def _holds_all(holder: Holder, push: Vector, theta: float, points: Floats) -> bool:
    r"""Return whether all loads in the convex hull of points (3, K) are held, if one solve can say.

    They are within R of one of them, F, and loads within r of zero are held. If :math:`(1+\beta) F`
    is held, so are those within :math:`r \beta / (1 + \beta)` of F, for the sum is convex.
    """
    n, r = points.shape[1], holder.numbers[8]
    ratio = holder.numbers[6] / holder.numbers[7]
    fx, fy, m = points[0, n // 2], points[1, n // 2], points[2, n // 2]
    far2 = 0.0
    for k in range(n):
        dx, dy, dm = points[0, k] - fx, points[1, k] - fy, points[2, k] - m
        far2 = max(far2, dx * dx + dy * dy + ratio * dm * dm)
    far = math.sqrt(far2)
    if far >= r:
        return False
    F = along(turned((fx, fy, m), theta), 1.0, push)
    return _is_zero(closest(holder, scaled(r / (r - far), F))[0])


@compiled
def _root(holder: Holder, load: Load, push: Vector, theta: float, low: float, high: float) -> float:
    """Return the first instant at which a load held at `low` but not at `high` is not."""
    width = high - low
    for _ in range(80):
        F, dF = load_at(load, high)
        a = closest(holder, along(turned(F, theta), 1.0, push))[0]
        size = size_of(holder, a)
        slope = dot(a, turned(dF, theta)) / (holder.numbers[6] * size)
        step = size / slope if slope > 0.0 else high - low
        if step <= 1e-4 * width:
            return high - step  # Newton's last step, wrong by its square, of a width that is small
        guess, share = (high - step if step < high - low else 0.5 * (low + high)), 0.01
        while is_held(holder, load, push, theta, guess):
            low, guess = guess, guess + share * (high - guess)
            share = min(4.0 * share, 0.5)
            if high - low <= 1e-12 * width:
                return high
        high = guess
    return high


@compiled
def exit_time(holder: Holder, load: Load, push: Vector, theta: float, t: float) -> float:
    """Return when a load that is held at a time is first not held; infinity if that is never."""
    if load.kind != VARIES:
        return np.inf
    n, pieces = load.terms, load.pieces
    control, ends = np.empty((15, 3, n)), np.empty(15)
    for i in range(piece_of(load, t), pieces.shape[0]):
        begin, whole = pieces[i, 0], pieces[i, 1] - pieces[i, 0]
        control[0] = pieces[i, 2 + 3 * n :].reshape(3, n)
        if t > begin:
            _split(control, 0, (t - begin) / whole)
            begin = t
        depth, ends[0] = 0, pieces[i, 1]
        while depth >= 0:
            end = ends[depth]
            width = (end - begin) / whole
            if _holds_all(holder, push, theta, control[depth]):
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
