"""Simulate a part from many starts at once."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray
from rich.progress import track

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.engine import Engine
from limitsurf.motion.engines import Drive, engine_of
from limitsurf.motion.netcdf import as_target, write_netcdf
from limitsurf.motion.simulate import simulate
from limitsurf.motion.starts import read_starts
from limitsurf.motion.trajectory import Outcome, Trajectory
from limitsurf.sets.arguments import as_array, as_count

if TYPE_CHECKING:
    import xarray

__all__ = ["Runs", "simulate_many"]

Array = NDArray[np.float64]

_SAVE_EVERY = 30.0  # seconds


@dataclass(frozen=True, eq=False)
class Runs:
    """Where many motions of a part began and ended.

    Attributes
    ----------
    part : Part
        The part.
    drive : Activation, Schedule, field, contacts or callable
        What moved it.
    options : dict
        Options of `simulate`.
    starts, finals : (n, 3) float
        Poses before and after [m, m, rad].
    durations : (n,) float
        Times until the end [s].
    outcomes : (n,) int
        How each ended, values of `Outcome`.
    worst_errors : (n,) float
        Largest certified errors of the frictional load, over the size of the loads.
    """

    part: Part
    drive: Drive
    options: dict[str, Any]
    starts: Array
    finals: Array
    durations: Array
    outcomes: NDArray[np.int64]
    worst_errors: Array

    def __len__(self) -> int:
        """Return n."""
        return len(self.starts)

    def count(self, outcome: Outcome) -> int:
        """Return how many ended so."""
        return int((self.outcomes == outcome).sum())

    def replay(self, run: int, *, frames: int = 200) -> Trajectory:
        """Simulate one run again and return its trajectory."""
        if not as_count("run", run, 0) < len(self):
            raise InputError("run", f"must lie in 0..{len(self) - 1}", value=run)
        return simulate(self.part, self.drive, self.starts[run], frames=frames, **self.options)

    def to_dataset(self) -> xarray.Dataset:
        """Return all runs as an xarray dataset with units."""
        import xarray

        data = {
            "start": (("run", "coordinate"), self.starts, {"units": "m, m, rad"}),
            "final": (("run", "coordinate"), self.finals, {"units": "m, m, rad"}),
            "duration": (("run",), self.durations, {"units": "s"}),
            "outcome": (("run",), self.outcomes.astype(np.int32)),
            "worst_error": (("run",), self.worst_errors, {"units": "1", "of": "loads"}),
        }
        meanings = ", ".join(f"{int(outcome)}: {outcome}" for outcome in Outcome)
        attributes = {"part": self.part.name, "drive": repr(self.drive), "outcomes": meanings}
        return xarray.Dataset(data, {"coordinate": ["x", "y", "theta"]}, attributes)

    def __repr__(self) -> str:
        """Return how many ended how."""
        ends = ", ".join(f"{self.count(o)} {o}" for o in Outcome if self.count(o))
        return f"Runs({len(self)}: {ends})"


def simulate_many(
    part: Part,
    drive: Drive,
    poses: ArrayLike | int,
    duration: float | None = None,
    *,
    twist: ArrayLike = (0.0, 0.0, 0.0),
    seed: int = 0,
    start_offset: float | None = None,
    progress: bool = False,
    jobs: int = -1,
    save: str | Path | None = None,
    **options: Any,
) -> Runs:
    """Simulate a part from many starts, in threads.

    Parameters
    ----------
    part, drive, duration, twist, **options
        As `simulate` takes them, but frames and pose.
    poses : (n, 3) float or int
        Starts [m, m, rad]; or a number of random ones, with uniform orientations and centres
        uniform in a disk about the origin.
    seed : int
        Seed of random starts. Results do not depend on `jobs`.
    start_offset : float, optional
        Radius of their disk [m]; half of the part's circumradius.
    progress : bool
        Show a progress bar.
    jobs : int
        Threads, from 1 on; -1 takes all cores.
    save : path, optional
        NetCDF file for the runs. It is written every half minute, too, and when the user
        interrupts: then it holds the runs until there.

    Examples
    --------
    >>> from limitsurf.actuators.activation import squeeze_activation
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> drive = squeeze_activation(load_array("resonator64"), 0.0)
    >>> simulate_many(Part.from_file("paper_t"), drive, 20, tolerance=1e-4)
    Runs(20: 20 at rest)
    """
    engine = engine_of(part, drive, duration, frames=1, **options)
    starts, speed = read_starts(poses, part, seed, start_offset), as_array("twist", twist, 3)
    target, kept = as_target(save), {"duration": duration, "twist": speed, **options}
    threads = -1 if type(jobs) is int and jobs == -1 else as_count("jobs", jobs)
    motions = Parallel(n_jobs=threads, prefer="threads", return_as="generator")(
        delayed(_move)(engine, k, start, speed) for k, start in enumerate(starts)
    )
    shown = track(motions, "Simulating", total=len(starts)) if progress else motions
    ends: list[Trajectory] = []
    saved = time.monotonic()
    try:
        for trajectory in shown:
            ends.append(trajectory)
            if target is not None and time.monotonic() - saved > _SAVE_EVERY:
                write_netcdf(_runs(part, drive, kept, starts, ends).to_dataset(), target)
                saved = time.monotonic()
    finally:
        if target is not None and ends:
            write_netcdf(_runs(part, drive, kept, starts, ends).to_dataset(), target)
    return _runs(part, drive, kept, starts, ends)


def _move(engine: Engine, run: int, start: Array, twist: Array) -> Trajectory:
    """Return the motion of one run; errors say which."""
    try:
        return engine(start, twist)
    except InputError as error:
        if error.argument == "pose":
            what = f"{error.problem} in run {run}"
            raise InputError("poses", what, value=error.value, remedy=error.remedy) from error
        raise


def _runs(
    part: Part, drive: Drive, options: dict[str, Any], starts: Array, ends: list[Trajectory]
) -> Runs:
    """Return the runs that are done."""
    return Runs(
        part=part,
        drive=drive,
        options=options,
        starts=starts[: len(ends)],
        finals=np.array([end.final_pose for end in ends]),
        durations=np.array([end.duration for end in ends]),
        outcomes=np.array([end.outcome for end in ends], dtype=np.int64),
        worst_errors=np.array([end.worst_error for end in ends]),
    )
