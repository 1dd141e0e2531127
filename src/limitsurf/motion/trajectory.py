"""The record of one motion: poses, loads, energies, and what happened when."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from limitsurf.errors import InputError
from limitsurf.kernels.slide_step import LEFT_ARRAY, NOT_LIFTED, REST, TIME_LIMIT
from limitsurf.motion.netcdf import as_target, write_netcdf
from limitsurf.sets.arguments import as_array

if TYPE_CHECKING:
    import xarray

__all__ = ["EnergyBalance", "EventKind", "MotionEvent", "Outcome", "Trajectory"]

Array = NDArray[np.float64]


class Outcome(IntEnum):
    """How a motion ended; its text says it in words."""

    TIME_LIMIT = TIME_LIMIT
    REST = REST
    LEFT_ARRAY = LEFT_ARRAY
    NOT_LIFTED = NOT_LIFTED
    INTERRUPTED = 4

    def __str__(self) -> str:
        """Return the outcome in words."""
        words = (
            "still moving at the time limit",
            "at rest",
            "left the array",
            "not lifted",
            "interrupted",
        )
        return words[int(self)]


class EventKind(StrEnum):
    """What can happen at an instant."""

    ENTER = "an actuator comes under the part"
    LEAVE = "an actuator leaves the part"
    CAPTURE = "an actuator stays on the outline"
    RELEASE = "an actuator no longer stays on the outline"
    STICK = "a contact sticks"
    SLIP = "a contact slips again"
    SWITCH = "the drive switches"
    START = "the part starts to move"
    REST = "the part rests"
    EDGE = "the part reaches the edge of the array"


@dataclass(frozen=True)
class MotionEvent:
    """One event of a motion.

    Attributes
    ----------
    time : float
        When [s].
    kind : EventKind
        What.
    where : tuple of int
        Of what: ``(row, column)`` of an actuator, ``(i,)`` of a contact, empty for the part.
    """

    time: float
    kind: EventKind
    where: tuple[int, ...] = ()

    def __str__(self) -> str:
        """Return the event in words."""
        where = f" {self.where}" if self.where else ""
        return f"{self.time:.6g} s: {self.kind}{where}"


@dataclass(frozen=True, eq=False)
class EnergyBalance:
    r"""Where the energy went since the start of a motion, at its recorded times [J].

    An implicit step satisfies, exactly,

    .. math:: T_1 - T_0 + \tfrac12 |v_1 - v_0|_M^2 + \Delta t\,(h_L(-v_1) + v_1^T D v_1)
              = \Delta t\, F \cdot v_1

    with F the pushes and external loads, L the passive limit surface: the last term on the left
    but one is friction, and the second what the step itself dissipates.

    Attributes
    ----------
    kinetic : (k,) float
        Kinetic energy T.
    work : (k,) float
        Work of pushes and external loads.
    friction, drag, numerical : (k,) float
        Dissipated by friction, by viscous drag, and by the implicit steps.
    """

    kinetic: Array
    work: Array
    friction: Array
    drag: Array
    numerical: Array

    @property
    def residual(self) -> Array:
        """What does not add up, (k,) [J]: zero but for certified errors and rounding."""
        gained = self.kinetic - self.kinetic[0] - self.work
        return np.asarray(gained + self.friction + self.drag + self.numerical)

    def __repr__(self) -> str:
        """Return the balance at the end."""
        names = ("friction", "drag", "numerical")
        lost = ", ".join(f"{name} {getattr(self, name)[-1]:.3g}" for name in names)
        gained = self.kinetic[-1] - self.kinetic[0]
        left = np.abs(self.residual).max()
        return (
            f"EnergyBalance(work {self.work[-1]:.3g} J; gained {gained:.3g}, lost to {lost}; "
            f"residual at most {left:.1g})"
        )


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Poses of a part over time, with loads, energies and certificates.

    Attributes
    ----------
    times : (k,) float
        Times [s].
    poses : (k, 3) float
        Poses ``(x, y, theta)`` of the centre of mass, array frame [m, m, rad].
    twists : (k, 3) float
        Velocities [m/s, m/s, rad/s]; where they jump, those after the jump.
    loads : (k, 3) float
        Loads of the contacts on the part, about its centre of mass [N, N, N m].
    error_bounds : (k,) float
        Certified error of the frictional load [N], moments over the metric's radius of gyration.
    tips : (k,) int
        Contacts that carry the part.
    outcome : Outcome
        How the motion ended.
    worst_error : float
        Largest error bound of all steps, also of those not recorded, over the size of the loads.
    energy : EnergyBalance
        Energies at the recorded times.
    events : tuple of MotionEvent
        What happened when, in order.
    """

    times: Array
    poses: Array
    twists: Array
    loads: Array
    error_bounds: Array
    tips: NDArray[np.int64]
    outcome: Outcome
    worst_error: float
    energy: EnergyBalance
    events: tuple[MotionEvent, ...] = ()

    @classmethod
    def from_frames(
        cls,
        frames: Array,
        outcome: Outcome,
        worst_error: float,
        events: Iterable[MotionEvent] = (),
    ) -> Trajectory:
        """Return the record of frames (k, 17), as the stepping kernels write them.

        Columns are time, pose, twist, load, error bound, contacts, and the energies: kinetic, work,
        friction, drag, numerical.
        """
        return cls(
            times=frames[:, 0].copy(),
            poses=frames[:, 1:4].copy(),
            twists=frames[:, 4:7].copy(),
            loads=frames[:, 7:10].copy(),
            error_bounds=frames[:, 10].copy(),
            tips=frames[:, 11].astype(np.int64),
            outcome=outcome,
            worst_error=worst_error,
            energy=EnergyBalance(*frames[:, 12:17].T.copy()),
            events=tuple(events),
        )

    @property
    def duration(self) -> float:
        """Time until the end [s]."""
        return float(self.times[-1])

    @property
    def final_pose(self) -> Array:
        """Pose at the end."""
        last: Array = self.poses[-1]
        return last

    @property
    def certificates(self) -> Array:
        """Certified errors of the frictional load at the recorded times: `error_bounds` [N]."""
        return self.error_bounds

    @property
    def held(self) -> bool:
        """Whether it ended certified at rest, and not just too slow to matter.

        Then the last twist is exactly zero, and the contacts hold the part within the last of the
        error bounds.
        """
        return self.outcome is Outcome.REST and not self.twists[-1].any()

    def at(self, times: ArrayLike) -> Array:
        """Return poses (..., 3) at any times (...) of the motion, interpolated without overshoot.

        Monotone cubics between the recorded frames (F. N. Fritsch, R. E. Carlson, *Monotone
        piecewise cubic interpolation*, SIAM J. Numer. Anal. 17, 1980); the angle is not wrapped.
        """
        wanted = as_array("times", times, *np.shape(times))
        if wanted.size and not (self.times[0] <= wanted.min() and wanted.max() <= self.times[-1]):
            raise InputError(
                "times", f"must lie in {self.times[0]:g}..{self.times[-1]:g} s", value=times
            )
        if len(self.times) == 1:
            return np.broadcast_to(self.poses[0], (*wanted.shape, 3)).copy()
        return np.asarray(PchipInterpolator(self.times, self.poses)(wanted))

    def to_dataset(self) -> xarray.Dataset:
        """Return the record as an xarray dataset with units."""
        import xarray

        axes = {
            "pose": ["x", "y", "theta"],
            "twist": ["vx", "vy", "omega"],
            "load": ["fx", "fy", "m"],
        }
        joule = {"units": "J"}
        data = {
            "poses": (("time", "pose"), self.poses, {"units": "m, m, rad"}),
            "twists": (("time", "twist"), self.twists, {"units": "m/s, m/s, rad/s"}),
            "loads": (("time", "load"), self.loads, {"units": "N, N, N m"}),
            "error_bounds": (("time",), self.error_bounds, {"units": "N"}),
            "tips": (("time",), self.tips.astype(np.int32)),
            "kinetic_energy": (("time",), self.energy.kinetic, joule),
            "work": (("time",), self.energy.work, joule),
            "friction_loss": (("time",), self.energy.friction, joule),
            "drag_loss": (("time",), self.energy.drag, joule),
            "numerical_loss": (("time",), self.energy.numerical, joule),
            "event_time": (("event",), np.array([e.time for e in self.events]), {"units": "s"}),
            "event": (("event",), np.array([e.kind.name for e in self.events], dtype="U8")),
        }
        time = ("time", self.times, {"units": "s"})
        return xarray.Dataset(
            data, coords={"time": time, **axes}, attrs={"outcome": str(self.outcome)}
        )

    def save(self, path: str | Path) -> None:
        """Write the record to a NetCDF file, as a whole: a broken write leaves the one before."""
        if (target := as_target(path)) is not None:
            write_netcdf(self.to_dataset(), target)

    def __repr__(self) -> str:
        """Return duration and outcome."""
        return f"Trajectory({len(self.times)} frames, {self.duration:.3g} s, {self.outcome})"
