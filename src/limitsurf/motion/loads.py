"""Loads on a part beside those of its contacts: gravity on a tilted array, and given ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import g

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.sets.arguments import as_array

__all__ = ["Gravity", "gravity", "with_gravity"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Gravity:
    """What weighs on tilted ground.

    Attributes
    ----------
    normal : float
        Weight across the ground, which the contacts carry [N].
    load : (3,) float
        Weight along the ground, a load about the centre of mass [N, N, N m].
    """

    normal: float
    load: Array


def gravity(part: Part, tilt: ArrayLike = (0.0, 0.0)) -> Gravity:
    r"""Return the part's weight on ground that falls towards `tilt`, by its length as an angle.

    .. math:: N = m g \cos|\tau|, \qquad F = m g \sin|\tau|\, \tau / |\tau|

    Parameters
    ----------
    part : Part
        The part, with areal density.
    tilt : (2,) float
        Direction in which the ground falls, times the angle [rad].

    Examples
    --------
    >>> part = Part([(0, 0), (1, 0), (1, 1), (0, 1)], 1.0)
    >>> gravity(part, (0.1, 0.0)).load.round(3)
    array([0.979, 0.   , 0.   ])
    """
    direction = as_array("tilt", tilt, 2)
    angle = float(np.hypot(*direction))
    if not angle < 0.5 * np.pi:
        raise InputError("tilt", "must be less than pi/2", value=tuple(direction))
    pull = part.mass * g * np.sinc(angle / np.pi) * direction
    return Gravity(part.mass * g * float(np.cos(angle)), np.array([*pull, 0.0]))


def with_gravity(weight: Gravity, load: LoadLike, duration: float | None) -> LoadTable:
    """Return a load with that of gravity added, tabulated up to a duration [s].

    Loads that change in time need a duration.
    """
    varies = not load.steady if isinstance(load, LoadTable) else callable(load)
    if varies and duration is None:
        raise InputError("duration", "is missing", remedy="give it, as the load changes in time")
    table = LoadTable.of(load, 0.0 if duration is None else duration)
    if not weight.load.any():
        return table
    if table.steady:
        return LoadTable(table(0.0) + weight.load, table.duration)
    return LoadTable(lambda t: table(t) + weight.load, table.duration)
