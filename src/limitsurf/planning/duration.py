"""How long a plan takes: the mean over all starts, by quadrature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.actuators.density_field import push_density
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.planning.settling import settle
from limitsurf.planning.turn_function import turn_function
from limitsurf.sets.arguments import as_positive

if TYPE_CHECKING:
    from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["expected_duration", "line_durations"]

Array = NDArray[np.float64]

_ORIENTATIONS = 24  # of the first line, at least
_PLACES = np.cos(np.pi * np.arange(1, 4) / 4)  # Gauss nodes of a disk's shadow on a line,
_SHARES = 0.5 * np.sin(np.pi * np.arange(1, 4) / 4) ** 2  # and their weights


@dataclass(frozen=True, eq=False)
class _Starts:
    """Orientations and centroids (n, 2) in the array's frame, with their shares of all starts."""

    theta: Array
    center: Array
    share: Array


def expected_duration(
    plan: AlignmentPlan,
    drive: ActuatorArray,
    *,
    tolerance: float = float(np.radians(1.0)),
    start_offset: float | None = None,
) -> float:
    """Return the expected time of a plan [s]: the sum of `line_durations`.

    Parameters
    ----------
    plan, drive, tolerance, start_offset
        See `line_durations`, also for the errors.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> plan = plan_alignment(Part.from_file("paper_t"))
    >>> round(expected_duration(plan, load_array("resonator64")), 1)
    5.8
    """
    found = line_durations(plan, drive, tolerance=tolerance, start_offset=start_offset)
    return float(found.sum())


def line_durations(
    plan: AlignmentPlan,
    drive: ActuatorArray,
    *,
    tolerance: float = float(np.radians(1.0)),
    start_offset: float | None = None,
) -> Array:
    r"""Return the expected time (k,) that each line of a plan takes [s].

    The part moves with mass and drag in the continuum field of the array, from starts that are
    uniform in orientation and in a disk about the array's centre, and is at rest when its
    orientation stays within `tolerance` of the end, and its offset within that times the radius of
    gyration. The mean is a quadrature: no random numbers.

    Parameters
    ----------
    plan : AlignmentPlan
        The plan; its part has an areal density. With "centred" each line begins with the centroid
        on it, with "push-squeeze" with the part just touching it from the left; the time to get
        there is not counted.
    drive : ActuatorArray
        Gives push, drag, and the loss to dithered directions, ``1/(|cos| + |sin|)`` of the line.
        Friction left in running tips is not counted.
    tolerance : float
        See above [rad]; one degree.
    start_offset : float, optional
        Radius of the disk [m]; half of the part's circumradius, as in `verify_alignment`.

    Raises
    ------
    InputError
        No areal density, a drive that does not push, a neutral part.
    SolveFailed
        A start from which the part takes more than 500 of its time constants.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> plan = plan_alignment(Part.from_file("paper_t"))
    >>> line_durations(plan, load_array("resonator64")).round(1)
    array([2.4, 3.4])
    """
    if not isinstance(drive, ActuatorArray):
        raise InputError("drive", "is no ActuatorArray", value=drive, remedy="give its array")
    as_positive("tolerance", tolerance)
    part, turn = plan.part, turn_function(plan.part)
    density, drag = push_density(part, drive), air_film_drag(part, drive)
    if turn.neutral:
        raise InputError("plan", "is for a neutral part: squeezing does not turn it")
    if density <= 0.0:
        raise InputError("drive", "does not push", remedy="raise offset_fraction")
    starts, means = _first_starts(plan, start_offset), []
    for k, line in enumerate(plan.lines):
        along, normal = _axes(float(line))
        phi = starts.theta - line
        offset = _offsets(plan, phi, starts.center @ normal)
        strength = density / (np.abs(along) + 0.0).sum()
        end = settle(turn, strength, drag, phi, offset, tolerance)
        means.append(end.times @ starts.share)
        place = starts.center @ along
        center = place[:, None] * along + end.offset[:, None] * normal
        starts = _Starts(end.phi + line, center, starts.share)
        if k == 0:
            starts = _merged(starts, float(line), _radius(part, start_offset))
    return np.array(means)


def _first_starts(plan: AlignmentPlan, start_offset: float | None) -> _Starts:
    """Return starts in all steps of the first line, dense where they end, times offsets."""
    squeeze, line = plan.squeeze, float(plan.lines[0])
    count = max(3, -(-_ORIENTATIONS // len(squeeze.breaks)))
    angle = np.pi * (np.arange(count) + 0.5) / count
    width = (squeeze.ends - squeeze.breaks)[:, None]
    phi = (squeeze.breaks[:, None] + width * 0.5 * (1.0 - np.cos(angle))).ravel()
    share = (width * np.sin(angle)).ravel()
    radius = _radius(plan.part, start_offset)
    theta, place = (x.ravel() for x in np.meshgrid(phi + line, radius * _PLACES, indexing="ij"))
    weight = np.outer(share / share.sum(), _SHARES).ravel()
    return _Starts(theta, place[:, None] * _axes(line)[1], weight)


def _merged(ends: _Starts, line: float, radius: float) -> _Starts:
    """Return one start for each rest and place along the first line: that is still as it was."""
    along, normal = _axes(line)
    keys, first, which = np.unique(np.round(ends.theta, 6), return_index=True, return_inverse=True)
    share = np.bincount(which.ravel(), ends.share, len(keys))
    height = np.repeat(ends.center[first] @ normal, len(_PLACES))
    place = np.tile(radius * _PLACES, len(keys))
    center = place[:, None] * along + height[:, None] * normal
    theta = np.repeat(ends.theta[first], len(_PLACES))
    return _Starts(theta, center, np.outer(share, _SHARES).ravel())


def _offsets(plan: AlignmentPlan, phi: Array, offset: Array) -> Array:
    """Return how far centroids are to the left of a line as a step begins."""
    if plan.model == "centred":
        return np.zeros_like(offset)
    if plan.model == "push-squeeze":
        x, y = plan.part.edges[:, :2].T
        heights = np.sin(phi)[:, None] * x + np.cos(phi)[:, None] * y
        return np.asarray(-heights.min(axis=1))
    return offset


def _radius(part: Part, start_offset: float | None) -> float:
    if start_offset is None:
        return 0.5 * part.circumradius
    if not (np.isfinite(start_offset) and start_offset >= 0.0):
        raise InputError("start_offset", "must be at least 0 m", value=start_offset)
    return float(start_offset)


def _axes(line: float) -> tuple[Array, Array]:
    """Return the unit vectors along a line and to its left."""
    cosine, sine = np.cos(line), np.sin(line)
    return np.array([cosine, sine]), np.array([-sine, cosine])
