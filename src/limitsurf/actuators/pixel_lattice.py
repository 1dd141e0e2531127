"""Lattices of motion pixels, rectangular or hexagonal, with any set of directions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.actuators.spread import SiteSpread, draw_spread
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_count, as_number

__all__ = ["PixelLattice", "headings"]

Array = NDArray[np.float64]


def headings(count: int, first: float = 0.0) -> Array:
    """Return `count` unit vectors (count, 2) at equal angles from `first` [rad].

    Examples
    --------
    >>> headings(4).round(12) + 0.0
    array([[ 1.,  0.],
           [ 0.,  1.],
           [-1.,  0.],
           [ 0., -1.]])
    """
    as_count("count", count)
    angle = first + 2 * np.pi * np.arange(count) / count
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@dataclass(frozen=True, eq=False)
class PixelLattice:
    """n equal pixels of m actuators, each of which pushes in its own direction.

    Attributes
    ----------
    pixel_centers : (n, 2) float
        Positions of the pixels; the lattice's centre is the origin [m].
    index : (n, 2) int
        Row and column of the pixels, for dither patterns.
    offsets : (m, 2) float
        Positions of a pixel's actuators from its centre [m].
    directions : (m, 2) float
        Unit vectors of their pushes.
    pixel_area : float
        Area of a pixel's cell [m^2].
    spread : SiteSpread
        Deviations of the actuators, arrays (n, m).
    """

    pixel_centers: Array
    index: NDArray[np.int64]
    offsets: Array
    directions: Array
    pixel_area: float
    spread: SiteSpread

    @classmethod
    def rectangular(
        cls,
        rows: int,
        columns: int,
        pitch: float | tuple[float, float],
        directions: ArrayLike,
        offsets: ArrayLike | None = None,
    ) -> PixelLattice:
        """Return rows and columns of pixels.

        Parameters
        ----------
        rows, columns : int
            Number of pixels.
        pitch : float or (float, float)
            Distance of neighbours, along x and y if two [m].
        directions : (m, 2) float
            Directions of a pixel's actuators; made unit vectors.
        offsets : (m, 2) float, optional
            Positions of the actuators from the pixel's centre [m]; by default a quarter pitch out
            in the direction of the push, or at the centre if there is one.

        Examples
        --------
        >>> PixelLattice.rectangular(4, 6, 200e-6, headings(4))
        PixelLattice(24 pixels of 4 actuators)
        """
        step = as_array("pitch", np.broadcast_to(pitch, (2,)) if np.ndim(pitch) == 0 else pitch, 2)
        row, column = _indices(rows, columns)
        centers = np.stack([step[0] * np.asarray(column), step[1] * np.asarray(row)], axis=-1)
        return cls._build(centers, row, column, directions, offsets, step, float(np.prod(step)))

    @classmethod
    def hexagonal(
        cls,
        rows: int,
        columns: int,
        pitch: float,
        directions: ArrayLike,
        offsets: ArrayLike | None = None,
    ) -> PixelLattice:
        """Return a hexagonal lattice: six neighbours at the distance `pitch` [m].

        Odd rows are shifted by half a pitch; other arguments as in `rectangular`.

        Examples
        --------
        >>> PixelLattice.hexagonal(4, 6, 200e-6, headings(3))
        PixelLattice(24 pixels of 3 actuators)
        """
        step = np.full(2, as_number("pitch", pitch))
        row, column = _indices(rows, columns)
        shift = 0.5 * (np.asarray(row) % 2)
        height = 0.5 * np.sqrt(3.0) * np.asarray(row)
        centers = pitch * np.stack([np.asarray(column) + shift, height], axis=-1)
        area = 0.5 * np.sqrt(3.0) * pitch**2
        return cls._build(centers, row, column, directions, offsets, step, float(area))

    @classmethod
    def from_array(cls, array: ActuatorArray) -> PixelLattice:
        """Return the lattice of an `ActuatorArray`, with its spread."""
        inside = array.site_pitch * (np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) - 0.5)
        lattice = cls.rectangular(
            array.rows,
            array.columns,
            array.pixel.pitch,
            array.pixel.directions.reshape(4, 2),
            inside,
        )
        if array.spread is None:
            return lattice
        parts = (array.spread.strength, array.spread.turn, array.spread.dead)
        return replace(lattice, spread=SiteSpread(*(by_pixel(p, array) for p in parts)))

    @classmethod
    def _build(
        cls,
        centers: Array,
        row: ArrayLike,
        column: ArrayLike,
        directions: ArrayLike,
        offsets: ArrayLike | None,
        step: Array,
        area: float,
    ) -> PixelLattice:
        """Check the arguments, centre the lattice, place the actuators."""
        if not (np.isfinite(step).all() and (step > 0.0).all()):
            raise InputError("pitch", "must be positive", value=tuple(step))
        ways = as_array("directions", directions, None, 2)
        if len(ways) == 0:
            raise InputError("directions", "are missing", remedy="give at least one")
        length = np.linalg.norm(ways, axis=-1, keepdims=True)
        if not (np.isfinite(length).all() and (length > 0.0).all()):
            raise InputError("directions", "must be finite and not zero")
        ways = ways / length
        out = 0.25 * step * ways if len(ways) > 1 else np.zeros((1, 2))
        places = out if offsets is None else np.array(offsets, np.float64)
        if places.shape != ways.shape or not np.isfinite(places).all():
            raise InputError(
                "offsets", f"must be finite, of shape {ways.shape}", value=places.shape
            )
        middle = 0.5 * (centers.max(axis=0) + centers.min(axis=0))
        index = np.stack([np.asarray(row), np.asarray(column)], axis=-1)
        none = draw_spread((len(centers), len(ways)))
        return cls(centers - middle, index, places, ways, area, none)

    def with_spread(
        self, *, strength: float = 0.0, direction: float = 0.0, dead: float = 0.0, seed: int = 0
    ) -> PixelLattice:
        """Return the lattice with random deviations; see `draw_spread`."""
        shape = (len(self.pixel_centers), len(self.directions))
        drawn = draw_spread(shape, strength=strength, direction=direction, dead=dead, seed=seed)
        return replace(self, spread=drawn)

    @property
    def positions(self) -> Array:
        """Positions of the actuators, (n, m, 2) [m]."""
        return np.asarray(self.pixel_centers[:, None] + self.offsets)

    @property
    def pushes(self) -> Array:
        """Pushes of the actuators over the nominal one, (n, m, 2); zero for dead ones."""
        shape = (len(self.pixel_centers), *self.directions.shape)
        return self.spread.pushes(np.broadcast_to(self.directions, shape))

    def __repr__(self) -> str:
        """Return the numbers of pixels and actuators."""
        return f"PixelLattice({len(self.pixel_centers)} pixels of {len(self.directions)} actuators)"


def _indices(rows: int, columns: int) -> NDArray[np.int64]:
    """Return row and column of every pixel (2, n)."""
    shape = as_count("rows", rows), as_count("columns", columns)
    return np.indices(shape, dtype=np.int64).reshape(2, -1)


def by_pixel(sites: NDArray, array: ActuatorArray) -> NDArray:  # type: ignore[type-arg]
    """Return an array over sites (R, C) as one over pixels and actuators (n, 4)."""
    split = sites.reshape(array.rows, 2, array.columns, 2)
    return np.ascontiguousarray(split.transpose(0, 2, 1, 3).reshape(-1, 4))


def by_site(pixels: NDArray, array: ActuatorArray) -> NDArray:  # type: ignore[type-arg]
    """Return an array over pixels and actuators (n, 4) as one over sites (R, C)."""
    split = pixels.reshape(array.rows, array.columns, 2, 2).transpose(0, 2, 1, 3)
    return np.ascontiguousarray(split.reshape(2 * array.rows, 2 * array.columns))
