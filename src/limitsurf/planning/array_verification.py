"""Execute a plan on a discrete array, contact by contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from rich.progress import track

from limitsurf.actuators.activation import Activation, Method, squeeze_activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.actuators.force_fields import elliptic_field, squeeze_field
from limitsurf.actuators.realised_field import activate
from limitsurf.geometry.part import Part
from limitsurf.motion.in_turn import joined
from limitsurf.motion.options import Mode
from limitsurf.motion.simulate import simulate
from limitsurf.motion.starts import check_room, random_starts
from limitsurf.motion.time_scales import check_lift
from limitsurf.motion.trajectory import Outcome, Trajectory
from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.planning.verification_record import Verification

if TYPE_CHECKING:
    import xarray

__all__ = ["ArrayVerification", "verify_on_array"]

Array = NDArray[np.float64]

_BESIDE = 1.1  # of the circumradius: from the centre to a line that passes a centred part


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ArrayVerification(Verification):
    """Outcome of simulated executions on an array.

    Attributes
    ----------
    stages : tuple of tuple of Activation
        For each line what runs one after the other, the squeeze last.
    mode : {"inertial", "quasi-static"}
        How the part moved.
    durations : (n, k) float
        Time on each line [s].
    worst_errors : (n,) float
        Largest certified error of the frictional load in each run, over the part's weight.
    """

    stages: tuple[tuple[Activation, ...], ...]
    mode: Mode
    durations: Array
    worst_errors: Array

    @property
    def activations(self) -> tuple[Activation, ...]:
        """The squeeze of each line."""
        return tuple(stages[-1] for stages in self.stages)

    @property
    def beside(self) -> float:
        """How far to the right of the array's centre the lines pass [m]; not 0 for push-squeeze."""
        return _BESIDE * self.part.circumradius if self.plan.model == "push-squeeze" else 0.0

    def replay(self, run: int, *, frames: int = 60) -> list[Trajectory]:
        """Simulate one run again and return its trajectory on each line."""
        self.check_run(run)
        return _execute(self.part, self.stages, self.poses[run, 0], self.mode, frames)

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


def verify_on_array(
    plan: AlignmentPlan,
    part: Part,
    array: ActuatorArray,
    samples: int,
    seed: int,
    *,
    mode: Mode,
    method: Method,
    tolerance: float,
    start_offset: float | None,
    progress: bool,
    jobs: int,
) -> ArrayVerification:
    """Do what `verify_alignment` does on an array."""
    check_lift(part, array)
    offset = 0.5 * part.circumradius if start_offset is None else start_offset
    check_room(part, array, offset)
    stages = tuple(_stages(plan, part, array, offset, line, method) for line in plan.lines)
    starts = random_starts(samples, seed, offset)
    runs = Parallel(n_jobs=jobs, prefer="threads", return_as="generator")(
        delayed(_execute)(part, stages, start, mode, 1) for start in starts
    )
    if progress:
        runs = track(runs, description="Simulating", total=samples)
    records = [_summary(run, len(stages)) for run in runs]
    return ArrayVerification(
        plan=plan,
        part=part,
        stages=stages,
        seed=seed,
        mode=mode,
        tolerance=tolerance,
        poses=np.concatenate([starts[:, None], np.array([r[0] for r in records])], axis=1),
        durations=np.array([r[1] for r in records]),
        outcomes=np.array([r[2] for r in records], dtype=np.int64),
        worst_errors=np.array([r[3] for r in records]),
    )


def _stages(
    plan: AlignmentPlan,
    part: Part,
    array: ActuatorArray,
    offset: float,
    line: float,
    method: Method,
) -> tuple[Activation, ...]:
    """Return what runs for one line: where the offset counts, a linear radial field comes first.

    To come from the left of the line, the part squeezes towards one that passes by on its right.
    """
    if plan.model in ("squeeze", "unknown-offset"):
        return (squeeze_activation(array, line, method=method),)
    reach = part.circumradius + offset
    centring = activate(array, elliptic_field((1.0, 1.0), reach), method)
    if plan.model == "centred":
        return centring, squeeze_activation(array, line, method=method)
    beside = _BESIDE * part.circumradius
    check_room(part, array, beside)
    squeeze = activate(array, squeeze_field(line, -beside), method)
    return centring, Activation(array, squeeze.active, line)


def _execute(
    part: Part, lines: tuple[tuple[Activation, ...], ...], start: Array, mode: Mode, frames: int
) -> list[Trajectory]:
    """Squeeze towards each line in turn, from where the line before left the part, at rest.

    A part that left the array stays there: its run ends early.
    """
    run: list[Trajectory] = []
    for stages in lines:
        pose = run[-1].final_pose if run else start
        motions: list[tuple[float, Trajectory]] = []
        for activation in stages:
            begin = sum(motion.duration for _, motion in motions)
            motions.append((begin, simulate(part, activation, pose, mode=mode, frames=frames)))
            pose = motions[-1][1].final_pose
            if motions[-1][1].outcome is Outcome.LEFT_ARRAY:
                break
        run.append(joined(motions) if len(motions) > 1 else motions[0][1])
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
