"""Free oscillation of a resonator: amplitude at a frequency, frequency response."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from limitsurf.actuators.resonator_kernel import drive_record, grid_record
from limitsurf.errors import AmplitudeBeyondClearance, InputError, SolveFailed
from limitsurf.kernels.resonator_balance import CLEARANCE, NOT_CONVERGED, OK, Motion
from limitsurf.kernels.resonator_balance import free_motion as solve_free
from limitsurf.sets.arguments import as_array, as_number

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["FrequencyResponse", "ResonatorMotion", "free_motion", "lag_for", "response"]

Array = NDArray[np.float64]

_SCAN = 161  # points of the search for a lag at a given frequency


@dataclass(frozen=True)
class ResonatorMotion:
    """A steady oscillation ``tilt = mean_tilt + tilt_amplitude sin(2 pi frequency t)``.

    Attributes
    ----------
    tilt_amplitude, mean_tilt : float
        Of the tilt [rad].
    edge_amplitude : float
        Of the height of the farther edge [m].
    frequency : float
        Mechanical frequency [Hz].
    lag : float
        Phase by which the tilt is behind the torque [rad].
    """

    tilt_amplitude: float
    mean_tilt: float
    edge_amplitude: float
    frequency: float
    lag: float


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Amplitude over frequency, as a curve over the lag.

    At large amplitudes the electrostatic torque softens the spring and the curve leans over: one
    frequency may have three amplitudes, one lag has one. NaN where the edge would hit.

    Attributes
    ----------
    frequency : (n,) float
        Mechanical frequency [Hz].
    edge_amplitude : (n,) float
        Amplitude of the farther edge [m].
    lag : (n,) float
        Phase of the tilt behind the torque [rad].
    """

    frequency: Array
    edge_amplitude: Array
    lag: Array


def _solve(resonator: TorsionalResonator, voltage: float, lag: float) -> Motion:
    return solve_free(grid_record(resonator), drive_record(resonator, voltage), lag)


def _record(resonator: TorsionalResonator, motion: Motion, lag: float) -> ResonatorMotion:
    edge = max(resonator.levers) * motion.amplitude
    frequency = motion.omega / (2 * np.pi)
    return ResonatorMotion(motion.amplitude, motion.mean, edge, frequency, lag)


def free_motion(
    resonator: TorsionalResonator, voltage: float, frequency: float | None = None
) -> ResonatorMotion:
    """Return the free oscillation at a peak voltage [V] and mechanical frequency [Hz].

    Without a frequency: at phase resonance, a quarter cycle behind the torque, where a drive that
    follows the motion keeps it; the largest amplitude but for 1/Q^2. Where a frequency has several
    amplitudes, the largest: the branch that a downward sweep follows.

    Raises
    ------
    AmplitudeBeyondClearance
        The edge would reach its electrode.

    Examples
    --------
    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> motion = free_motion(TorsionalResonator.from_model("resonator1994"), 50.0)
    >>> round(1e6 * motion.edge_amplitude, 2), round(1e-3 * motion.frequency)
    (1.11, 265)
    """
    if frequency is None:
        lag = 0.5 * np.pi
    elif np.isfinite(as_number("frequency", frequency)) and frequency > 0.0:
        lag = _lag_at(resonator, voltage, 2 * np.pi * frequency)
    else:
        raise InputError("frequency", "must be positive", value=frequency)
    motion = _solve(resonator, voltage, lag)
    check_status(resonator, voltage, motion)
    return _record(resonator, motion, lag)


def check_status(resonator: TorsionalResonator, voltage: float, motion: Motion) -> None:
    """Raise the error of a free motion that failed."""
    if motion.status == CLEARANCE:
        edge = max(resonator.levers) * (motion.amplitude + abs(motion.mean))
        raise AmplitudeBeyondClearance(voltage, edge, resonator.clearance)
    if motion.status == NOT_CONVERGED:
        raise SolveFailed("the balance of the resonator did not converge", best=motion)


def _lag_at(resonator: TorsionalResonator, voltage: float, omega: float) -> float:
    """Return the lag [rad] of the largest motion at an angular frequency.

    Without the electrostatic spring, cot(lag) is ``(k - J omega^2) / (c omega)``.
    """
    grid = grid_record(resonator)
    linear = (grid.stiffness - grid.inertia * omega**2) / (grid.damping * omega)
    wide = max(abs(linear), 1.0)
    cotangents = np.sinh(np.linspace(-np.arcsinh(3 * wide), np.arcsinh(3 * wide), _SCAN))
    motions = [_solve(resonator, voltage, _lag(c)) for c in cotangents]
    good = np.array([m.status == OK for m in motions])
    excess = np.array([m.omega for m in motions]) - omega

    def error(cotangent: float) -> float:
        return float(_solve(resonator, voltage, _lag(cotangent)).omega - omega)

    change = good[1:] & good[:-1] & (excess[1:] * excess[:-1] <= 0.0)
    spots = np.flatnonzero(change)
    roots = [brentq(error, cotangents[i], cotangents[i + 1], xtol=1e-13) for i in spots]
    if not roots:
        worst = motions[int(np.flatnonzero(~good)[0])] if not good.all() else motions[0]
        check_status(resonator, voltage, worst)
        raise SolveFailed("no steady oscillation at this frequency was found")
    return max((_lag(c) for c in roots), key=lambda x: _solve(resonator, voltage, x).amplitude)


def lag_for(resonator: TorsionalResonator, voltage: float, edge_amplitude: float) -> float:
    """Return the lag [rad], at most a quarter cycle, at which the free edge swings by no more.

    A drive that leads the motion by less than a quarter cycle does less work: so a resonator can
    run at a voltage that would throw it against its electrode at resonance.

    Parameters
    ----------
    resonator : TorsionalResonator
        The resonator.
    voltage : float
        Peak voltage [V].
    edge_amplitude : float
        Of the farther edge [m], below the clearance.

    Raises
    ------
    InputError
        Every lag swings farther, or the swing runs away before it gets as far.

    Examples
    --------
    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> one = TorsionalResonator.from_model("resonator1994")
    >>> lag = lag_for(one, 75.0, 1.5e-6)
    >>> round(1e6 * max(one.levers) * one.floating(1e-12, 75.0, 0.3, lag).tilt_amplitude, 2)
    1.5
    """
    if not 0.0 < as_number("edge_amplitude", edge_amplitude) < resonator.clearance:
        raise InputError("edge_amplitude", "must lie below the clearance", value=edge_amplitude)

    def excess(lag: float) -> float:
        motion = _solve(resonator, voltage, lag)
        if motion.status != OK:
            return resonator.clearance
        return float(max(resonator.levers) * motion.amplitude - edge_amplitude)

    if excess(0.5 * np.pi) <= 0.0:
        return 0.5 * np.pi
    shortest = 1e-3
    if excess(shortest) > 0.0:
        remedy = "lower the voltage or allow a larger swing"
        problem = f"is exceeded at {voltage:g} V whatever the lag"
        raise InputError("edge_amplitude", problem, value=edge_amplitude, remedy=remedy)
    lag = float(brentq(excess, shortest, 0.5 * np.pi, xtol=1e-12))
    if abs(excess(lag)) > 1e-3 * edge_amplitude:
        problem = f"is not reached at {voltage:g} V: the swing runs away before"
        remedy = "ask for less, such as half of the clearance"
        raise InputError("edge_amplitude", problem, value=edge_amplitude, remedy=remedy)
    return lag


def _lag(cotangent: float) -> float:
    return float(np.arctan2(1.0, cotangent))


def response(
    resonator: TorsionalResonator, voltage: float, lags: ArrayLike | None = None
) -> FrequencyResponse:
    """Return the frequency response at a peak voltage [V].

    Parameters
    ----------
    resonator : TorsionalResonator
        The resonator.
    voltage : float
        Peak voltage [V].
    lags : (n,) float, optional
        Phases of the tilt behind the torque, between 0 and pi [rad].
    """
    phases = np.linspace(0.02, np.pi - 0.02, 181) if lags is None else as_array("lags", lags, None)
    if not np.all((phases > 0.0) & (phases < np.pi)):
        raise InputError("lags", "must lie between 0 and pi")
    motions = [_solve(resonator, voltage, float(lag)) for lag in phases]
    good = np.array([m.status == OK for m in motions])
    edge = max(resonator.levers) * np.array([m.amplitude for m in motions])
    return FrequencyResponse(
        np.array([m.omega for m in motions]) / (2 * np.pi), np.where(good, edge, np.nan), phases
    )
