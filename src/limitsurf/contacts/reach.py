"""The outline of the mean frictions that an oscillating tip can have up to a contact speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_number
from limitsurf.sets.flat_outline import ring_outline

__all__ = ["reach_outline"]

Array = NDArray[np.float64]

_FIRST, _ROUNDS = 64, 24


class _Tip(Protocol):
    @property
    def direction(self) -> Array: ...
    @property
    def offset(self) -> Array: ...
    @property
    def radius(self) -> Array: ...
    @property
    def passive_radius(self) -> Array: ...
    def gradient(self, u: ArrayLike) -> Array: ...


def reach_outline(tip: _Tip, speed: float, tol: float) -> shapely.Geometry:
    """Return ``{-grad Phi(u) : |u| <= speed}`` as a polygon.

    The gradient of a convex function does not fold the plane: the border is the image of the
    circle ``|u| = speed``. Angles are halved until images halfway lie within ``tol mu mean(N)`` of
    the chords; one side of the tip's line is the mirror image of the other.
    """
    if not (np.isfinite(as_number("speed", speed)) and speed >= 0.0):
        raise InputError("speed", "must be at least 0", value=speed)
    if not 1e-12 <= as_number("tol", tol) < 1.0:
        raise InputError("tol", "must lie between 1e-12 and 1", value=tol)
    e, size = tip.direction, float(tip.passive_radius)
    frame = np.stack([e, np.array([-e[1], e[0]])])

    def image(angle: Array) -> Array:
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        if speed == 0.0:
            return np.asarray(frame @ tip.offset + float(tip.radius) * circle)
        return np.asarray(-tip.gradient(speed * circle @ frame) @ frame.T)

    upper = _refined(image, tol * size)
    ring = np.concatenate([upper, upper[-2:0:-1] * [1.0, -1.0]]) @ frame
    return ring_outline(ring, 1e-12 * size)


def _refined(image: Callable[[Array], Array], tol: float) -> Array:
    """Return images of angles from 0 to pi, close enough together."""
    angle = np.linspace(0.0, np.pi, _FIRST + 1)
    points, unsure = image(angle), np.ones(_FIRST, dtype=bool)
    for _ in range(_ROUNDS):
        at = np.flatnonzero(unsure)
        halfway = 0.5 * (angle[at] + angle[at + 1])
        between = image(halfway)
        bent = _off_chord(between, points[at], points[at + 1]) > tol
        if not bent.any():
            break
        new = at[bent] + 1
        angle = np.insert(angle, new, halfway[bent])
        points = np.insert(points, new, between[bent], axis=0)
        first = new + np.arange(len(new))  # where the new ones are now
        unsure = np.zeros(len(angle) - 1, dtype=bool)
        unsure[first - 1] = unsure[first] = True
    return points


def _off_chord(point: Array, start: Array, end: Array) -> Array:
    """Return the distances of points from segments."""
    along, to = end - start, point - start
    length2 = np.maximum((along**2).sum(axis=1), 1e-300)
    share = np.clip((to * along).sum(axis=1) / length2, 0.0, 1.0)
    return np.asarray(np.linalg.norm(to - share[:, None] * along, axis=1))
