"""Where motions start: given poses, or random ones on an array."""

from __future__ import annotations

from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.sets.arguments import as_array, as_count, as_number

__all__ = ["check_room", "random_starts", "read_starts"]

Array = NDArray[np.float64]


def random_starts(samples: int, seed: int, offset: float) -> Array:
    """Return random poses (n, 3): uniform orientations, centres uniform in a disk.

    Parameters
    ----------
    samples, seed : int
        Number of poses and seed.
    offset : float
        Radius of the disk [m].

    Examples
    --------
    >>> random_starts(3, 0, 1e-3).shape
    (3, 3)
    """
    count, rng = as_count("samples", samples), np.random.default_rng(as_count("seed", seed, 0))
    reach = _checked_offset(offset)
    radius, angle, theta = rng.random((3, count))
    radius = reach * np.sqrt(radius)
    angle = 2 * np.pi * angle
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 2 * np.pi * theta])


def read_starts(poses: ArrayLike | int, part: Part, seed: int, offset: float | None) -> Array:
    """Return poses (n, 3): those given, or so many random ones."""
    if isinstance(poses, Integral):
        radius = 0.5 * part.circumradius if offset is None else offset
        return random_starts(poses, seed, radius)
    rows = as_array("poses", poses, None, 3)
    if len(rows) == 0:
        raise InputError("poses", "are missing", remedy="give (n, 3) poses or a number of them")
    return rows


def check_room(part: Part, array: ActuatorArray, start_offset: float) -> None:
    """Raise unless the array holds the part's circumscribed circle at every start."""
    reach = part.circumradius + _checked_offset(start_offset)
    room = 0.5 * min(array.width, array.height)
    if room < reach:
        raise InputError(
            "array",
            f"{array.name} leaves {1e3 * room:.4g} mm around its centre, but the part needs "
            f"{1e3 * part.circumradius:.4g} mm and its start offsets {1e3 * start_offset:.4g} mm",
            remedy="take a larger array or a smaller start offset",
        )


def _checked_offset(offset: float) -> float:
    radius = as_number("start_offset", offset)
    if not (np.isfinite(radius) and radius >= 0.0):
        raise InputError("start_offset", "must be at least 0 m", value=offset)
    return radius
