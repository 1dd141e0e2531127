"""A torsional resonator: a silicon grid on two rods, driven electrostatically.

Frame: x across the rods, measured from them, y along them, z up; a positive tilt raises +x.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.grid_inertia import grid_inertia, pole_sides
from limitsurf.actuators.resonator_checks import check_resonator
from limitsurf.actuators.resonator_contact import FloatingPart, contact, floating
from limitsurf.actuators.resonator_model import read_resonator
from limitsurf.actuators.resonator_motion import (
    FrequencyResponse,
    ResonatorMotion,
    free_motion,
    lag_for,
    response,
)
from limitsurf.actuators.rim_force import plate_force, rim_force
from limitsurf.actuators.rod_torsion import rod_stiffness
from limitsurf.actuators.static_tilt import equilibrium, pull_in, torque
from limitsurf.errors import InputError, ModelError
from limitsurf.sets.arguments import as_rows

if TYPE_CHECKING:
    from limitsurf.contacts.oscillating_contact import OscillatingContact

__all__ = ["Side", "TorsionalResonator"]

Array = NDArray[np.float64]
Side = Literal["+x", "-x", "both", "none"]


@dataclass(frozen=True)
class TorsionalResonator:
    """Geometry, material and contact of one resonator, SI.

    Attributes
    ----------
    grid_width, grid_length : float
        Extent of the grid across and along the rods [m].
    beam_width, beam_height : float
        Section of all beams, rods included [m].
    beam_pitch : float
        Distance of the grid's beams [m].
    rod_length, rod_offset : float
        Length of each rod and its x from the grid's centre [m].
    clearance : float
        Gap of the rim to its electrodes [m].
    effective_width : float
        Width of the rim that acts [m], calibrated: `rim_force.calibrated_width`.
    cell_area : float
        Area that the actuator takes up in an array [m^2].
    pole_height, pole_section : float
        Height above the grid's face [m], cross-section of a side's poles together [m^2].
    density : float
        Density [kg/m^3].
    shear_modulus_tall, shear_modulus_flat : float
        Shear moduli [Pa] in the planes of the rods' tall and flat faces.
    quality : float
        Quality factor of the free resonator; given, not computed.
    contact_stiffness, contact_damping : float
        Kelvin-Voigt contact of a tip and a part [N/m, N s/m].
    restitution : float
        Falling over rising impulse; 1 if the damping is all the loss. Not both.
    poles, driven : {"+x", "-x", "both", "none"}
        Sides that have poles, sides that are driven (in turn, if both).
    drive : {"sine", "biased"}
        ``V sin(pi f t)``, electrically at half the mechanical frequency f, or
        ``V (1 + cos 2 pi f t) / 2`` at f: torque goes with V^2. V is the peak in either case and
        the torque at f has the same amplitude.
    assumed : tuple of str
        Fields that no source gives.
    name : str
        For reports.

    Examples
    --------
    >>> TorsionalResonator.from_model("resonator1994")
    TorsionalResonator(resonator1994: grid 50 x 50 um, 267 kHz, Q 60)
    """

    grid_width: float
    grid_length: float
    beam_width: float
    beam_height: float
    beam_pitch: float
    rod_length: float
    rod_offset: float
    clearance: float
    effective_width: float
    cell_area: float
    pole_height: float
    pole_section: float
    density: float
    shear_modulus_tall: float
    shear_modulus_flat: float
    quality: float
    contact_stiffness: float
    contact_damping: float = 0.0
    restitution: float = 1.0
    poles: Side = "none"
    driven: Side = "both"
    drive: Literal["sine", "biased"] = "sine"
    assumed: tuple[str, ...] = field(default=(), repr=False)
    name: str = "resonator"

    def __post_init__(self) -> None:
        """Refuse values that no resonator has."""
        check_resonator(self)

    @classmethod
    def from_model(cls, name_or_path: str | Path) -> TorsionalResonator:
        """Read a resonator model by name or path.

        Raises
        ------
        ModelError
            Names the file, the field and what to do.
        """
        values = read_resonator(name_or_path)
        try:
            return cls(**values)
        except InputError as error:
            about = {"value": error.value, "remedy": error.remedy}
            raise ModelError(name_or_path, error.argument, error.problem, **about) from error

    def varied(self, **changes: Any) -> TorsionalResonator:
        """Return the resonator with some fields changed."""
        unknown = sorted(set(changes) - {f.name for f in fields(self)})
        if unknown:
            raise InputError(unknown[0], "is no field of TorsionalResonator")
        return replace(self, **changes)

    @property
    def levers(self) -> tuple[float, float]:
        """Distances of the +x and the -x edge from the rods [m]."""
        half = 0.5 * self.grid_width
        return half - self.rod_offset, half + self.rod_offset

    @property
    def tip_heights(self) -> tuple[float, float]:
        """Heights of the +x and the -x tip above the rods' axis at rest [m]."""
        right, left = pole_sides(self.poles)
        face = 0.5 * self.beam_height
        return face + right * self.pole_height, face + left * self.pole_height

    @property
    def stiffness(self) -> float:
        """Torque of both rods per tilt [N m]."""
        both = 2.0 * rod_stiffness(
            self.beam_width,
            self.beam_height,
            self.rod_length,
            self.shear_modulus_tall,
            self.shear_modulus_flat,
        )
        return float(both)

    @property
    def inertia(self) -> float:
        """Moment of inertia about the rods [kg m^2]; see `grid_inertia`."""
        return float(grid_inertia(vars(self), self.poles))

    @property
    def resonance(self) -> float:
        """Frequency of the free, undriven, undamped grid [Hz]."""
        return float(np.sqrt(self.stiffness / self.inertia) / (2 * np.pi))

    @property
    def damping(self) -> float:
        """Viscous damping [N m s], ``sqrt(k J) / Q``."""
        return float(np.sqrt(self.stiffness * self.inertia)) / self.quality

    @property
    def perimeter(self) -> float:
        """Length of the rim [m]."""
        return 2.0 * (self.grid_width + self.grid_length)

    def vertical_force(self, voltage: ArrayLike) -> Any:
        """Return the vertical force [N] at a constant voltage [V] on the whole rim.

        ``eps0 perimeter w_eff V^2 / (2 h^2)``, calibrated to the finite-element figure of the
        1994 paper. A sine of peak V gives half of it on average.
        """
        return _plain(rim_force(self.perimeter, self.effective_width, self.clearance, voltage))

    def ideal_force(self, voltage: ArrayLike) -> Any:
        """Return what an ideal parallel plate of the grid's outline would give [N]."""
        return _plain(plate_force(self.grid_width * self.grid_length, self.clearance, voltage))

    def force_per_area(self, voltage: ArrayLike) -> Any:
        """Return the vertical force over the cell's area [N/m^2]."""
        return self.vertical_force(voltage) / self.cell_area

    def lifting_voltage(self, force: ArrayLike) -> Any:
        """Return the voltage [V] at which the vertical force is `force` [N]."""
        loads, shape = as_rows("force", np.expand_dims(np.asarray(force), -1), 1)
        if not np.all(loads >= 0.0):
            raise InputError("force", "must not be negative", value=force)
        return _plain(np.sqrt(loads.reshape(shape) / self.vertical_force(1.0)))

    def torque(self, voltage: float, tilt: float = 0.0) -> float:
        """Return the torque [N m] of a constant voltage on the side that `static_tilt` raises."""
        return torque(self, voltage, tilt)

    def static_tilt(self, voltage: float) -> float:
        """Return the tilt [rad] under a constant voltage on one side.

        The driven side, or the -x one if both are, goes down to its electrode.

        Raises
        ------
        BeyondPullIn
            The grid would snap.
        """
        return equilibrium(self, voltage)

    @property
    def pull_in_voltage(self) -> float:
        """Constant voltage [V] on one side at which the tilt becomes unstable."""
        return pull_in(self)

    def motion(self, voltage: float, frequency: float | None = None) -> ResonatorMotion:
        """Return the free oscillation; see `resonator_motion.free_motion`."""
        return free_motion(self, voltage, frequency)

    def amplitude(self, voltage: float, frequency: float | None = None) -> float:
        """Return the amplitude of the farther edge [m] of the free oscillation.

        Parameters
        ----------
        voltage : float
            Peak voltage [V].
        frequency : float, optional
            Mechanical frequency [Hz]; by default where the amplitude is largest.

        Raises
        ------
        AmplitudeBeyondClearance
            The edge would reach its electrode.
        """
        return self.motion(voltage, frequency).edge_amplitude

    def frequency_response(
        self, voltage: float, lags: ArrayLike | None = None
    ) -> FrequencyResponse:
        """Return amplitude and frequency against the lag; see `resonator_motion.response`."""
        return response(self, voltage, lags)

    def floating(
        self, load: float, voltage: float, mu: float, lag: float = 0.5 * np.pi
    ) -> FloatingPart:
        """Return how a part floats on the tips; see `resonator_contact.floating`."""
        return floating(self, load, voltage, mu, lag)

    def contact(
        self,
        load: float,
        voltage: float,
        mu: float,
        *,
        lag: float = 0.5 * np.pi,
        facing: float = 0.0,
        samples: int = 256,
    ) -> OscillatingContact:
        """Return the `OscillatingContact` of the tip; see `resonator_contact.contact`."""
        return contact(self, load, voltage, mu, lag=lag, facing=facing, samples=samples)

    def lag_for(self, voltage: float, edge_amplitude: float) -> float:
        """Return the lag that keeps the free edge at an amplitude; see `resonator_motion`."""
        return lag_for(self, voltage, edge_amplitude)

    def sensitivity(
        self, load: float, voltage: float, mu: float, parameters: tuple[str, ...] | None = None
    ) -> Mapping[str, Mapping[str, float]]:
        """Return relative sensitivities to the assumed numbers; see `resonator_sensitivity`."""
        from limitsurf.actuators.resonator_sensitivity import sensitivity

        return sensitivity(self, load, voltage, mu, parameters)

    def __repr__(self) -> str:
        """Return size, resonance and quality factor."""
        size = f"{1e6 * self.grid_width:g} x {1e6 * self.grid_length:g} um"
        return (
            f"TorsionalResonator({self.name}: grid {size}, {1e-3 * self.resonance:.0f} kHz, "
            f"Q {self.quality:g})"
        )


def _plain(values: Array) -> Any:
    """Return a float for a scalar, else the array."""
    return float(values) if values.ndim == 0 else values
