"""The sites of a square lattice under a part, kept up to date while the part moves."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.row_spans import no_spans, row_spans, span_changes
from limitsurf.kernels.site_list import change_sites, new_site_list
from limitsurf.sets.arguments import as_array

__all__ = ["LatticeContacts"]

_MOST_SITES_ACROSS = 2**28


class LatticeContacts:
    """Sites of a square lattice under a part, listed in no particular order.

    Finding them takes time proportional to the rows under the part; a move takes that and time
    proportional to the number of sites that enter and leave. A site on the outline counts on
    one side of the part and not on the other, so that parts that touch share none.

    Parameters
    ----------
    part : Part, polygon or (E, 4) float
        What lies on the lattice: a part, what a `Part` takes as its outline, or directed edges
        ``x0, y0, x1, y1`` of closed rings about a reference point of your own [m].
    pitch : float
        Distance between neighbouring sites [m].
    origin : (2,) float
        Position of site (0, 0) [m].
    shape : (2,) int, optional
        Rows and columns; without it the lattice has no end.

    Raises
    ------
    InputError
        A pitch that is not positive or too small for the part, an origin or pose that is not
        finite, edges that are no closed rings.

    Examples
    --------
    >>> contacts = LatticeContacts(Part([(0, 0), (2, 0), (2, 1), (0, 1)]), 0.5, (0.25, 0.25))
    >>> contacts.move((1.0, 0.5, 0.0))
    (8, 0)
    >>> contacts.move((1.5, 0.5, 0.0))
    (2, 2)
    >>> contacts.count, contacts.positions.mean(axis=0)
    (8, array([0., 0.]))
    """

    def __init__(
        self,
        part: Part | shapely.Geometry | ArrayLike,
        pitch: float,
        origin: ArrayLike = (0.0, 0.0),
        shape: tuple[int, int] | None = None,
    ) -> None:
        self._edges = _edges_of(part)
        self._pitch = _checked_pitch(pitch, self._edges)
        self._origin = as_array("origin", origin, 2)
        self._rows, self._columns = _checked_shape(shape)
        self._reference = np.zeros(2)
        self._spans = no_spans()
        self._list = new_site_list(16)
        self._count = 0

    def move(self, pose: ArrayLike) -> tuple[int, int]:
        """Move the part to a pose ``(x, y, theta)``; return how many sites entered and left."""
        x, y, theta = as_array("pose", pose, 3)
        placed = _placed(self._edges, x, y, theta)
        if np.abs(placed - np.tile(self._origin, 2)).max() > _MOST_SITES_ACROSS * self._pitch:
            raise InputError("pose", "is too far away to number the sites there", value=pose)
        origin_x, origin_y = self._origin
        spans = row_spans(placed, origin_x, origin_y, self._pitch, self._rows, self._columns)
        entered, left = span_changes(self._spans, spans)
        self._make_room(self._count - len(left) + len(entered))
        self._count = change_sites(self._list, self._count, entered, left)
        self._spans, self._reference = spans, np.array([x, y])
        return len(entered), len(left)

    @property
    def count(self) -> int:
        """Number of sites under the part; none before the first move."""
        return self._count

    @property
    def sites(self) -> NDArray[np.int32]:
        """Rows and columns (count, 2) of the sites under the part; a view, until the next move."""
        view: NDArray[np.int32] = self._list.sites[: self._count]
        view.setflags(write=False)
        return view

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions (count, 2) from the part's reference point, in the world frame [m]."""
        return self._origin - self._reference + self._pitch * self.sites[:, ::-1]

    def _make_room(self, needed: int) -> None:
        if needed > len(self._list.sites):
            larger = new_site_list(needed + needed // 2)
            change_sites(larger, 0, self._list.sites[: self._count], np.empty((0, 2), np.int32))
            self._list = larger

    def __repr__(self) -> str:
        """Return the pitch and the number of sites."""
        return f"LatticeContacts({self._pitch:g} m pitch, {self._count} sites under the part)"


def _edges_of(part: Part | shapely.Geometry | ArrayLike) -> NDArray[np.float64]:
    if isinstance(part, Part):
        return part.edges
    if isinstance(part, shapely.Geometry) or np.ndim(part) != 2 or np.shape(part)[1] != 4:
        return Part(part).edges
    edges = np.asarray(part, dtype=np.float64)
    if len(edges) == 0 or not np.isfinite(edges).all():
        raise InputError("edges", "are empty or not finite", remedy="give closed rings")
    starts, ends = (sorted(map(tuple, points)) for points in (edges[:, :2], edges[:, 2:]))
    if starts != ends:
        raise InputError(
            "edges", "do not close", remedy="end as many edges in every point as start there"
        )
    return edges


def _checked_pitch(pitch: float, edges: NDArray[np.float64]) -> float:
    value = float(as_array("pitch", pitch))
    if value <= 0.0:
        raise InputError("pitch", "must be positive", value=pitch)
    if np.abs(edges).max() > _MOST_SITES_ACROSS * value:
        raise InputError("pitch", "is too small for the part", value=pitch, remedy="check units")
    return value


def _checked_shape(shape: tuple[int, int] | None) -> tuple[int, int]:
    if shape is None:
        return -1, -1
    rows, columns = as_array("shape", shape, 2)
    if rows != int(rows) or columns != int(columns) or min(rows, columns) < 0:
        raise InputError("shape", "must be a number of rows and one of columns", value=shape)
    return int(rows), int(columns)


def _placed(edges: NDArray[np.float64], x: float, y: float, theta: float) -> NDArray[np.float64]:
    """Return the edges at a pose; equal end points stay equal, bit by bit."""
    c, s = cos(theta), sin(theta)
    placed = np.empty_like(edges)
    placed[:, ::2] = c * edges[:, ::2] - s * edges[:, 1::2] + x
    placed[:, 1::2] = s * edges[:, ::2] + c * edges[:, 1::2] + y
    return placed
