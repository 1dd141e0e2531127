"""Viscous drag of the air film under a part."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.geometry.part import Part

__all__ = ["air_film_drag"]


def air_film_drag(part: Part, array: ActuatorArray) -> NDArray[np.float64]:
    """Return the drag ``(eta/h) (A, A, polar second moment)`` [kg/s, kg/s, kg m^2/s].

    Couette flow in a film of height h and viscosity eta under the part's area A.
    """
    rate = array.air_viscosity / array.air_film
    return rate * np.array([part.area, part.area, part.polar_moment])
