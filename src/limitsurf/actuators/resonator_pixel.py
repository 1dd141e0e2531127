"""A motion pixel: a small tile of torsional resonators, one for each direction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.torsional_resonator import TorsionalResonator
from limitsurf.contacts.oscillating_contact import OscillatingContact
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
    resonator : TorsionalResonator
        Each of the actuators, turned so that it pushes in its direction.
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
    resonator: TorsionalResonator
    max_voltage: float
    tip_width: float
    friction: float
    offset_fraction: float
    residual_fraction: float

    def vertical_force(self, voltage: float) -> float:
        """Return what one actuator lifts [N]; see `TorsionalResonator.vertical_force`."""
        return float(self.resonator.vertical_force(voltage))

    def lifting_voltage(self, force: float) -> float:
        """Return the voltage [V] at which one actuator lifts `force` [N]."""
        return float(self.resonator.lifting_voltage(force))

    def running(self, load: float, voltage: float) -> ResonatorPixel:
        """Return the pixel with the push computed from the resonator, not the model's guess.

        Parameters
        ----------
        load : float
            Weight on each running tip [N].
        voltage : float
            Peak voltage [V].

        Notes
        -----
        Where the free edge would swing by more than half of the clearance at resonance, the drive
        leads the motion by less, see `resonator_motion.lag_for`.

        The tip of a resonator is never at rest, so nothing is left of its friction disk.

        Examples
        --------
        >>> pixel = load_pixel("resonator1994")
        >>> (pixel.offset_fraction, round(pixel.running(3.1e-8, 50.0).offset_fraction, 2))
        (0.1, 0.16)
        """
        lag = self.resonator.lag_for(voltage, 0.5 * self.resonator.clearance)
        part = self.resonator.floating(load, voltage, self.friction, lag)
        return replace(self, offset_fraction=abs(part.offset_fraction), residual_fraction=0.0)

    def tip(self, load: float, voltage: float, samples: int = 64) -> OscillatingContact:
        """Return how a running tip moves under a load [N], computed as in `running`.

        Examples
        --------
        >>> tip = load_pixel("resonator1994").tip(3.1e-8, 50.0)  # pushes along -x
        >>> abs(tip.offset[0] / (tip.mu * 3.1e-8)).round(2)
        np.float64(0.15)
        """
        lag = self.resonator.lag_for(voltage, 0.5 * self.resonator.clearance)
        return self.resonator.contact(load, voltage, self.friction, lag=lag, samples=samples)

    def __repr__(self) -> str:
        """Return the pitch and the number of actuators."""
        return f"ResonatorPixel(2 x 2 actuators, pitch {1e6 * self.pitch:g} um)"


class PixelModel(Model):
    """Schema of a pixel model file."""

    description: str
    resonator: str
    directions: list[list[Literal["+x", "-x", "+y", "-y"]]]
    pixel_pitch: Annotated[Sourced, number("m", above=0.0)]
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
    beside = path.parent / model.resonator
    return ResonatorPixel(
        directions=np.array([[_AXES[name] for name in row] for row in model.directions]),
        pitch=model.pixel_pitch.value,
        resonator=TorsionalResonator.from_model(beside if beside.is_file() else model.resonator),
        max_voltage=model.max_voltage.value,
        tip_width=model.tip_width.value,
        friction=model.friction.value,
        offset_fraction=model.offset_fraction.value,
        residual_fraction=model.residual_fraction.value,
    )
