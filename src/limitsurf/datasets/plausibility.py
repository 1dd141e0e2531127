"""Warnings about data: what was dropped, and units that cannot be right."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

__all__ = ["DroppedRows", "ImplausibleUnits", "warn_of_units"]

Array = NDArray[np.float64]

_FEWEST = 5  # pairs: fewer may well be all sliding or all turning
_RATIO = 100.0  # a lever of 100 rho; wrong prefixes make 1000


class DroppedRows(UserWarning):
    """Rows of a table were left out; the message says how many and why."""


class ImplausibleUnits(UserWarning):
    """Moments do not go with forces, or rotations with displacements, at this rho."""


def warn_of_units(loads: Array, twists: Array, rho: float) -> None:
    """Warn if ``m`` and ``rho f``, or ``v`` and ``rho omega``, are of sizes that differ 100-fold.

    Contacts within a few rho of the reference point keep both ratios near one, unless all pairs
    are pure sliding or pure turning; a moment in N mm or a length in mm is off by 1000. Loads are
    taken from their mean, to which active contacts add what they like.
    """
    if len(loads) < _FEWEST:
        return
    force, moment = _sizes(loads - loads.mean(axis=0))
    if (lever := _ratio(moment, force * rho)) is not None:
        _warn(f"the moments are {lever:.2g} times rho = {rho:g} m times the forces", "N and N m")
    speed, turning = _sizes(twists)
    if (way := _ratio(speed, turning * rho)) is not None:
        _warn(
            f"the displacements are {way:.2g} times rho = {rho:g} m times the angles", "m and rad"
        )


def _sizes(rows: Array) -> tuple[float, float]:
    """Return root mean squares of the first two columns together and of the third."""
    plane, turn = np.sqrt((rows[:, :2] ** 2).sum(axis=1).mean()), np.sqrt((rows[:, 2] ** 2).mean())
    return float(plane), float(turn)


def _ratio(a: float, b: float) -> float | None:
    """Return a/b if it is implausible; zeros are pure sliding or turning, not wrong units."""
    if a == 0.0 or b == 0.0 or 1.0 / _RATIO <= a / b <= _RATIO:
        return None
    return a / b


def _warn(what: str, units: str) -> None:
    message = f"{what}: they should be in {units}, rho in m (or all pairs slide, or all turn)"
    warnings.warn(message, ImplausibleUnits, stacklevel=5)
