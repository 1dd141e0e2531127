"""The record of one motion."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.slide import LEFT_ARRAY, NOT_LIFTED, REST, TIME_LIMIT

if TYPE_CHECKING:
    import xarray

__all__ = ["Outcome", "Trajectory"]

Array = NDArray[np.float64]


class Outcome(IntEnum):
    """How a motion ended; its text says it in words."""

    TIME_LIMIT = TIME_LIMIT
    REST = REST
    LEFT_ARRAY = LEFT_ARRAY
    NOT_LIFTED = NOT_LIFTED

    def __str__(self) -> str:
        """Return the outcome in words."""
        words = ("still moving at the time limit", "at rest", "left the array", "not lifted")
        return words[int(self)]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Poses of a part over time, with loads and certificates.

    Attributes
    ----------
    times : (k,) float
        Times [s].
    poses : (k, 3) float
        Poses ``(x, y, theta)`` of the centre of mass, array frame [m, m, rad].
    twists : (k, 3) float
        Velocities [m/s, m/s, rad/s].
    loads : (k, 3) float
        Loads of the contacts on the part, about its centre of mass [N, N, N m].
    error_bounds : (k,) float
        Certified error of the frictional load [N], moments over the metric's radius of gyration.
    tips : (k,) int
        Active tips under the part.
    outcome : Outcome
        How the motion ended.
    worst_error : float
        Largest error bound of all steps, also of those not recorded, over the part's weight.
    """

    times: Array
    poses: Array
    twists: Array
    loads: Array
    error_bounds: Array
    tips: NDArray[np.int64]
    outcome: Outcome
    worst_error: float

    @property
    def duration(self) -> float:
        """Time until the end [s]."""
        return float(self.times[-1])

    @property
    def final_pose(self) -> Array:
        """Pose at the end."""
        last: Array = self.poses[-1]
        return last

    def to_dataset(self) -> xarray.Dataset:
        """Return the record as an xarray dataset with units."""
        import xarray

        axes = {
            "pose": ["x", "y", "theta"],
            "twist": ["vx", "vy", "omega"],
            "load": ["fx", "fy", "m"],
        }
        data = {
            "poses": (("time", "pose"), self.poses, {"units": "m, m, rad"}),
            "twists": (("time", "twist"), self.twists, {"units": "m/s, m/s, rad/s"}),
            "loads": (("time", "load"), self.loads, {"units": "N, N, N m"}),
            "error_bounds": (("time",), self.error_bounds, {"units": "N"}),
            "tips": (("time",), self.tips),
        }
        time = ("time", self.times, {"units": "s"})
        return xarray.Dataset(
            data, coords={"time": time, **axes}, attrs={"outcome": str(self.outcome)}
        )

    def __repr__(self) -> str:
        """Return duration and outcome."""
        return f"Trajectory({len(self.times)} frames, {self.duration:.3g} s, {self.outcome})"
