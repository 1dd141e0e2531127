r"""The turn function of a part squeezed towards a line, exact (paper, Definition 4).

With theta the direction of the line in the part's frame and phi = -theta the part's orientation
while the line lies at world angle 0, the part turns with the sign of dU/dtheta at theta = -phi:
it descends the potential U. Both are taken modulo pi, since the line has no direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.median_cell import START
from limitsurf.kernels.median_events import median_events
from limitsurf.kernels.median_states import median_states
from limitsurf.kernels.steepest_turn import steepest_turn
from limitsurf.kernels.turn_roots import slope_signs
from limitsurf.planning.median_pieces import MedianPiece, crossed_in_the_middle, median_pieces
from limitsurf.planning.turn_certificate import TurnCertificate, changes_in_cells
from limitsurf.sets.arguments import as_instance, as_number, as_numbers
from limitsurf.tolerances import FLAT_MOMENT, NEUTRAL

__all__ = ["TurnFunction", "turn_function"]

Array = NDArray[np.float64]

_WRAP = 2e-15  # rad; this far below pi is 0
_GAP = 1e-6  # chord, at area 1, of a median that may lie anywhere between two halves


@dataclass(frozen=True, eq=False, repr=False)
class TurnFunction:
    r"""Which way a part turns between two half-planes that push it towards a line.

    Built by `turn_function`. Orientations are reduced to [0, pi).

    Attributes
    ----------
    part : Part
        The part.
    stable, unstable : (k,) float
        Orientations of stable and unstable equilibrium, ascending [rad]; as many of one as of the
        other, none of either if the moment is rounding at every orientation.
    cells : (m, 6) float
        The directions, covered by cells that bound the moment: what `certificate` is drawn from
        (rows of `limitsurf.kernels.turn_roots.slope_signs`).
    neutral_angle : float
        A part with a smaller critical angle counts as neutral [rad].
    """

    part: Part
    stable: Array
    unstable: Array
    cells: Array
    neutral_angle: float = NEUTRAL

    def __call__(self, phi: ArrayLike) -> NDArray[np.int64]:
        """Return 1 where the part turns counter-clockwise, -1 clockwise, 0 in equilibrium."""
        slope = self._states(phi)[..., 2]
        return np.where(np.abs(slope) <= _rounding(self.part), 0, np.sign(slope)).astype(np.int64)

    def potential(self, phi: ArrayLike) -> Array:
        """Return ``U = integral |distance to the median| dA`` [m^3], for unit force per area."""
        return self._states(phi)[..., 1] * self._unit

    def moment(self, phi: ArrayLike) -> Array:
        """Return ``dU/dtheta`` at theta = -phi [m^3]: the moment that turns the part."""
        return self._states(phi)[..., 2] * self._unit

    def curvature(self, phi: ArrayLike) -> Array:
        """Return ``U'' = 2 J - U`` [m^3]; positive at a stable orientation."""
        states = self._states(phi)
        return (2 * states[..., 3] - states[..., 1]) * self._unit

    def median(self, phi: float) -> tuple[float, shapely.Geometry]:
        """Return the median's offset from the centroid [m] and its chords in the part's frame [m].

        The offset counts along ``n = (-sin theta, cos theta)``, theta = -phi.
        """
        theta = -as_number("phi", phi)
        reversals = np.floor((theta - START) / np.pi)
        offset = float(self._states(phi)[..., 0]) * self.part.area**0.5 * (-1.0) ** reversals
        along = np.array([np.cos(theta), np.sin(theta)])
        middle = np.asarray(self.part.centroid) + offset * np.array([-along[1], along[0]])
        reach = 2.0 * self.part.circumradius
        line = shapely.LineString([middle - reach * along, middle + reach * along])
        return offset, shapely.intersection(line, self.part.polygon)

    def _states(self, phi: ArrayLike) -> Array:
        """Return ``(z, U, U', J, chord length, s_m)`` at area 1 along a new last axis."""
        angles = as_numbers("phi", phi)
        theta = _from_start(-angles.ravel())
        order = np.argsort(theta)
        states = np.empty((theta.size, 6))
        states[order] = median_states(*_unit_part(self.part), theta[order])
        return states.reshape(*angles.shape, 6)

    @property
    def _unit(self) -> float:
        """U of a part of area 1 in m^3."""
        return float(self.part.area**1.5)

    @property
    def symmetry_order(self) -> int:
        """Order of the part's rotational symmetry."""
        return self.part.symmetry_order

    @property
    def neutral(self) -> bool:
        """True if the part is in equilibrium at every orientation, like a disk, in practice.

        Forces off by `neutral_angle` are enough to turn it from any orientation to any other.
        """
        return self.critical_angle < self.neutral_angle

    @cached_property
    def critical_angle(self) -> float:
        """Error of the force direction [rad] beyond which no equilibrium is left.

        Forces off by eps give the moment ``cos(eps) U' - sin(eps) U``, which has no zero once
        ``|tan eps| > max |U'/U|``.
        """
        return float(np.arctan(steepest_turn(*_unit_part(self.part))[0]))

    @cached_property
    def certificate(self) -> TurnCertificate:
        """Why the equilibria are all there are."""
        found = np.concatenate([self.stable, self.unstable])
        cover = changes_in_cells(self.cells)
        residual = float(np.abs(self._states(found)[:, 2]).max(initial=0.0))
        return TurnCertificate(len(found), cover.bound, cover.unresolved, cover.widest, residual)

    @cached_property
    def breakpoints(self) -> Array:
        """Orientations at which the median passes through a vertex, ascending [rad]."""
        return np.array([piece.left for piece in self.pieces])

    @cached_property
    def pieces(self) -> list[MedianPiece]:
        """Intervals of orientations in which the median crosses the same edges.

        A vertex within 1e-12 of the line, relative to the part's size, may be put on either side.
        Where the median is not unique, between two pieces of equal area, any of them counts.
        """
        theta, vertex, side = median_events(*_unit_part(self.part))
        order = np.argsort(theta)
        edges = self.part.unit_edges
        pieces = median_pieces(edges, theta[order], vertex[order], side)
        chords = self._states([0.5 * (piece.left + piece.right) for piece in pieces])[:, 4]
        return pieces if chords.min() > _GAP else crossed_in_the_middle(edges, pieces)

    def __repr__(self) -> str:
        """Return the equilibria in degrees."""
        if self.neutral:
            return f"TurnFunction(neutral, of {self.part!r})"
        stable = ", ".join(f"{angle:.2f}" for angle in np.degrees(self.stable))
        return f"TurnFunction(stable at {stable} deg, of {self.part!r})"


def turn_function(part: Part, *, neutral_angle: float = NEUTRAL) -> TurnFunction:
    r"""Return the exact turn function of a part.

    Stable orientations are the strict local minima of the reduced potential
    ``U(theta) = min_z integral |n.x - z| dA``, which obeys ``U'' + U = 2 J``; see
    ``docs/planning.md``. Zeros of U' with one sign on both sides are no equilibria (Lemma 6).

    Parameters
    ----------
    part : Part
        Any outline: convex or not, with holes, of several pieces.
    neutral_angle : float
        A part whose critical angle is below this counts as neutral [rad].

    Returns
    -------
    TurnFunction

    Raises
    ------
    InputError
        No `Part`; `neutral_angle` is negative or not finite.

    Examples
    --------
    A square comes to rest on its diagonals:

    >>> turn = turn_function(Part([(0, 0), (1, 0), (1, 1), (0, 1)]))
    >>> [round(float(a), 6) for a in turn.stable]
    [0.785398, 2.356194]
    >>> turn.certificate.complete
    True
    """
    if not (np.isfinite(neutral_angle) and neutral_angle >= 0.0):
        raise InputError("neutral_angle", "must be at least 0 rad", value=neutral_angle)
    as_instance("part", part, Part, remedy="make one of the outline: Part(outline)")
    cells, _ = slope_signs(*_unit_part(part), _rounding(part))
    found = changes_in_cells(cells)
    return TurnFunction(
        part, _orientations(found.rising), _orientations(found.falling), cells, neutral_angle
    )


def _unit_part(part: Part) -> tuple[Array, float]:
    """Return the edges of the part scaled to area 1, and its circumradius."""
    return part.unit_edges, part.circumradius / part.area**0.5


def _rounding(part: Part) -> float:
    """Return the size of U' at area 1 that is rounding: of the largest terms, of many terms."""
    radius = float(part.circumradius / part.area**0.5)
    terms = 0.1 * float(np.sqrt(len(part.edges)))
    return FLAT_MOMENT * max(1.0, radius) * max(1.0, terms)


def _from_start(theta: Array) -> Array:
    """Return directions reduced to [START, START + pi)."""
    return np.minimum(START + np.mod(theta - START, np.pi), np.nextafter(START + np.pi, 0.0))


def _orientations(theta: Array) -> Array:
    """Return ``-theta`` reduced to [0, pi), ascending."""
    phi = np.mod(-theta, np.pi)
    phi[np.pi - phi < _WRAP] = 0.0
    return np.sort(phi)
