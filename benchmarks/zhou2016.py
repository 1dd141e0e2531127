"""Measured planar pushes (Zhou et al. 2016) as they are replayed: where the finger goes.

The data are not part of this repository: they are looked for in ``zhou2016`` in the folder that the
environment variable LIMITSURF_DATA names, or else in ``../shared/data`` beside the repository. See
`limitsurf.datasets.zhou2016`, which reads them.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from limitsurf.datasets.zhou2016 import CENTROID, LEG, load_zhou2016

OUTLINE = shapely.LinearRing([(0.0, 0.0), (LEG, 0.0), (0.0, LEG)])


@dataclass(frozen=True, eq=False)
class MeasuredPush:
    """One push; lengths in m, angles in rad, poses ``(x, y, theta)`` of the centroid.

    Attributes
    ----------
    before, after : (3,) float
        Poses.
    finger : (k, 2) float
        Path of the fingertip from the time on at which it touches the triangle.
    point : (2,) float
        Where it touches first: the point of the outline nearest to the tip, from the centroid.
    """

    before: np.ndarray
    after: np.ndarray
    finger: np.ndarray
    point: np.ndarray

    @property
    def rotation(self):
        """Measured rotation [rad], in (-pi, pi]."""
        return self.after[2] - self.before[2]

    @property
    def displacement(self):
        """Measured displacement of the point of the triangle that is touched first [m]."""
        ends = [pose[:2] + rotation(pose[2]) @ self.point for pose in (self.before, self.after)]
        return ends[1] - ends[0]

    @property
    def slip(self):
        """How far the finger ends from where it touched first, seen from the triangle [m]."""
        places = (self.finger[0], self.before), (self.finger[-1], self.after)
        seen = [rotation(pose[2]).T @ (place - pose[:2]) for place, pose in places]
        return float(np.linalg.norm(seen[1] - seen[0]))


def folder():
    """Return the folder of the data, which may not exist."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    return Path(os.environ.get("LIMITSURF_DATA", beside)) / "zhou2016"


def rotation(theta):
    """Return the matrix that turns by theta."""
    return np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])


def read_pushes(support):
    """Return the pushes of a support, in the order of its log."""
    return [_push(push) for push in load_zhou2016(folder(), [support])[support].pushes]


def _push(recorded):
    """Cut the finger's path where half the mean force is reached; the first sample is the zero."""
    size = np.hypot(*recorded.force.T)
    touch = recorded.force_time[np.argmax(size > 0.5 * size.mean())]
    times, path = recorded.tip_time, recorded.tip[:, :2]
    first = [np.interp(touch, times, path[:, k]) for k in (0, 1)]
    finger = np.vstack([first, path[times > touch]])
    before = recorded.before
    seen = rotation(before[2]).T @ (finger[0] - before[:2]) + CENTROID
    nearest = shapely.get_coordinates(
        shapely.line_interpolate_point(
            OUTLINE, shapely.line_locate_point(OUTLINE, shapely.Point(seen))
        )
    )[0]
    return MeasuredPush(before, recorded.after, finger, nearest - CENTROID)
