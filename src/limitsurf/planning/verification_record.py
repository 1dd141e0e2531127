"""The record of executions of a plan from random starts: rate, interval, failures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.trajectory import Outcome
from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["Verification"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Verification:
    """Outcome of executions of a plan, on an array or in an ideal field.

    Attributes
    ----------
    plan : AlignmentPlan
        The plan.
    part : Part
        The part.
    seed : int
        Seed of the starts.
    tolerance : float
        Largest error of the final orientation that counts as success [rad].
    poses : (n, k + 1, 3) float
        Poses at the start and after each line [m, m, rad].
    outcomes : (n, k) int
        How each line ended, values of `Outcome`.
    """

    plan: AlignmentPlan
    part: Part
    seed: int
    tolerance: float
    poses: Array
    outcomes: NDArray[np.int64]

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

    def check_run(self, run: int) -> None:
        """Raise InputError for a run that there is not."""
        if not 0 <= run < self.samples:
            raise InputError("run", f"must lie in 0..{self.samples - 1}", value=run)

    def __repr__(self) -> str:
        """Return the success rate and its interval."""
        low, high = self.interval
        return (
            f"Verification({int(self.successes.sum())} of {self.samples} runs aligned, "
            f"95 % interval {100 * low:.1f} to {100 * high:.1f} %)"
        )
