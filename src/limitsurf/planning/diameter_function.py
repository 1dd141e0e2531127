r"""The diameter function of a part between two frictionless parallel jaws (Goldberg).

With theta the direction of the jaws in the part's frame, ``u = (cos theta, sin theta)``,
``n = (-sin theta, cos theta)`` and h the support function of the part, the jaws are

.. math:: w(\theta) = h(n) + h(-n) = n\cdot(p - q)

apart, where p and q are the vertices they touch. Between two directions in which an edge lies
flush, ``w' = -u.(p - q)`` and ``w'' = -w``; there w' jumps up by the length of the edge. So all
minima are corners of w, with an edge flush, and all maxima are smooth, with p - q along n. The
orientation is phi = -theta while the jaws lie at world angle 0; the part turns so that w falls.
Reference: K. Goldberg, Orienting polygonal parts without sensors, Algorithmica 10, 1993.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.geometry.part import Part
from limitsurf.planning.calipers import Calipers
from limitsurf.sets.arguments import as_instance, as_number, as_numbers
from limitsurf.tolerances import ANGLE, NEUTRAL

__all__ = ["DiameterFunction", "DiameterPiece", "diameter_function"]

Array = NDArray[np.float64]

_SAME = 1e-12  # rad; edges on both sides that are parallel differ by rounding


class DiameterPiece(NamedTuple):
    """Orientations ``[left, right)`` in which the jaws touch two vertices.

    `left` is reduced to [0, pi) [rad]; `upper` and `lower` are the vertices on the left and on the
    right of the jaws' direction, from the part's centroid [m].
    """

    left: float
    right: float
    upper: Array
    lower: Array


@dataclass(frozen=True, eq=False)
class DiameterFunction:
    r"""Which way a part turns between two frictionless parallel jaws that close.

    Built by `diameter_function`; has what a `TurnFunction` has, with the width w of the part in
    place of the potential U. Orientations are reduced to [0, pi). At an orientation with an edge
    flush, where w' jumps, values are those just after it.

    Attributes
    ----------
    part : Part
        The part.
    stable, unstable : (k,) float
        Orientations of stable and unstable equilibrium, ascending [rad]; as many of one as of the
        other, none of either if the part is neutral.
    breakpoints : (b,) float
        Orientations at which an edge of the convex hull lies flush, ascending [rad].
    neutral : bool
        True if the part has the same width everywhere, like a Reuleaux triangle.
    calipers : Calipers
        The convex hull.
    """

    part: Part
    stable: Array
    unstable: Array
    breakpoints: Array
    neutral: bool
    calipers: Calipers

    def __call__(self, phi: ArrayLike) -> NDArray[np.int64]:
        """Return 1 where the part turns counter-clockwise, -1 clockwise, 0 in equilibrium."""
        orientation = as_numbers("phi", phi)
        if self.neutral:
            return np.zeros(orientation.shape, dtype=np.int64)
        off = np.subtract.outer(orientation, np.concatenate([self.stable, self.unstable]))
        at_rest = (np.abs(off - np.pi * np.round(off / np.pi)) <= _SAME).any(axis=-1)
        return np.where(at_rest, 0, np.sign(self.moment(orientation))).astype(np.int64)

    def potential(self, phi: ArrayLike) -> Array:
        """Return the distance w of the jaws [m]: the work of a unit force that closes them."""
        return self._across(phi)[0]

    def moment(self, phi: ArrayLike) -> Array:
        """Return ``dw/dtheta`` at theta = -phi [m]: the moment of a unit force."""
        return self._across(phi)[1]

    def curvature(self, phi: ArrayLike) -> Array:
        """Return ``w'' = -w`` [m], for orientations at which no edge lies flush."""
        return -self._across(phi)[0]

    def _across(self, phi: ArrayLike) -> tuple[Array, Array]:
        """Return w and w'."""
        theta = -as_numbers("phi", phi)
        upper, lower = self.calipers.touched(theta)
        return _width(theta, upper - lower)

    def median(self, phi: float) -> tuple[float, shapely.Geometry]:
        """Return the middle line's offset from the centroid [m] and its chords in the part [m].

        The offset counts along ``n = (-sin theta, cos theta)``, theta = -phi; the chords are in the
        frame of the outline.
        """
        theta = -as_numbers("phi", as_number("phi", phi))
        along = np.array([np.cos(theta), np.sin(theta)])
        across = np.array([-along[1], along[0]])
        upper, lower = self.calipers.touched(theta)
        offset = 0.5 * float(across @ (upper + lower))
        middle = np.asarray(self.part.centroid) + offset * across
        reach = 2.0 * self.part.circumradius
        line = shapely.LineString([middle - reach * along, middle + reach * along])
        return offset, shapely.intersection(line, self.part.polygon)

    @cached_property
    def pieces(self) -> list[DiameterPiece]:
        """The intervals between breakpoints, ascending, with the vertices that are touched."""
        left = self.breakpoints
        right = np.append(left[1:], left[:1] + np.pi)
        upper, lower = self.calipers.touched(-0.5 * (left + right))
        return [
            DiameterPiece(float(a), float(b), p, q)
            for a, b, p, q in zip(left, right, upper, lower, strict=True)
        ]

    @property
    def symmetry_order(self) -> int:
        """Order of the part's rotational symmetry."""
        return self.part.symmetry_order

    @cached_property
    def critical_angle(self) -> float:
        """Error of the force direction [rad] beyond which no equilibrium is left.

        Forces off by eps give the moment ``cos(eps) w' - sin(eps) w``. Since ``w'/w`` falls between
        breakpoints, it is largest in size at one of them.
        """
        return _critical_angle(*_piece_ends(self.calipers, _flush(self.calipers)))

    def __repr__(self) -> str:
        """Return the equilibria in degrees."""
        if self.neutral:
            return f"DiameterFunction(neutral, of {self.part!r})"
        stable = ", ".join(f"{angle:.2f}" for angle in np.degrees(self.stable))
        return f"DiameterFunction(stable at {stable} deg, of {self.part!r})"


def diameter_function(part: Part) -> DiameterFunction:
    """Return the diameter function of a part between frictionless parallel jaws, exact.

    Parameters
    ----------
    part : Part
        Any outline; the jaws touch its convex hull. O(n log n) for n vertices.

    Returns
    -------
    DiameterFunction

    Examples
    --------
    A rectangle is held by its long sides or, less deep, by its short ones:

    >>> diameter = diameter_function(Part([(0, 0), (2, 0), (2, 1), (0, 1)]))
    >>> diameter.stable.round(6), diameter.potential([0.0, 1.5707963267948966])
    (array([0.      , 1.570796]), array([1., 2.]))
    """
    as_instance("part", part, Part, remedy="make one of the outline: Part(outline)")
    calipers = Calipers.around(part)
    breaks = _flush(calipers)
    widths, slopes = _piece_ends(calipers, breaks)
    neutral = _critical_angle(widths, slopes) <= NEUTRAL
    rising, falling = _equilibria(calipers, breaks, widths, slopes)
    none = np.empty(0)
    return DiameterFunction(
        part=part,
        stable=none if neutral else rising,
        unstable=none if neutral else falling,
        breakpoints=_orientations(breaks),
        neutral=neutral,
        calipers=calipers,
    )


def _flush(calipers: Calipers) -> Array:
    """Return the directions in [0, pi) in which an edge lies flush, parallel edges once."""
    found = np.sort(np.mod(calipers.directions, np.pi))
    return found[np.diff(found, prepend=found[-1] - np.pi) > _SAME]


def _piece_ends(calipers: Calipers, breaks: Array) -> tuple[Array, Array]:
    """Return w and w' (b, 2) at the beginning and at the end of the piece after each break."""
    ends = np.column_stack([breaks, np.append(breaks[1:], breaks[0] + np.pi)])
    upper, lower = calipers.touched(ends.mean(axis=1))
    return _width(ends, (upper - lower)[:, None, :])


def _width(theta: Array, d: Array) -> tuple[Array, Array]:
    cos, sin = np.cos(theta), np.sin(theta)
    return d[..., 1] * cos - d[..., 0] * sin, -(d[..., 0] * cos + d[..., 1] * sin)


def _critical_angle(widths: Array, slopes: Array) -> float:
    return float(np.arctan(np.max(np.abs(slopes / widths))))


def _equilibria(
    calipers: Calipers, breaks: Array, widths: Array, slopes: Array
) -> tuple[Array, Array]:
    """Return the orientations at which w' rises through 0 (at breaks) and falls (between them).

    w' falls within a piece: where it is rounding at the beginning it is taken for negative, at the
    end for positive. So signs alternate, whatever the rounding.
    """
    rounding = 0.25 * _SAME * widths
    after, before = slopes[:, 0] > rounding[:, 0], slopes[:, 1] >= -rounding[:, 1]
    upper, lower = calipers.touched(breaks + 0.5 * np.diff(breaks, append=breaks[0] + np.pi))
    d = upper - lower
    smooth = np.arctan2(-d[:, 0], d[:, 1])  # u normal to p - q
    came_from = np.roll(before, 1)
    rising = breaks[~came_from & after]
    falling = np.concatenate([smooth[after & ~before], breaks[came_from & ~after]])
    return _orientations(rising), _orientations(falling)


def _orientations(theta: Array) -> Array:
    """Return ``-theta`` reduced to [0, pi), ascending."""
    phi = np.mod(-theta, np.pi)
    phi[np.pi - phi < ANGLE * 1e-3] = 0.0
    return np.sort(phi)
