r"""Steady oscillation of a torsional resonator, free or under a part: one-harmonic balance.

With :math:`\vartheta = \vartheta_0 + A \sin\varphi`, :math:`\varphi = \omega t`, the averages over
a cycle of :math:`J\ddot\vartheta + c\dot\vartheta + k\vartheta = \tau - \sum_i N_i (x_i + \mu z_i
\,\mathrm{sign}\,\dot\vartheta)`, times 1,
:math:`2\cos\varphi` and :math:`2\sin\varphi`, are

.. math:: k\vartheta_0 = T_0, \qquad c\,\omega A = T_c, \qquad (k - J\omega^2) A = T_s.

The torque of the rim is exact in the gap (no small-tilt expansion), the part's reaction brakes and
stiffens the grid. The motion lags the torque by a given phase, so the solution is unique: at a
quarter cycle all of the torque works, the resonance. Fixed-point iteration; free, it rises to the
smallest root from rest; under a part it falls from the free amplitude to the largest. The part's
horizontal velocity is small beside the tips' and is left out of the rubbing.

Against time-stepping of the whole equation the amplitude is right to 3 %, the push to 10 % for a
light part (80 g/m^2) and 22 % too large for a heavy one (3.4e-7 N): the harmonics that contact
excites are left out. The method is that of Krylov and Bogoliubov, *Introduction to Non-linear
Mechanics*, 1943.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.part_height import Float, Tips, float_part
from limitsurf.kernels.rim_torque import RimSide, rim_shape
from limitsurf.kernels.tip_contact import ContactLaw, Push

__all__ = [
    "CLEARANCE",
    "NOT_CONVERGED",
    "OK",
    "STALLED",
    "TIP_STAYS",
    "Drive",
    "Grid",
    "Motion",
    "free_motion",
    "loaded_motion",
    "sweep_designs",
]

OK, CLEARANCE, STALLED, TIP_STAYS, NOT_CONVERGED = 0, 1, 2, 3, 4

_POINTS = 64  # of the averages: spectrally accurate while the edge keeps 10 % of the gap
_STEPS = 2000
_TOLERANCE = 1e-13


class Grid(NamedTuple):
    """Rod stiffness k [N m], inertia J [kg m^2], damping c [N m s], and the two rim sides."""

    stiffness: float
    inertia: float
    damping: float
    right: RimSide
    left: RimSide


class Drive(NamedTuple):
    """``eps0 w_eff V^2 / 2`` [N m] on either side (0: not driven); DC bias or sine at f/2."""

    right: float
    left: float
    biased: bool


class Motion(NamedTuple):
    """Amplitude and mean of the tilt [rad], angular frequency [rad/s], how it ended."""

    amplitude: float
    mean: float
    omega: float
    status: int


@compiled
def _square(phase: float, biased: bool) -> float:
    """Return ``(V(t)/V)^2``: cos^2(phase/2) for a sine at f/2, its square for V(1 + cos)/2."""
    half = 0.5 * (1.0 + math.cos(phase))
    return half * half if biased else half


@compiled
def rim_averages(
    grid: Grid, drive: Drive, amplitude: float, mean: float, lag: float
) -> tuple[float, float, float]:
    """Return the averages of the torque times 1, 2 cos, 2 sin [N m]."""
    constant, cos, sin = 0.0, 0.0, 0.0
    for i in range(_POINTS):
        phase = 2.0 * math.pi * i / _POINTS
        c, s = math.cos(phase), math.sin(phase)
        tilt = mean + amplitude * s
        torque = 0.0
        ahead = phase + lag - 0.5 * math.pi
        if drive.left > 0.0:
            torque += drive.left * _square(ahead, drive.biased) * rim_shape(grid.left, -tilt)
        if drive.right > 0.0:
            opposite = _square(ahead + math.pi, drive.biased)
            torque -= drive.right * opposite * rim_shape(grid.right, tilt)
        constant += torque
        cos += 2.0 * torque * c
        sin += 2.0 * torque * s
    return constant / _POINTS, cos / _POINTS, sin / _POINTS


@compiled
def _frequency(grid: Grid, ratio: float) -> float:
    """Return omega > 0 with ``J omega^2 + c ratio omega - k = 0``, ratio = T_s / T_c."""
    b = 0.5 * grid.damping * ratio
    root = math.sqrt(b * b + grid.inertia * grid.stiffness)
    return grid.stiffness / (b + root) if b > 0.0 else (root - b) / grid.inertia


@compiled
def _hits(grid: Grid, amplitude: float, mean: float) -> bool:
    """Return whether an edge comes within a thousandth of the gap of its electrode."""
    right = grid.right.lever * (amplitude - mean) / grid.right.gap
    left = grid.left.lever * (amplitude + mean) / grid.left.gap
    return not max(right, left) < 0.999


@compiled
def free_motion(grid: Grid, drive: Drive, lag: float) -> Motion:
    """Return the oscillation without a part, lagging the torque by `lag` [rad]."""
    amplitude, mean = 0.0, 0.0
    omega = math.sqrt(grid.stiffness / grid.inertia)
    for _ in range(_STEPS):
        constant, cos, sin = rim_averages(grid, drive, amplitude, mean, lag)
        omega = _frequency(grid, sin / cos)
        before = amplitude
        amplitude, mean = cos / (grid.damping * omega), constant / grid.stiffness
        if _hits(grid, amplitude, mean):
            return Motion(amplitude, mean, omega, CLEARANCE)
        if abs(amplitude - before) <= _TOLERANCE * amplitude:
            return Motion(amplitude, mean, omega, OK)
    return Motion(amplitude, mean, omega, NOT_CONVERGED)


@compiled
def _nothing() -> Float:
    zero = Push(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Float(False, math.nan, 0.0, 0.0, zero, zero)


@compiled
def _reaction(tips: Tips, part: Float, friction: float) -> tuple[float, float, float]:
    """Return the averages of the part's braking torque times 1, 2 cos, 2 sin [N m].

    The left tip is half a cycle behind: its cos and sin change sign, their signed kinds do not.
    """
    right, left = part.right, part.left
    rub_right, rub_left = friction * tips.right_height, friction * tips.left_height
    constant = tips.right * right.mean + tips.left * left.mean
    constant += rub_right * right.signed - rub_left * left.signed
    cos = tips.right * right.cos - tips.left * left.cos
    cos += rub_right * right.signed_cos + rub_left * left.signed_cos
    sin = tips.right * right.sin - tips.left * left.sin
    sin += rub_right * right.signed_sin + rub_left * left.signed_sin
    return constant, 2.0 * cos, 2.0 * sin


@compiled
def loaded_motion(
    grid: Grid,
    drive: Drive,
    tips: Tips,
    contact: ContactLaw,
    load: float,
    friction: float,
    lag: float,
) -> tuple[Motion, Float]:
    """Return the oscillation under a load [N], lagging by `lag`, and how the part floats.

    `contact.loss` is here the damping over the stiffness [s].
    """
    free = free_motion(grid, drive, lag)
    amplitude, mean, omega = free.amplitude, free.mean, free.omega
    part = _nothing()
    if free.status != OK:
        return free, part
    for i in range(_STEPS):
        law = ContactLaw(contact.stiffness, contact.loss * omega, contact.restitution)
        part = float_part(tips, mean, amplitude, law, load)
        if not part.ok:
            return Motion(amplitude, mean, omega, TIP_STAYS), part
        constant, cos, sin = rim_averages(grid, drive, amplitude, mean, lag)
        reaction = _reaction(tips, part, friction)
        constant, cos, sin = constant - reaction[0], cos - reaction[1], sin - reaction[2]
        if cos <= 0.0:
            return Motion(0.0, mean, omega, STALLED), part
        target = _frequency(grid, sin / cos)
        up, tilt = cos / (grid.damping * target) - amplitude, constant / grid.stiffness - mean
        share = 1.0 if i < 100 else (0.3 if i < 300 else 0.03)  # two stiff tips make it swing
        amplitude, mean = amplitude + share * up, mean + share * tilt
        change = max(abs(up), abs(tilt)) / amplitude
        change = max(change, abs(target / omega - 1.0))
        omega += share * (target - omega)
        if change <= 20.0 * _TOLERANCE:
            return Motion(amplitude, mean, omega, OK), part
    return Motion(amplitude, mean, omega, NOT_CONVERGED), part


@compiled
def sweep_designs(designs: Floats, out: Floats) -> None:
    """Fill one row of `out` for each design: see `actuators/resonator_sweep.py` for columns."""
    for i in range(designs.shape[0]):
        d = designs[i]
        grid = Grid(d[0], d[1], d[2], RimSide(d[3], d[4], d[5]), RimSide(d[6], d[4], d[5]))
        drive = Drive(d[7], d[8], d[9] > 0.0)
        tips = Tips(d[10], d[11], d[12], d[13])
        law = ContactLaw(d[14], d[15], d[16])
        motion, part = loaded_motion(grid, drive, tips, law, d[17], d[18], d[19])
        carried = part.right.mean + part.left.mean
        bias = part.left.signed - part.right.signed
        out[i, 0], out[i, 1], out[i, 2] = motion.amplitude, motion.mean, motion.omega
        out[i, 3], out[i, 4], out[i, 5] = part.height, part.right_depth, part.left_depth
        out[i, 6], out[i, 7] = carried, bias
        out[i, 8] = motion.status
