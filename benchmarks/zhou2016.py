"""Measured planar pushes: Zhou, Paolini, Bagnell, Mason, ICRA 2016, surface "blackboard".

A finger pushes a right-isosceles aluminium triangle that stands on three small feet. The data are
not part of this repository: they are looked for in ``zhou2016`` in the folder that the environment
variable LIMITSURF_DATA names, or else in ``../shared/data`` beside the repository. They come from
github.com/robinzhoucmu/MLab_EXP, folder PushExp/sensor_log (Apache-2.0), with the logs in ``logs``.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from scipy.constants import g
from scipy.spatial.transform import Rotation

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.load_sharing import share_load

SUPPORTS = (
    "10_130_10_10_10_130",
    "10_90_10_10_30_130",
    "30_63.33_43.33_30_43.33_63.33",
    "30_90_30_30_30_90",
)
LEG, MASS = 0.150, 1.518  # m, kg
CENTROID = np.array([LEG / 3, LEG / 3])  # from the right-angle corner, where poses are measured
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
        return float(np.angle(np.exp(1j * (self.after[2] - self.before[2]))))

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


def feet(support):
    """Return the contacts of a support about the centroid, for mu = 1: mu scales out."""
    x1, x2, x3, y1, y2, y3 = (1e-3 * float(c) for c in support.split("_"))
    places = np.array([[x1, y1], [x2, y2], [x3, y3]]) - CENTROID
    return ContactSet(places, share_load(places, MASS * g, rule="three-point").normal_force)


def read_pushes(support):
    """Return the pushes of a support, in the order of its log."""
    numbers = np.array((folder() / "logs" / f"{support}.txt").read_text().split(), dtype=float)
    at, pushes = 1, []
    for _ in range(int(numbers[0])):
        before, after = numbers[at : at + 7], numbers[at + 7 : at + 14]
        forces, at = _rows(numbers, at + 14, 3)
        tips, at = _rows(numbers, at, 8)
        pushes.append(_push(_pose(before), _pose(after), forces, tips))
    if at != len(numbers):
        raise ValueError(f"{support}: {len(numbers) - at} numbers are left over")
    return pushes


def _rows(numbers, at, width):
    end = at + 1 + int(numbers[at]) * width
    return numbers[at + 1 : end].reshape(-1, width), end


def _pose(row):
    """Return the centroid's pose from position [mm] and quaternion of the corner, tilt included."""
    turn = Rotation.from_quat([*row[4:], row[3]]).as_matrix()[:2, :2]
    return np.array([*(1e-3 * row[:2] + turn @ CENTROID), 2.0 * np.arctan2(row[6], row[3])])


def _push(before, after, forces, tips):
    """Cut the finger's path where half the mean force is reached; the first sample is the zero."""
    size = np.hypot(*(forces[:, 1:] - forces[0, 1:]).T)
    touch = forces[np.argmax(size > 0.5 * size.mean()), 0]
    times, path = tips[:, 0], 1e-3 * tips[:, 1:3]
    first = [np.interp(touch, times, path[:, k]) for k in (0, 1)]
    finger = np.vstack([first, path[times > touch]])
    seen = rotation(before[2]).T @ (finger[0] - before[:2]) + CENTROID
    nearest = shapely.get_coordinates(
        shapely.line_interpolate_point(
            OUTLINE, shapely.line_locate_point(OUTLINE, shapely.Point(seen))
        )
    )[0]
    return MeasuredPush(before, after, finger, nearest - CENTROID)
