r"""Orientations at rest in a skewed squeeze, which has no potential.

Pushes turned clockwise by eps from the normal of the line do not change the condition on the
position (the line is the median), and turn the part with the moment

.. math:: M_\epsilon = \cos\epsilon\, U' + \sin\epsilon\, U

at theta = -phi: counter-clockwise for positive eps. (`FieldErrors.direction` counts the other way.)
Its zeros are where :math:`-\tan\epsilon = U'/U`: none once eps exceeds the critical angle, and then
the part spins.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.planning.sign_changes import sign_changes
from limitsurf.planning.turn_function import TurnFunction
from limitsurf.sets.arguments import as_number

__all__ = ["SkewedEquilibria", "skewed_equilibria"]

Array = NDArray[np.float64]

_NOISE = 4e-15  # of the moments of a part of area 1


class SkewedEquilibria(NamedTuple):
    """Orientations of rest in [0, pi), the line at world angle 0 [rad]; none if the part spins."""

    stable: Array
    unstable: Array


def skewed_equilibria(turn: TurnFunction, skew: float) -> SkewedEquilibria:
    """Return the orientations that keep a part at rest in a squeeze whose pushes are skewed.

    Under the assumption of the squeeze function, that the part is on its median before it turns;
    without a potential nothing says that a part in full motion comes to these orientations.

    Parameters
    ----------
    turn : TurnFunction
        From `turn_function`.
    skew : float
        Angle of the pushes from the normal of the line, clockwise [rad], as in
        `DensityField.skewed_squeeze`.

    Returns
    -------
    SkewedEquilibria
        ``.stable`` and ``.unstable``, empty beyond `TurnFunction.critical_angle`.

    Raises
    ------
    InputError
        A skew that is not between -pi/2 and pi/2.

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.turn_function import turn_function
    >>> turn = turn_function(Part([(0, 0), (2, 0), (2, 1), (0, 1)]))
    >>> [round(float(x), 6) for x in np.degrees(skewed_equilibria(turn, 0.1).stable)]
    [3.451743]
    >>> len(skewed_equilibria(turn, 0.7).stable)
    0
    """
    angle = as_number("skew", skew)
    if not abs(angle) < 0.5 * np.pi:
        raise InputError("skew", "must lie between -pi/2 and pi/2", value=skew)
    if turn.neutral and angle == 0.0:
        return SkewedEquilibria(np.empty(0), np.empty(0))
    cos, sin = np.cos(angle), np.sin(angle)
    part = turn.part

    def backward(phi: Array) -> Array:
        return np.asarray(-cos * turn.moment(phi) - sin * turn.potential(phi))

    # d/dphi of it is cos (2 J - U) + sin U', 2 J <= 4/3 R^3 and |U'| <= A R
    rise = 4.0 / 3.0 * part.circumradius**3 + abs(sin) * part.area * part.circumradius
    changes = sign_changes(backward, np.pi, rise, noise=_NOISE * part.area**1.5)
    return SkewedEquilibria(changes.rising, changes.falling)
