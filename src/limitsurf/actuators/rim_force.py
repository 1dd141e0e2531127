r"""Electrostatic force on a grid's rim, and its calibration.

The 1994 paper's finite-element model gives 2.8e-7 N at 50 V, an eleventh of the ideal parallel
plate. The force comes from the rim: :math:`F = \varepsilon_0 P w_{eff} V^2 / (2h^2)` with the
perimeter P, the gap h and an effective width of about one beam, which is calibrated. At fixed
voltage, gap and beam section it falls in proportion to the grid's size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import epsilon_0

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_rows

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["ForceScaling", "calibrated_width", "force_scaling", "plate_force", "rim_force"]

Array = NDArray[np.float64]


def rim_force(perimeter: float, width: float, gap: float, voltage: ArrayLike) -> Array:
    """Return ``eps0 perimeter width V^2 / (2 gap^2)`` [N]."""
    volts, shape = as_rows("voltage", np.expand_dims(np.asarray(voltage), -1), 1)
    if not (np.isfinite(volts).all() and (volts >= 0.0).all()):
        raise InputError("voltage", "must be finite and not negative", value=voltage)
    return np.asarray(epsilon_0 * perimeter * width * volts.reshape(shape) ** 2 / (2 * gap**2))


def plate_force(area: float, gap: float, voltage: ArrayLike) -> Array:
    """Return what an ideal parallel plate would give, ``eps0 area V^2 / (2 gap^2)`` [N]."""
    return rim_force(area, 1.0, gap, voltage)


def calibrated_width(force: float, perimeter: float, gap: float, voltage: float) -> float:
    """Return the effective width [m] that makes `rim_force` equal to a known force [N].

    Examples
    --------
    >>> round(1e6 * calibrated_width(2.8e-7, 200e-6, 3e-6, 50.0), 2)
    1.14
    """
    return float(force / rim_force(perimeter, 1.0, gap, voltage))


@dataclass(frozen=True, eq=False)
class ForceScaling:
    """The paper's scaling claim as data for a curve.

    Attributes
    ----------
    sizes : (n,) float
        Widths of the grid [m]; its length and the cell's sides scale along.
    force : (n,) float
        Vertical force of an actuator [N]; proportional to the size.
    force_per_area : (n,) float
        The same over the cell's area [N/m^2]; proportional to 1/size.
    condition : str
        What stays fixed.
    """

    sizes: Array
    force: Array
    force_per_area: Array
    condition: str


def force_scaling(resonator: TorsionalResonator, sizes: ArrayLike, voltage: float) -> ForceScaling:
    """Return force and force per area against the size of the grid (1994 paper, section 5).

    Voltage, gap and beam section stay fixed; grid and cell shrink in proportion. Were the gap and
    the effective width to shrink too, the force would not fall at all.

    Examples
    --------
    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> curve = force_scaling(TorsionalResonator.from_model("resonator1994"), [25e-6, 50e-6], 50)
    >>> round(float(curve.force_per_area[0] / curve.force_per_area[1]), 9)
    2.0
    """
    grown = np.asarray(sizes, np.float64)
    if not (np.isfinite(grown).all() and (grown > 0.0).all()):
        raise InputError("sizes", "must be positive", value=sizes)
    scale = grown / resonator.grid_width
    force = resonator.vertical_force(voltage) * scale
    return ForceScaling(
        sizes=grown,
        force=force,
        force_per_area=force / (resonator.cell_area * scale**2),
        condition=f"{voltage:g} V, gap {1e6 * resonator.clearance:g} um and beam section fixed",
    )
