r"""The universal feeder: a radial field plus a weak constant one leaves one stable pose.

In a radial field alone a part comes to rest with its *pivot*, the point of least mean distance
from the part, on the centre, in any orientation. A constant field then turns it like a pendulum
about the pivot, until the centroid lies on the side it pushes to: one stable pose, for any part
whose pivot is not its centroid, if the constant field is weak enough (K.-F. Boehringer, B. R.
Donald, L. E. Kavraki, F. Lamiraux, *Part orientation with one or two stable equilibria using
programmable force fields*, IEEE Trans. Robotics and Automation 16, 2000; F. Lamiraux, L. E.
Kavraki, Int. J. Robotics Research 20, 2001). How weak depends on the part and is measured here.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.density_field import DensityField
from limitsurf.actuators.potential_field import FieldSum
from limitsurf.actuators.radial_density import RadialField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.equilibria import Equilibria, equilibria
from limitsurf.sets.arguments import as_array, as_number, as_positive

__all__ = ["FeederRange", "feeder_field", "feeder_range", "pivot_point"]

Array = NDArray[np.float64]

_CENTRAL = 1e-9  # circumradii: a pivot that close to the centroid gives no arm
_RATIOS = np.concatenate([np.geomspace(1e-5, 0.1, 9), np.linspace(0.15, 0.95, 17)])
_HALVINGS = 8


@dataclass(frozen=True, eq=False)
class FeederRange:
    """How strong the constant field may be, as a fraction of the radial one.

    Attributes
    ----------
    ratio : float
        One stable pose at every ratio tried up to here; 0 if at none.
    limit : float
        The smallest ratio tried at which there are other than one; 1 if there is none.
    pivot : (2,) float
        The pivot, seen from the centroid, in the frame of the part [m].
    counts : dict of float to int
        Ratios tried, ascending, and the number of stable poses.
    proven : bool
        Whether every count up to `ratio` is proven (`Equilibria.complete`). Between the ratios
        tried nothing is.
    reason : str
        Why there is no range; empty if there is.
    """

    ratio: float
    limit: float
    pivot: Array
    counts: dict[float, int]
    proven: bool
    reason: str = ""


def feeder_field(
    density: float, ratio: float, angle: float = 0.0, center: tuple[float, float] = (0.0, 0.0)
) -> FieldSum:
    """Return a radial field plus a constant one, `ratio` times as strong.

    Parameters
    ----------
    density : float
        Size of the radial field [N/m^2].
    ratio : float
        Size of the constant field over that; see `feeder_range`.
    angle : float
        Direction of the constant field [rad].
    center : (float, float)
        Where the radial field pushes to [m].

    Raises
    ------
    InputError
        A density that is not positive, or numbers that are not finite.

    Examples
    --------
    >>> bolt = Part([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)])
    >>> equilibria(bolt, feeder_field(1.0, 0.1))
    Equilibria(1 stable, 1 saddles)
    """
    size = as_number("ratio", ratio) * as_positive("density", density)
    return RadialField(density, center) + DensityField.uniform(angle, size)


def pivot_point(part: Part) -> Array:
    """Return the point of least mean distance from a part, seen from its centroid (2,) [m].

    In the frame of the part; a radial field brings it to its centre.

    Parameters
    ----------
    part : Part
        The part.

    Examples
    --------
    >>> pivot_point(Part([(0, 0), (2, 0), (2, 1), (0, 1)])).round(12) + 0.0
    array([0., 0.])
    """
    return as_array("pivot", -equilibria(part, RadialField(1.0)).poses[0, :2], 2)


def feeder_range(part: Part) -> FeederRange:
    """Return how strong a constant field may be so that it leaves one stable pose.

    Ratios from 1e-5 to 0.95 are tried; the first change of the count is then found by bisection.

    Parameters
    ----------
    part : Part
        The part.

    Examples
    --------
    >>> found = feeder_range(Part([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)]))
    >>> round(found.ratio, 2), found.proven
    (0.31, True)
    """
    if not isinstance(part, Part):
        raise InputError("part", "is no Part", value=part)
    pivot = pivot_point(part)
    if np.hypot(*pivot) <= _CENTRAL * part.circumradius:
        return FeederRange(0.0, 0.0, pivot, {}, True, _why_central(part))
    found: dict[float, Equilibria] = {}

    def unique(ratio: float) -> bool:
        found[ratio] = equilibria(part, feeder_field(1.0, ratio))
        return len(found[ratio].stable) == 1

    good = list(itertools.takewhile(unique, _RATIOS.tolist()))
    low, high = max(good, default=0.0), max(found)
    limit = high if high > low else 1.0
    for _ in range(_HALVINGS if 0.0 < low < limit < 1.0 else 0):
        middle = 0.5 * (low + limit)
        low, limit = (middle, limit) if unique(middle) else (low, middle)
    return FeederRange(
        ratio=low,
        limit=limit,
        pivot=pivot,
        counts={ratio: len(found[ratio].stable) for ratio in sorted(found)},
        proven=all(found[ratio].complete for ratio in found if ratio <= low),
        reason="" if low > 0.0 else "the pivot is too close to the centroid to turn the part",
    )


def _why_central(part: Part) -> str:
    order = part.symmetry_order
    because = f": the part has a symmetry of order {order}" if order > 1 else ""
    return "the pivot is the centroid, so that a constant field has no arm" + because
