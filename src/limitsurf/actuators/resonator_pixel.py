"""A motion pixel: a small tile of torsional resonators, one for each direction."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from limitsurf.errors import ModelError
from limitsurf.modelfiles import Model, Sourced, find_model, load_model, number

__all__ = ["ResonatorPixel", "load_pixel"]

_AXES = {"+x": (1.0, 0.0), "-x": (-1.0, 0.0), "+y": (0.0, 1.0), "-y": (0.0, -1.0)}


@dataclass(frozen=True, eq=False)
class ResonatorPixel:
    """A tile of resonators on a square lattice, each pushing in one direction.

    Attributes
    ----------
    directions : (2, 2, 2) float
        Unit vector of the push of each actuator; rows upwards, columns to the right.
    pitch : float
        Side of the pixel [m].
    grid_width, clearance, effective_width : float
        Side of a resonator's grid, gap to the electrode, and width of the rim that acts [m].
    max_voltage : float
        Largest voltage the model stands for [V].
    tip_width : float
        Width of a tip at the part's outline [m].
    friction : float
        Coefficient mu of a tip on the part.
    offset_fraction, residual_fraction : float
        Mean push, and radius of the friction disk, of a running tip over mu N.
    """

    directions: NDArray[np.float64]
    pitch: float
    grid_width: float
    clearance: float
    effective_width: float
    max_voltage: float
    tip_width: float
    friction: float
    offset_fraction: float
    residual_fraction: float

    def vertical_force(self, voltage: float) -> float:
        """Return what one actuator lifts [N]: ``eps0 perimeter w_eff V^2 / (2 h^2)``.

        The force comes from the rim of the grid (paper, section 5; the effective width is
        calibrated on its 2.8e-7 N at 50 V).
        """
        return self._force_per_square_volt * voltage**2

    def lifting_voltage(self, force: float) -> float:
        """Return the voltage [V] at which one actuator lifts `force` [N]."""
        return float(np.sqrt(force / self._force_per_square_volt))

    @property
    def _force_per_square_volt(self) -> float:
        rim = 4 * self.grid_width * self.effective_width
        return float(epsilon_0 * rim / (2 * self.clearance**2))

    def __repr__(self) -> str:
        """Return the pitch and the number of actuators."""
        return f"ResonatorPixel(2 x 2 actuators, pitch {1e6 * self.pitch:g} um)"


class PixelModel(Model):
    """Schema of a pixel model file."""

    description: str
    directions: list[list[Literal["+x", "-x", "+y", "-y"]]]
    pixel_pitch: Annotated[Sourced, number("m", above=0.0)]
    grid_width: Annotated[Sourced, number("m", above=0.0)]
    clearance: Annotated[Sourced, number("m", above=0.0)]
    effective_width: Annotated[Sourced, number("m", above=0.0)]
    max_voltage: Annotated[Sourced, number("V", above=0.0)]
    tip_width: Annotated[Sourced, number("m", at_least=0.0)]
    friction: Annotated[Sourced, number("", at_least=0.0)]
    offset_fraction: Annotated[Sourced, number("", at_least=0.0)]
    residual_fraction: Annotated[Sourced, number("", at_least=0.0)]


def load_pixel(name_or_path: str | Path) -> ResonatorPixel:
    """Read a pixel model by name or path.

    Raises
    ------
    ModelError
        Names the file, the field and what to do.
    """
    path = find_model("actuators", name_or_path)
    model = load_model(path, PixelModel)
    if sorted(name for row in model.directions for name in row) != sorted(_AXES) or any(
        len(row) != 2 for row in model.directions
    ):
        raise ModelError(path, "directions", "must be 2 x 2, each direction once")
    return ResonatorPixel(
        directions=np.array([[_AXES[name] for name in row] for row in model.directions]),
        pitch=model.pixel_pitch.value,
        grid_width=model.grid_width.value,
        clearance=model.clearance.value,
        effective_width=model.effective_width.value,
        max_voltage=model.max_voltage.value,
        tip_width=model.tip_width.value,
        friction=model.friction.value,
        offset_fraction=model.offset_fraction.value,
        residual_fraction=model.residual_fraction.value,
    )
