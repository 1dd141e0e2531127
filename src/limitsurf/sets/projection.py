"""The record of a projection."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Projection", "Status"]

Array = NDArray[np.float64]


class Status(IntEnum):
    """How a projection ended; its text says what to do."""

    OUTSIDE = 0
    INSIDE = 1
    FAILED = 2
    LOOSE = 3

    def __str__(self) -> str:
        """Return the status in words."""
        return (
            "solved, the point lies outside",
            "solved, the point lies in the set",
            "not solved to tolerance: scale the set to size 1, or use a metric closer to its shape",
            "solved, but the certified error is above the tolerance asked for: see error_bound",
        )[int(self)]


@dataclass(frozen=True, eq=False)
class Projection:
    """Closest points of a set, for points of shape (..., n); all other fields follow that shape.

    Attributes
    ----------
    point : (..., n) float
        The closest points.
    distance : (...,) float
        Distance, in the norm of the metric.
    normal : (..., n) float
        Unit outer normal ``W (p - point)``, zeros for points inside.
    twist : (..., n) float
        ``W (point - p)``, zeros for points inside: with loads, the twist of a part on which the
        external load ``-p`` acts, up to the unit of time in W.
    error_bound : (...,) float
        Certified distance to the true closest point, in the norm of the metric.
    iterations : (...,) int
        Iterations of the solver.
    status : (...,) int
        Values of `Status`.
    active : (..., m) int or None
        Polytopes only: the exact face of the closest point, as indices of the vertices that span
        it (`VPolytope`), or of up to three facets through it (`HPolytope`), then -1; all -1 inside.
    """

    point: Array
    distance: Array
    normal: Array
    twist: Array
    error_bound: Array
    iterations: NDArray[np.integer[Any]]
    status: NDArray[np.integer[Any]]
    active: NDArray[np.integer[Any]] | None = None

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether the points lie in the set."""
        return np.asarray(self.status == Status.INSIDE)

    def __repr__(self) -> str:
        """Return the point, or the number of points."""
        if self.point.ndim == 1:
            where = np.array2string(self.point, precision=6, separator=", ")
            return (
                f"Projection({where}, distance {float(self.distance):.6g}, "
                f"error at most {float(self.error_bound):.1e})"
            )
        return f"Projection of {self.status.size} points, {int(self.inside.sum())} inside"
