"""A part on the tips of a running resonator: height, phases, waveforms, push."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.resonator_kernel import (
    contact_law,
    drive_record,
    grid_record,
    tips_record,
)
from limitsurf.actuators.resonator_motion import check_status
from limitsurf.errors import InputError, PartTooHeavy, TipStalled
from limitsurf.kernels.resonator_balance import STALLED, TIP_STAYS, loaded_motion
from limitsurf.kernels.tip_contact import ContactLaw, half_angle, release_angle, tip_cells
from limitsurf.sets.arguments import as_number

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator
    from limitsurf.contacts.oscillating_contact import OscillatingContact

__all__ = ["FloatingPart", "TipWaveforms", "contact", "floating"]

Array = NDArray[np.float64]

_REASONS = {
    STALLED: "the part takes more work from the grid than the drive gives",
    TIP_STAYS: "the tip would never leave the part",
}


@dataclass(frozen=True, eq=False)
class TipWaveforms:
    """One period of the two tips (+x, -x), uniform in time.

    Attributes
    ----------
    time : (n,) float
        Times [s].
    height : (2, n) float
        Heights above the rods [m].
    velocity : (2, n) float
        Lateral velocities along x [m/s].
    normal_force : (2, n) float
        Normal forces on the part [N].
    """

    time: Array
    height: Array
    velocity: Array
    normal_force: Array


@dataclass(frozen=True, eq=False)
class FloatingPart:
    """A part that rests on average on one running resonator.

    Attributes
    ----------
    resonator : TorsionalResonator
        The resonator.
    load, voltage, mu, lag : float
        Weight carried [N], peak voltage [V], friction coefficient, phase behind the torque [rad].
    frequency, tilt_amplitude, mean_tilt, edge_amplitude : float
        The loaded oscillation [Hz, rad, rad, m].
    height : float
        Of the part's underside above the rods' axis [m].
    depths : (2,) float
        By which the peaks of the +x and -x tips would reach into the part [m]; negative: misses.
    touch, release : (2,) float
        Phases of the tilt's cycle by which contact begins before and ends after a tip's peak [rad].
    shares : (2,) float
        Part of the load on each tip.
    offset_fraction : float
        Mean push along +x over mu times the load, at rest.
    """

    resonator: TorsionalResonator
    load: float
    voltage: float
    mu: float
    lag: float
    frequency: float
    tilt_amplitude: float
    mean_tilt: float
    edge_amplitude: float
    height: float
    depths: Array
    touch: Array
    release: Array
    shares: Array
    offset_fraction: float

    @property
    def offset(self) -> float:
        """Mean push along +x on a resting part [N]."""
        return self.mu * self.load * self.offset_fraction

    def waveforms(self, samples: int = 256) -> TipWaveforms:
        """Return one period of the tips' motion and forces, from the lowest point of the +x tip.

        Samples lie half a step off the peaks, so that no two of the lateral velocity are zero: the
        tip never rests. Forces are means over a step: they carry the load exactly, and the push of
        the joined samples is off by 1/samples^2, with a restitution by 1/samples.
        """
        if samples < 16 or samples % 2:
            raise InputError("samples", "must be even and at least 16", value=samples)
        phase = 2 * np.pi * (np.arange(samples) + 0.5) / samples - 0.5 * np.pi
        right, left = self.resonator.levers
        tops = np.array(self.resonator.tip_heights)[:, None]
        tilt = self.mean_tilt + self.tilt_amplitude * np.sin(phase)
        omega = 2 * np.pi * self.frequency
        law = _at_frequency(self.resonator, omega)
        plus = tip_cells(law, right * self.tilt_amplitude, self.depths[0], samples)
        minus = tip_cells(law, left * self.tilt_amplitude, self.depths[1], samples)
        return TipWaveforms(
            time=(phase + 0.5 * np.pi) / omega,
            height=tops + np.array([[right], [-left]]) * tilt,
            velocity=-tops * self.tilt_amplitude * omega * np.cos(phase),
            normal_force=np.stack([plus, np.roll(minus, samples // 2)]),
        )


def _at_frequency(resonator: TorsionalResonator, omega: float) -> ContactLaw:
    law = contact_law(resonator)
    return ContactLaw(law.stiffness, law.loss * omega, law.restitution)


def floating(
    resonator: TorsionalResonator,
    load: float,
    voltage: float,
    mu: float,
    lag: float = 0.5 * np.pi,
) -> FloatingPart:
    r"""Return how a part floats on a running resonator, from mean normal force = load.

    The part stands still within a cycle (it is some 500 times heavier than the grid) and is level.
    Its normal force brakes the grid by the loss of the contact and by friction. The drive follows
    the motion at a fixed phase, so that the frequency follows the load.

    Parameters
    ----------
    resonator : TorsionalResonator
        The resonator.
    load : float
        Weight that it carries [N].
    voltage : float
        Peak voltage [V].
    mu : float
        Friction coefficient of tip and part.
    lag : float
        Phase of the tilt behind the torque [rad]; a quarter cycle is resonance, less swings less:
        see `resonator_motion.lag_for`.

    Raises
    ------
    PartTooHeavy
        The load exceeds the vertical force at this voltage; names the voltage needed.
    TipStalled
        The grid would stop, or a tip would never leave the part.
    AmplitudeBeyondClearance
        The free edge would reach its electrode.

    Examples
    --------
    Paper, 80 g/m^2 on one active tip per 200 um pixel, on a pole at +x:

    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> part = floating(TorsionalResonator.from_model("resonator1994"), 3.1e-8, 50.0, 0.3)
    >>> bool(part.offset < 0.0)
    True
    """
    _check_arguments(resonator, load, voltage, mu, lag)
    motion, part = loaded_motion(
        grid_record(resonator),
        drive_record(resonator, voltage),
        tips_record(resonator),
        contact_law(resonator),
        float(load),
        float(mu),
        float(lag),
    )
    if motion.status in _REASONS:
        raise TipStalled(load, voltage, _REASONS[motion.status])
    check_status(resonator, voltage, motion)
    levers, depths = np.array(resonator.levers), np.array([part.right_depth, part.left_depth])
    swings = levers * motion.amplitude
    loss = _at_frequency(resonator, motion.omega).loss
    touch = np.array([half_angle(d, a) for d, a in zip(depths, swings, strict=True)])
    release = np.array([release_angle(x, loss) if x > 0.0 else 0.0 for x in touch])
    means = np.array([part.right.mean, part.left.mean])
    return FloatingPart(
        resonator=resonator,
        load=float(load),
        voltage=float(voltage),
        mu=float(mu),
        lag=float(lag),
        frequency=motion.omega / (2 * np.pi),
        tilt_amplitude=motion.amplitude,
        mean_tilt=motion.mean,
        edge_amplitude=float(swings.max()),
        height=part.height,
        depths=depths,
        touch=touch,
        release=release,
        shares=means / means.sum(),
        offset_fraction=float((part.left.signed - part.right.signed) / means.sum()),
    )


def _check_arguments(
    resonator: TorsionalResonator, load: float, voltage: float, mu: float, lag: float
) -> None:
    for name, value in (("load", load), ("mu", mu), ("lag", lag)):
        as_number(name, value)
    if not (np.isfinite(load) and load > 0.0):
        raise InputError("load", "must be positive", value=load)
    if not (np.isfinite(mu) and mu >= 0.0):
        raise InputError("mu", "must not be negative", value=mu)
    if not 0.0 < lag < np.pi:
        raise InputError("lag", "must lie between 0 and pi", value=lag)
    drive_record(resonator, voltage)
    force = resonator.vertical_force(voltage)
    if load > force:
        raise PartTooHeavy(load, force, voltage, resonator.lifting_voltage(load))


def contact(
    resonator: TorsionalResonator,
    load: float,
    voltage: float,
    mu: float,
    *,
    lag: float = 0.5 * np.pi,
    facing: float = 0.0,
    samples: int = 256,
) -> OscillatingContact:
    """Return the `OscillatingContact` of a running resonator under a part.

    Parameters
    ----------
    resonator : TorsionalResonator
        The resonator.
    load, voltage, mu, lag : float
        As in `floating`.
    facing : float
        Angle of the resonator's x-axis in the array's frame [rad].
    samples : int
        Samples of the waveforms over one period.

    Raises
    ------
    InputError
        Both tips touch and have different heights: no single waveform describes them.
    """
    from limitsurf.contacts.oscillating_contact import OscillatingContact  # loads its kernels

    velocity, force = single_tip(floating(resonator, load, voltage, mu, lag), samples)
    direction = np.array([np.cos(facing), np.sin(facing)])
    return OscillatingContact(mu, direction, velocity, force)


def single_tip(part: FloatingPart, samples: int = 256) -> tuple[Array, Array]:
    """Return lateral velocity [m/s] and normal force [N] of the tips as one.

    Two tips of one height move sideways together, so that their forces add.
    """
    waves = part.waveforms(samples)
    heights = part.resonator.tip_heights
    touching = np.flatnonzero(part.shares > 0.0)
    if len(touching) == 2 and heights[0] != heights[1]:
        raise InputError(
            "load",
            "presses the part onto both tips, which differ in height",
            value=part.load,
            remedy="lower it, raise the poles or the voltage",
        )
    return waves.velocity[touching[0]], waves.normal_force.sum(axis=0)
