"""A rectangular array of motion pixels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.constants import g

from limitsurf.actuators.resonator_pixel import ResonatorPixel, load_pixel
from limitsurf.actuators.spread import SiteSpread, draw_spread
from limitsurf.errors import InputError, ModelError
from limitsurf.geometry.part import Part
from limitsurf.modelfiles import Model, Sourced, find_model, load_model, number
from limitsurf.units import parse_quantity

__all__ = ["ActuatorArray", "load_array"]


@dataclass(frozen=True, eq=False)
class ActuatorArray:
    """Rows and columns of equal pixels; the origin of its frame is the array's centre.

    Attributes
    ----------
    pixel : ResonatorPixel
        The pixel.
    rows, columns : int
        Number of pixels.
    voltage : float
        Drive voltage [V].
    air_viscosity, air_film : float
        Viscosity [Pa s] and height [m] of the air between part and array, for the drag.
    name : str
        For reports.
    spread : SiteSpread, optional
        Deviations of the actuators, arrays (R, C).
    """

    pixel: ResonatorPixel
    rows: int
    columns: int
    voltage: float
    air_viscosity: float
    air_film: float
    name: str = "array"
    spread: SiteSpread | None = None

    @property
    def width(self) -> float:
        """Extent along x [m]."""
        return self.columns * self.pixel.pitch

    @property
    def height(self) -> float:
        """Extent along y [m]."""
        return self.rows * self.pixel.pitch

    @property
    def site_pitch(self) -> float:
        """Distance of neighbouring actuators [m]."""
        return self.pixel.pitch / 2

    @property
    def nominal_directions(self) -> NDArray[np.float64]:
        """Unit vector of the push of every actuator, had they no spread, (R, C, 2)."""
        return np.tile(self.pixel.directions, (self.rows, self.columns, 1))

    @property
    def site_directions(self) -> NDArray[np.float64]:
        """Push of every actuator over the nominal push, (R, C, 2): unit vectors without spread."""
        nominal = self.nominal_directions
        return nominal if self.spread is None else self.spread.pushes(nominal)

    @property
    def alive(self) -> NDArray[np.bool_]:
        """Whether an actuator can run, (R, C)."""
        shape = (2 * self.rows, 2 * self.columns)
        return np.ones(shape, bool) if self.spread is None else ~self.spread.dead

    @property
    def first_site(self) -> tuple[float, float]:
        """Position of the actuator in row 0, column 0 [m]."""
        half = 0.5 * self.site_pitch
        return half - 0.5 * self.width, half - 0.5 * self.height

    @property
    def pixel_centers(self) -> NDArray[np.float64]:
        """Positions of the pixels, (rows, columns, 2) [m]."""
        x = (np.arange(self.columns) + 0.5) * self.pixel.pitch - 0.5 * self.width
        y = (np.arange(self.rows) + 0.5) * self.pixel.pitch - 0.5 * self.height
        return np.stack(np.meshgrid(x, y), axis=-1)

    def at_voltage(self, voltage: float | str) -> ActuatorArray:
        """Return the same array driven at another voltage, a number [V] or a text."""
        volts = parse_quantity(voltage, "V", name="voltage")
        if not 0.0 < volts <= self.pixel.max_voltage:
            raise InputError(
                "voltage",
                f"must lie above 0 and at most {self.pixel.max_voltage:g} V",
                value=voltage,
                remedy="the model says why",
            )
        return replace(self, voltage=volts)

    def with_spread(
        self, *, strength: float = 0.0, direction: float = 0.0, dead: float = 0.0, seed: int = 0
    ) -> ActuatorArray:
        """Return the array with actuators that differ; see `draw_spread`."""
        shape = (2 * self.rows, 2 * self.columns)
        drawn = draw_spread(shape, strength=strength, direction=direction, dead=dead, seed=seed)
        return replace(self, spread=drawn)

    def running_under(self, part: Part) -> ActuatorArray:
        """Return the array with the push of its tips computed for a part at this voltage.

        One active tip a pixel carries the part; see `ResonatorPixel.running`.

        Raises
        ------
        PartTooHeavy, TipStalled, AmplitudeBeyondClearance
            The resonators cannot run so; see `TorsionalResonator.floating`.
        """
        load = part.mass / part.area * g * self.pixel.pitch**2
        return replace(self, pixel=self.pixel.running(load, self.voltage))

    def __repr__(self) -> str:
        """Return pixels, size and voltage."""
        size = f"{1e3 * self.width:g} x {1e3 * self.height:g} mm"
        return f"ActuatorArray({self.columns} x {self.rows} pixels, {size}, {self.voltage:g} V)"


class ArrayModel(Model):
    """Schema of an array model file."""

    description: str
    actuator: str
    rows: Annotated[Sourced, number("", at_least=1.0)]
    columns: Annotated[Sourced, number("", at_least=1.0)]
    voltage: Annotated[Sourced, number("V", above=0.0)]
    air_viscosity: Annotated[Sourced, number("Pa*s", above=0.0)]
    air_film: Annotated[Sourced, number("m", above=0.0)]


def load_array(name_or_path: str | Path, *, voltage: float | str | None = None) -> ActuatorArray:
    """Read an array model by name or path.

    Parameters
    ----------
    name_or_path : str or Path
        Such as ``"resonator64"``, or a TOML file. Its `actuator` is a name, or a path relative to
        the file.
    voltage : float or str, optional
        Drive voltage instead of the model's.

    Raises
    ------
    ModelError
        Names the file, the field and what to do.

    Examples
    --------
    >>> load_array("resonator64")
    ActuatorArray(64 x 64 pixels, 12.8 x 12.8 mm, 50 V)
    """
    path = find_model("arrays", name_or_path)
    model = load_model(path, ArrayModel)
    beside = path.parent / model.actuator
    array = ActuatorArray(
        pixel=load_pixel(beside if beside.is_file() else model.actuator),
        rows=_count(path, "rows", model.rows.value),
        columns=_count(path, "columns", model.columns.value),
        voltage=model.voltage.value,
        air_viscosity=model.air_viscosity.value,
        air_film=model.air_film.value,
        name=path.stem,
    )
    return array.at_voltage(array.voltage if voltage is None else voltage)


def _count(path: Path, field: str, value: float) -> int:
    if value != round(value):
        raise ModelError(path, field, "must be a whole number", value=value)
    return int(value)
