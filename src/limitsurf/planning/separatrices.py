r"""Borders of the basins in a squeeze field: the stable manifolds of its saddles.

In the plane of orientation phi and offset z, every unstable orientation on the median is a saddle
of the gradient flow. The two motions that end in it, followed backwards until the line is clear of
the part, separate the starts that come to rest on its left and on its right. Near the saddle they
leave along the direction that the gradient maps to itself; a power iteration finds it, which also
holds where second derivatives jump. Errors across the curve decay backwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from limitsurf.errors import SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.kernels.squeeze_flow import STABLE, flow_rate, flow_to, flow_trace
from limitsurf.planning.ideal_squeeze import as_mobility_ratio, turning_mobility
from limitsurf.planning.squeeze_function import squeeze_function
from limitsurf.planning.turn_function import turn_function
from limitsurf.sets.arguments import writable

__all__ = ["Separatrix", "boundary_shift", "separatrices"]

Array = NDArray[np.float64]

_STEP_ERROR = 1e-11
_DEPARTURE = 1e-6  # from the saddle: the curve bends off its tangent by the square of this
_POWER_STEPS = 200
_NO_TURN = 1e-24  # product of rates at which a change of sign is rounding
_NUDGE = 1e-9  # moves of the start, and errors of a step, that must not move the end by more than
_SENSITIVE = 1e-7  # rad

_Z, _ANGLE, _Z_RATE, _ANGLE_RATE = 1, 2, 3, 4  # columns of a trace


@dataclass(frozen=True, eq=False)
class Separatrix:
    """All starts that come to rest at one unstable orientation.

    Attributes
    ----------
    part : Part
        The part.
    mobility_ratio : float
        See `IdealSqueeze`.
    saddle : (float, float)
        Offset of the median [m] and the unstable orientation [rad].
    branches : tuple of (m, 5) float
        The two halves, outwards from the saddle, towards negative and positive offsets first; rows
        ``(time, z, theta, z', theta')`` in units of a part of area 1, backwards in time.
    """

    part: Part
    mobility_ratio: float
    saddle: tuple[float, float]
    branches: tuple[Array, Array]

    @cached_property
    def _nodes(self) -> Array:
        unit = self.part.area**0.5
        rows = np.vstack([self.branches[0][::-1], self.branches[1]])
        return np.column_stack([unit * rows[:, _Z], -rows[:, _ANGLE]])

    @property
    def offsets(self) -> Array:
        """Offsets (m,) along the curve, from the end on the side of the first branch [m]."""
        return self._nodes[:, 0]

    @property
    def orientations(self) -> Array:
        """Orientations (m,) at `offsets`, not reduced [rad]."""
        return self._nodes[:, 1]

    @property
    def ends(self) -> tuple[float, float]:
        """Orientations at which the line is clear of the part: part left of it, part right."""
        return float(self.orientations[0]), float(self.orientations[-1])

    @property
    def extremes(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Points (offset, orientation) of the least and of the largest orientation."""
        low, high = np.argmin(self.orientations), np.argmax(self.orientations)
        return _pair(self._nodes[low]), _pair(self._nodes[high])

    def crossings(self, offset: float) -> Array:
        """Return the orientations at which the curve has an offset [m], from end to end."""
        z = offset / self.part.area**0.5
        found = [self._crossings(k, z)[::way] for k, way in ((0, -1), (1, 1))]
        near = np.array([branch[0] for branch in self.branches])
        astride = (near[0, _Z] > z) != (near[1, _Z] > z)
        between = [self._near_saddle(near, z)] if astride else []
        return -np.array([*found[0], *between, *found[1]])

    def _crossings(self, branch: int, z: float) -> list[float]:
        rows = self.branches[branch]
        sides = rows[:, _Z] > z
        found = [
            _event(self.part, self.mobility_ratio, rows[k : k + 2], _Z, z)[_ANGLE]
            for k in np.flatnonzero(sides[1:] != sides[:-1])
        ]
        if sides[-1] != (branch == 1):  # beyond the end: there the part moves, but does not turn
            found.append(rows[-1, _ANGLE])
        return [float(angle) for angle in found]

    def _near_saddle(self, near: Array, z: float) -> float:
        """Return where the straight pieces through the saddle have the offset z."""
        points = np.array([near[0], near[0], near[1]])[:, [_Z, _ANGLE]]
        points[1] = self.saddle[0] / self.part.area**0.5, -self.saddle[1]
        return float(np.interp(z, points[:, 0], points[:, 1]))

    def __repr__(self) -> str:
        """Return the saddle and how far the curve strays from it."""
        low, high = (float(np.degrees(point[1] - self.saddle[1])) for point in self.extremes)
        at = float(np.degrees(self.saddle[1]))
        return f"Separatrix(of {at:.2f} deg, strays by {low:.3g} to {high:.3g} deg)"


def separatrices(part: Part, mobility_ratio: float = 1.0) -> list[Separatrix]:
    """Return the separatrix of each unstable orientation in [0, pi), ascending.

    Those of the orientations beyond follow from the symmetry ``(z, phi) -> (-z, phi + pi)``. A
    neutral part has none.

    Parameters
    ----------
    part : Part
        The part.
    mobility_ratio : float
        See `IdealSqueeze`; with 0 the curves are straight: the offset does not matter.

    Raises
    ------
    SolveFailed
        A curve does not lead from one side of the part to the other: so strongly do sliding and
        turning interact that the basins are no longer one beside the other.

    Examples
    --------
    >>> card = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> separatrices(card)
    [Separatrix(of 90.00 deg, strays by 0 to 0 deg)]
    """
    ratio = as_mobility_ratio(mobility_ratio)
    saddles = squeeze_function(turn_function(part)).breaks
    offsets = squeeze_states(writable(part.unit_edges), -saddles, 0.5)[:, 0]
    return [
        _separatrix(part, ratio, float(z), float(phi))
        for z, phi in zip(offsets, saddles, strict=True)
    ]


def boundary_shift(part: Part, mobility_ratio: float = 1.0) -> float:
    """Return how far the starting offset can move the border of a basin [rad].

    A plan for the model ``"squeeze"`` whose margins exceed this works under full motion, from any
    offset: pass it to `plan_alignment` as `min_margin`. Zero for a neutral part.

    Parameters
    ----------
    part, mobility_ratio : Part, float
        See `separatrices`, also for the errors.

    Examples
    --------
    >>> t = Part([(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)])
    >>> float(np.degrees(boundary_shift(t)).round(2))
    14.36
    """
    strays = [
        abs(phi - curve.saddle[1])
        for curve in separatrices(part, mobility_ratio)
        for _, phi in curve.extremes
    ]
    return max(strays, default=0.0)


def _separatrix(part: Part, ratio: float, z: float, phi: float) -> Separatrix:
    if ratio == 0.0:
        lower, upper = _straight(part, z, phi)
    else:
        lower, upper = (_branch(part, ratio, z, -phi, way) for way in (-1.0, 1.0))
    if not lower[-1, _Z] < 0.0 < upper[-1, _Z]:
        raise SolveFailed(
            f"the separatrix of {np.degrees(phi):.4g} deg returns to the side that it came from; "
            "use a smaller mobility_ratio"
        )
    return Separatrix(part, ratio, (z * part.area**0.5, phi), (lower, upper))


def _straight(part: Part, z: float, phi: float) -> tuple[Array, Array]:
    """Return the two halves where the part moves onto its median before it turns."""
    reach = part.circumradius / part.area**0.5
    lower, upper = (
        np.array([[0.0, z, -phi, 0.0, 0.0], [1.0, end, -phi, 0.0, 0.0]]) for end in (-reach, reach)
    )
    return lower, upper


def _branch(part: Part, ratio: float, z: float, theta: float, way: float) -> Array:
    """Return one half, with rows added where offset or orientation turn back."""
    edges, kappa = writable(part.unit_edges), turning_mobility(part, ratio)
    towards = _departure(edges, kappa**0.5, z, theta, way)
    across = _NUDGE * np.array([-towards[1], towards[0]])
    start = np.array([z, theta]) + _DEPARTURE * towards
    rows, left, right = (
        _trace(edges, kappa, start + nudge, error)
        for nudge, error in ((0.0, _STEP_ERROR), (across, _NUDGE), (-across, _NUDGE))
    )
    off = max(abs(rows[-1, _ANGLE] - side[-1, _ANGLE]) for side in (left, right))
    if off > _SENSITIVE:
        raise SolveFailed(
            f"the separatrix of {np.degrees(-theta):.4g} deg hangs on rounding: a start off by "
            f"{_NUDGE:g} moves its end by {np.degrees(off):.2g} deg; use a smaller mobility_ratio"
        )
    turns = [
        _event(part, ratio, rows[k : k + 2], column, 0.0)
        for column in (_Z_RATE, _ANGLE_RATE)
        for k in np.flatnonzero(rows[1:, column] * rows[:-1, column] < -_NO_TURN)
    ]
    merged = np.array([*rows, *turns])
    return merged[np.argsort(merged[:, 0], kind="stable")]


def _trace(edges: Array, kappa: float, start: Array, error: float) -> Array:
    rows, status = flow_trace(edges, kappa, -1.0, start, error)
    if status != STABLE:
        raise SolveFailed(f"the separatrix of {np.degrees(-start[1]):.4g} deg ends nowhere")
    return np.asarray(rows)


def _departure(edges: Array, root: float, z: float, theta: float, way: float) -> Array:
    """Return the unit direction ``(z, theta)`` in which the gradient grows outwards."""
    zz, zq, qq = flow_rate(edges, root, z, theta / root)[4:]
    middle, half = 0.5 * (zz + qq), np.hypot(0.5 * (zz - qq), zq)
    shift = max(0.0, half - middle)  # makes the other eigenvalue zero
    v = np.array([way, 0.0])
    scale = np.array([1.0, root])
    for _ in range(_POWER_STEPS):
        at = flow_rate(edges, root, z + _DEPARTURE * v[0], theta / root + _DEPARTURE * v[1])
        grown = shift * v + np.array(at[2:4]) / _DEPARTURE
        before, v = v, grown / np.hypot(*grown)
        if np.abs(v - before).max() < 1e-12:
            break
    return np.asarray(scale * v)


def _event(part: Part, ratio: float, rows: Array, column: int, value: float) -> Array:
    """Return the row between two at which a column has a value: a shorter step from the first."""
    edges, kappa = writable(part.unit_edges), turning_mobility(part, ratio)
    if np.array_equal(rows[0, _ANGLE:], rows[1, _ANGLE:]):  # straight: at rest or beyond the part
        return np.asarray(rows[0])
    length = rows[1, 0] - rows[0, 0]

    def row(h: float) -> Array:
        if h <= 0.0:
            return np.asarray(rows[0])
        return np.array([rows[0, 0] + h, *flow_to(edges, kappa, -1.0, rows[0, 1:3].copy(), h)])

    def excess(h: float) -> float:
        return float((rows[1] if h == length else row(h))[column]) - value

    return row(brentq(excess, 0.0, length, xtol=1e-15, rtol=1e-14))


def _pair(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])
