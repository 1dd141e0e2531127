r"""The turn function of a part squeezed towards a line, exact (paper, Definition 4).

With theta the direction of the line in the part's frame and phi = -theta the part's orientation
while the line lies at world angle 0, the part turns with the sign of dU/dtheta at theta = -phi:
it descends the potential U. Both are taken modulo pi, since the line has no direction.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize_scalar

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.planning.analytic_roots import analytic_roots
from limitsurf.planning.median_events import median_events
from limitsurf.tolerances import ANGLE, FLAT_MOMENT

__all__ = ["TurnFunction", "turn_function"]

Array = NDArray[np.float64]

_HALF = 0.5  # of the area 1 to which parts are scaled


@dataclass(frozen=True, eq=False)
class TurnFunction:
    r"""Which way a part turns between two half-planes that push it towards a line.

    Built by `turn_function`. Orientations are reduced to [0, pi).

    Attributes
    ----------
    part : Part
        The part.
    stable, unstable : (k,) float
        Orientations of stable and unstable equilibrium, ascending [rad]; as many of one as of the
        other, none of either if the part is neutral.
    breakpoints : (b,) float
        Orientations at which the median passes through a vertex, ascending [rad].
    neutral : bool
        True if the part is in equilibrium at every orientation, like a disk.
    """

    part: Part
    stable: Array
    unstable: Array
    breakpoints: Array
    neutral: bool

    def __call__(self, phi: ArrayLike) -> NDArray[np.int64]:
        """Return 1 where the part turns counter-clockwise, -1 clockwise, 0 in equilibrium."""
        slope = _column(self.part, phi, 2)
        return np.where(np.abs(slope) <= FLAT_MOMENT, 0, np.sign(slope)).astype(np.int64)

    def potential(self, phi: ArrayLike) -> Array:
        """Return ``U = integral |distance to the median| dA`` [m^3], for unit force per area."""
        return _column(self.part, phi, 1) * self._unit

    def moment(self, phi: ArrayLike) -> Array:
        """Return ``dU/dtheta`` at theta = -phi [m^3]: the moment that turns the part."""
        return _column(self.part, phi, 2) * self._unit

    def curvature(self, phi: ArrayLike) -> Array:
        """Return ``U'' = 2 J - U`` [m^3]; positive at a stable orientation."""
        return (2 * _column(self.part, phi, 3) - _column(self.part, phi, 1)) * self._unit

    def median(self, phi: float) -> tuple[float, shapely.Geometry]:
        """Return the median's offset from the centroid [m] and its chords in the part's frame [m].

        The offset counts along ``n = (-sin theta, cos theta)``, theta = -phi.
        """
        offset = float(_column(self.part, phi, 0)) * self.part.area**0.5
        theta = -float(phi)
        along = np.array([np.cos(theta), np.sin(theta)])
        middle = np.asarray(self.part.centroid) + offset * np.array([-along[1], along[0]])
        reach = 2.0 * self.part.circumradius
        line = shapely.LineString([middle - reach * along, middle + reach * along])
        return offset, shapely.intersection(line, self.part.polygon)

    @property
    def _unit(self) -> float:
        """U of a part of area 1 in m^3."""
        return float(self.part.area**1.5)

    @property
    def symmetry_order(self) -> int:
        """Order of the part's rotational symmetry."""
        return self.part.symmetry_order

    @cached_property
    def critical_angle(self) -> float:
        """Error of the force direction [rad] beyond which no equilibrium is left.

        Forces off by eps give the moment ``cos(eps) U' - sin(eps) U``, which has no zero once
        ``|tan eps| > max |U'/U|``.
        """

        def negative_ratio(phi: float) -> float:
            _, energy, slope, *_ = _states(self.part, phi)[0]
            return -abs(float(slope / energy))

        grid = np.linspace(0.0, np.pi, 721)
        states = _states(self.part, grid)
        best = int(np.argmax(np.abs(states[:, 2] / states[:, 1])))
        step = grid[1]
        found = minimize_scalar(
            negative_ratio, bounds=(grid[best] - step, grid[best] + step), method="bounded"
        )
        return float(np.arctan(-found.fun))

    def __repr__(self) -> str:
        """Return the equilibria in degrees."""
        if self.neutral:
            return f"TurnFunction(neutral, of {self.part!r})"
        stable = ", ".join(f"{angle:.2f}" for angle in np.degrees(self.stable))
        return f"TurnFunction(stable at {stable} deg, of {self.part!r})"


def turn_function(part: Part) -> TurnFunction:
    r"""Return the exact turn function of a part.

    Stable orientations are the strict local minima of the reduced potential
    ``U(theta) = min_z integral |n.x - z| dA``, which obeys ``U'' + U = 2 J``; see
    ``docs/planning.md``. Zeros of U' with one sign on both sides are no equilibria (Lemma 6).

    Parameters
    ----------
    part : Part
        Any outline: convex or not, with holes, of several pieces.

    Returns
    -------
    TurnFunction

    Examples
    --------
    A square comes to rest on its diagonals:

    >>> turn = turn_function(Part([(0, 0), (1, 0), (1, 1), (0, 1)]))
    >>> [round(float(a), 6) for a in turn.stable]
    [0.785398, 2.356194]
    """
    edges = part.unit_edges
    events = median_events(edges, _HALF)

    def slope(theta: Array) -> Array:
        values: Array = squeeze_states(edges, theta, _HALF)[:, 2]
        return values

    knots = np.concatenate([events, events[:1] + np.pi])
    candidates = [
        root
        for a, b in itertools.pairwise(knots)
        if b - a > 1e-13
        for root in analytic_roots(slope, a, b)
    ]
    rising, falling, neutral = _sign_changes(slope, np.concatenate([events, candidates]))
    return TurnFunction(
        part=part,
        stable=_orientations(rising),
        unstable=_orientations(falling),
        breakpoints=_orientations(events),
        neutral=neutral,
    )


def _sign_changes(
    slope: Callable[[Array], Array], points: Array
) -> tuple[list[float], list[float], bool]:
    """Return where `slope` (of period pi) changes from - to +, from + to -, and if it is zero.

    `points` hold every place where the sign may change; between them it is constant, so one test
    in each gap decides. Gaps in which the slope is rounding are passed over.
    """
    partition = np.unique(np.mod(points, np.pi))
    partition = partition[np.diff(partition, prepend=-1.0) > 1e-13]
    tests = partition + 0.5 * np.diff(partition, append=partition[0] + np.pi)
    values = slope(tests)
    clear = np.abs(values) > FLAT_MOMENT
    if not clear.any():
        return [], [], True
    tests, signs = tests[clear], np.sign(values[clear])
    rising: list[float] = []
    falling: list[float] = []
    for k in range(len(tests)):
        a, b = tests[k - 1] - (np.pi if k == 0 else 0.0), tests[k]
        if signs[k] != signs[k - 1]:
            root = brentq(
                lambda theta: float(slope(np.array([theta]))[0]), a, b, xtol=1e-15, rtol=1e-15
            )
            (rising if signs[k] > 0 else falling).append(root)
    return rising, falling, False


def _orientations(theta: ArrayLike) -> Array:
    """Return ``-theta`` reduced to [0, pi), ascending."""
    phi = np.mod(-np.asarray(theta, dtype=np.float64), np.pi)
    phi[np.pi - phi < ANGLE * 1e-3] = 0.0
    return np.sort(phi)


def _states(part: Part, phi: ArrayLike) -> Array:
    theta = np.mod(-np.atleast_1d(np.asarray(phi, dtype=np.float64)).ravel(), np.pi)
    states: Array = squeeze_states(part.unit_edges, theta, _HALF)
    return states


def _column(part: Part, phi: ArrayLike, column: int) -> Array:
    values: Array = _states(part, phi)[:, column].reshape(np.shape(phi))
    # the offset changes sign with the direction of the line, the other columns do not
    flipped = np.mod(np.floor(-np.asarray(phi, dtype=np.float64) / np.pi), 2) == 1
    return np.where(flipped, -values, values) if column == 0 else values
