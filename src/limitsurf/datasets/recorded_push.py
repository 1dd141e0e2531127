"""One recorded push: poses before and after, forces and the fingertip over time, and its average.

The recipe is that of the authors of the measured pushes (Zhou, Paolini, Bagnell, Mason, *A convex
polynomial force-motion model for planar sliding*, ICRA 2016): a mean load against a secant motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

__all__ = ["LOAD_SAMPLES_FROM", "RecordedPush"]

Array = NDArray[np.float64]

#: The finger approaches during the first samples: this share of them is left out.
LOAD_SAMPLES_FROM = 0.3

_TOOL = np.sqrt(0.5) * np.array([[1.0, 1.0], [1.0, -1.0]])  # sensor axes to those of the tool


@dataclass(frozen=True, eq=False)
class RecordedPush:
    """A push of a part by a finger with a force sensor. Poses ``(x, y, theta)`` in the world.

    Attributes
    ----------
    before, after : (3,) float
        Poses of the part's reference point [m, m, rad]; theta of `after` within pi of `before`.
    force_time : (k,) float
        Times of the force samples, from the first on [s].
    sensor : (k, 2) float
        What the sensor read, in its own axes [N].
    tip_time : (j,) float
        Times of the tip's poses, from the first force sample on [s].
    tip : (j, 3) float
        Poses of the fingertip [m, m, rad].
    """

    before: Array
    after: Array
    force_time: Array
    sensor: Array
    tip_time: Array
    tip: Array

    @cached_property
    def tip_at_samples(self) -> Array:
        """Poses of the tip (k, 3) when the forces were read; at its ends the tip stands still."""
        columns = [np.interp(self.force_time, self.tip_time, column) for column in self.tip.T]
        return np.column_stack(columns)

    @cached_property
    def force(self) -> Array:
        """Forces on the part (k, 2), world axes [N]: minus the sensor's, the first is the zero."""
        tool = -(self.sensor - self.sensor[0]) @ _TOOL.T
        return _turned(tool, self.tip_at_samples[:, 2])

    @cached_property
    def averaged(self) -> NDArray[np.bool_]:
        """Which samples (k,) are averaged: late ones, no smaller than the mean force vector."""
        change = self.sensor - self.sensor[0]
        first = int(np.ceil(LOAD_SAMPLES_FROM * len(change))) - 1
        mean = change.mean(axis=0)
        large = (change**2).sum(axis=1) >= mean @ mean
        return np.asarray((np.arange(len(change)) >= first) & large)

    @cached_property
    def loads(self) -> Array:
        """Loads of the averaged samples (a, 3), body axes, about the reference point.

        The part is taken to move evenly from `before` to `after` while they are read.
        """
        way = np.linspace(0.0, 1.0, int(self.averaged.sum()))[:, None]
        pose = self.before + way * (self.after - self.before)
        force, tip = self.force[self.averaged], self.tip_at_samples[self.averaged]
        arm = tip[:, :2] - pose[:, :2]
        moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
        return np.column_stack([_turned(force, -pose[:, 2]), moment])

    @property
    def displacement(self) -> Array:
        """Motion (3,) of the part, in its axes before the push [m, m, rad]."""
        moved = self.after - self.before
        return np.append(_turned(moved[None, :2], -self.before[2:])[0], moved[2])


def _turned(vectors: Array, angle: Array) -> Array:
    """Return vectors (k, 2), turned by angles (k,)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors.T
    return np.column_stack([c * x - s * y, s * x + c * y])
