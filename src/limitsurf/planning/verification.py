"""Verify an alignment plan by simulating the part on the discrete array, contact by contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from rich.progress import track
from scipy.stats import binomtest

from limitsurf.actuators.activation import Activation, Method, squeeze_activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.options import Mode
from limitsurf.motion.simulate import simulate
from limitsurf.motion.starts import check_room, random_starts
from limitsurf.motion.time_scales import check_lift
from limitsurf.motion.trajectory import Outcome, Trajectory
from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.sets.arguments import as_count, as_positive

if TYPE_CHECKING:
    import xarray

__all__ = ["Verification", "verify_alignment"]

Array = NDArray[np.float64]

DEFAULT_TOLERANCE = float(np.radians(6.0))


@dataclass(frozen=True, eq=False)
class Verification:
    """Outcome of simulated executions of a plan.

    Attributes
    ----------
    plan : AlignmentPlan
        The plan.
    part : Part
        The part.
    activations : tuple of Activation
        One for each line.
    seed : int
        Seed of the starts.
    mode : {"inertial", "quasi-static"}
        How the part moved.
    tolerance : float
        Largest error of the final orientation that counts as success [rad].
    poses : (n, k + 1, 3) float
        Poses at the start and after each line [m, m, rad].
    durations : (n, k) float
        Time on each line [s].
    outcomes : (n, k) int
        How each line ended, values of `Outcome`.
    worst_errors : (n,) float
        Largest certified error of the frictional load in each run, over the part's weight.
    """

    plan: AlignmentPlan
    part: Part
    activations: tuple[Activation, ...]
    seed: int
    mode: Mode
    tolerance: float
    poses: Array
    durations: Array
    outcomes: NDArray[np.int64]
    worst_errors: Array

    @property
    def samples(self) -> int:
        """Number of runs."""
        return len(self.poses)

    @property
    def errors(self) -> Array:
        """Final orientation minus the plan's, modulo its period, in [-period/2, period/2)."""
        period = self.plan.period
        return np.mod(self.poses[:, -1, 2] - self.plan.final + period / 2, period) - period / 2

    @property
    def successes(self) -> NDArray[np.bool_]:
        """Whether each run ended at rest, on every line, within the tolerance."""
        at_rest = (self.outcomes == Outcome.REST).all(axis=1)
        return np.asarray(at_rest & (np.abs(self.errors) <= self.tolerance))

    @property
    def failures(self) -> NDArray[np.int64]:
        """Numbers of the runs that failed; `replay` shows them."""
        return np.flatnonzero(~self.successes)

    @property
    def rate(self) -> float:
        """Share of successful runs."""
        return float(self.successes.mean())

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson 95 % confidence interval of the rate."""
        result = binomtest(int(self.successes.sum()), self.samples)
        low, high = result.proportion_ci(confidence_level=0.95, method="wilson")
        return float(low), float(high)

    def replay(self, run: int, *, frames: int = 60) -> list[Trajectory]:
        """Simulate one run again and return its trajectory on each line."""
        if not 0 <= run < self.samples:
            raise InputError("run", f"must lie in 0..{self.samples - 1}", value=run)
        return _execute(self.part, self.activations, self.poses[run, 0], self.mode, frames)

    def to_dataset(self) -> xarray.Dataset:
        """Return all runs as an xarray dataset with units."""
        import xarray

        data = {
            "pose": (("run", "stage", "coordinate"), self.poses, {"units": "m, m, rad"}),
            "duration": (("run", "line"), self.durations, {"units": "s"}),
            "outcome": (("run", "line"), self.outcomes.astype(np.int32)),
            "orientation_error": (("run",), self.errors, {"units": "rad"}),
            "success": (("run",), self.successes.astype(np.int8)),
            "worst_error": (("run",), self.worst_errors, {"units": "1", "of": "weight"}),
        }
        coordinates = {
            "line": ("line", self.plan.lines, {"units": "rad"}),
            "coordinate": ["x", "y", "theta"],
        }
        meanings = ", ".join(f"{int(outcome)}: {outcome}" for outcome in Outcome)
        attributes = {
            "title": "limitsurf alignment runs",
            "part": self.part.name,
            "array": self.activations[0].array.name,
            "voltage_V": self.activations[0].array.voltage,
            "seed": self.seed,
            "motion": self.mode,  # not "mode": SciPy keeps attributes beside its file mode
            "tolerance_rad": self.tolerance,
            "final_rad": self.plan.final,
            "period_rad": self.plan.period,
            "outcomes": meanings,
        }
        return xarray.Dataset(data, coords=coordinates, attrs=attributes)

    def __repr__(self) -> str:
        """Return the success rate and its interval."""
        low, high = self.interval
        return (
            f"Verification({int(self.successes.sum())} of {self.samples} runs aligned, "
            f"95 % interval {100 * low:.1f} to {100 * high:.1f} %)"
        )


def verify_alignment(
    plan: AlignmentPlan,
    part: Part,
    drive: ActuatorArray,
    samples: int = 200,
    seed: int = 0,
    *,
    mode: Mode = "inertial",
    method: Method = "dither",
    tolerance: float = DEFAULT_TOLERANCE,
    start_offset: float | None = None,
    progress: bool = False,
    jobs: int = -1,
) -> Verification:
    """Execute a plan on the discrete array from random starts and count successes.

    Starts are uniform: orientations in [0, 2 pi), centres of mass in a disk about the array's
    centre. A run succeeds if the part comes to rest on every line and ends within `tolerance`
    of the plan's final orientation, modulo the plan's period.

    Parameters
    ----------
    plan : AlignmentPlan
        The plan.
    part : Part
        The part, with areal density.
    drive : ActuatorArray
        The array; its voltage has to lift the part.
    samples, seed : int
        Number of runs and seed of their starts. Results do not depend on `jobs`.
    mode : {"inertial", "quasi-static"}
        See `simulate`.
    method : {"dither", "nearest"}
        See `squeeze_activation`.
    tolerance : float
        Largest error that counts as success [rad]; 6 degrees.
    start_offset : float, optional
        Radius of the disk of starts [m]; half of the part's circumradius.
    progress : bool
        Show a progress bar.
    jobs : int
        Threads; -1 takes all cores.

    Raises
    ------
    InputError
        No samples, or an array too small for the part and its start offsets.
    PartTooHeavy
        The array cannot lift the part at its voltage.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> part = Part.from_file("paper_t")
    >>> verify_alignment(plan_alignment(part), part, load_array("resonator64"), samples=10)
    Verification(10 of 10 runs aligned, 95 % interval 72.2 to 100.0 %)
    """
    as_count("samples", samples)
    as_count("seed", seed, 0)
    as_positive("tolerance", tolerance)
    check_lift(part, drive)
    offset = 0.5 * part.circumradius if start_offset is None else start_offset
    check_room(part, drive, offset)
    activations = tuple(squeeze_activation(drive, line, method=method) for line in plan.lines)
    starts = random_starts(samples, seed, offset)
    runs = Parallel(n_jobs=jobs, prefer="threads", return_as="generator")(
        delayed(_execute)(part, activations, start, mode, 1) for start in starts
    )
    if progress:
        runs = track(runs, description="Simulating", total=samples)
    records = [_summary(run, len(activations)) for run in runs]
    return Verification(
        plan=plan,
        part=part,
        activations=activations,
        seed=seed,
        mode=mode,
        tolerance=tolerance,
        poses=np.concatenate([starts[:, None], np.array([r[0] for r in records])], axis=1),
        durations=np.array([r[1] for r in records]),
        outcomes=np.array([r[2] for r in records], dtype=np.int64),
        worst_errors=np.array([r[3] for r in records]),
    )


def _execute(
    part: Part, activations: tuple[Activation, ...], start: Array, mode: Mode, frames: int
) -> list[Trajectory]:
    """Squeeze towards each line in turn, from where the line before left the part, at rest.

    A part that left the array stays there: its run ends early.
    """
    run: list[Trajectory] = []
    for activation in activations:
        pose = run[-1].final_pose if run else start
        run.append(simulate(part, activation, pose, mode=mode, frames=frames))
        if run[-1].outcome is Outcome.LEFT_ARRAY:
            break
    return run


def _summary(run: list[Trajectory], lines: int) -> tuple[Array, Array, list[int], float]:
    """Return the pose, duration and outcome after each line, and the worst error bound."""
    stages = run + run[-1:] * (lines - len(run))
    durations = [trajectory.duration for trajectory in run] + [0.0] * (lines - len(run))
    return (
        np.array([trajectory.final_pose for trajectory in stages]),
        np.array(durations),
        [int(trajectory.outcome) for trajectory in stages],
        max(trajectory.worst_error for trajectory in run),
    )
