"""What the errors of a real array leave of a plan: interval propagation, line by line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Method
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.planning.field_errors import FieldErrors
from limitsurf.planning.moment_ratio import MomentRatio
from limitsurf.planning.propagation import Propagation, propagate
from limitsurf.planning.step_bounds import StepBounds, step_bounds
from limitsurf.planning.turn_function import turn_function
from limitsurf.sets.arguments import as_positive

if TYPE_CHECKING:
    from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["Robustness", "Status", "robustness"]

Array = NDArray[np.float64]
Status = Literal["guaranteed", "likely", "lost"]


@dataclass(frozen=True, eq=False)
class Robustness:
    """Outcome of an interval propagation through a plan.

    The intervals hold orientations in the array's frame after each line, of all parts but those
    that start within the first line's unstable bands; `at_risk` is the share of those that the rest
    of the plan may not align.

    Attributes
    ----------
    plan : AlignmentPlan
        The plan.
    errors : tuple of FieldErrors
        Errors of each line's field.
    worst, likely : Propagation
        With all errors at their worst, and with `sigmas` standard deviations of those that vary.
    sigmas : float
        See `likely`.
    """

    plan: AlignmentPlan
    errors: tuple[FieldErrors, ...]
    worst: Propagation
    likely: Propagation
    sigmas: float

    @property
    def steps(self) -> tuple[Status, ...]:
        """Status of each line, no better than that of the line before; see `robustness`."""
        worst, likely = (np.logical_and.accumulate(p.held) for p in (self.worst, self.likely))
        return tuple(
            "guaranteed" if sure else "likely" if often else "lost"
            for sure, often in zip(worst, likely, strict=True)
        )

    @property
    def status(self) -> Status:
        """Status of the plan, that of its last line."""
        return self.steps[-1]

    @property
    def least_margin(self) -> float:
        """Least error of a line's angle that is still tolerated on top of the others [rad]."""
        return float(self.worst.margins.min())

    @property
    def final_width(self) -> float:
        """Width of the interval of final orientations, modulo the plan's period [rad]."""
        return self.worst.final_width

    def table(self) -> list[dict[str, Any]]:
        """Return what each source does alone: records, one for each line and source.

        ``rest_deg`` and ``break_deg`` are the largest shifts of where a part rests and of where it
        may turn either way; ``lost`` counts stable orientations that are gone.
        """
        ratio = MomentRatio(turn_function(self.plan.part))
        rows = []
        for k, (line, errors) in enumerate(zip(self.plan.lines, self.errors, strict=True)):
            for name, alone in {**errors.sources, "all": errors}.items():
                bounds = step_bounds(self.plan.squeeze, ratio, alone.tangent, alone.worst)
                rest, shift = _shifts(self.plan, bounds)
                row = {"line": k + 1, "line_deg": float(np.degrees(line)), "source": name}
                lost = int(bounds.lost.sum())
                rows.append(row | {"rest_deg": rest, "break_deg": shift, "lost": lost})
        return rows

    def __repr__(self) -> str:
        """Return the status of every line; width, margin and risk are with errors at worst."""
        lines = ", ".join(
            f"{angle:.2f} {step}"
            for angle, step in zip(np.degrees(self.plan.lines), self.steps, strict=True)
        )
        width, margin = np.degrees(self.final_width), np.degrees(self.least_margin)
        left = f"margin {margin:.2f} deg" if np.isfinite(margin) else "any margin"
        risk = f"{100 * self.worst.at_risk:.2g} % of starts at risk"
        return f"Robustness({self.status}: {lines}; final width {width:.2f} deg, {left}, {risk})"


def _shifts(plan: AlignmentPlan, bounds: StepBounds) -> tuple[float, float]:
    """Return the largest shifts of rests and breaks in degrees, lost steps left out."""
    if bounds.lost.all():
        return float("nan"), float("nan")
    squeeze, kept = plan.squeeze, ~bounds.lost
    before = np.append(squeeze.ends[-1] - squeeze.modulus, squeeze.ends[:-1])
    breaks = bounds.bands - np.column_stack([before, squeeze.breaks])
    rests = bounds.rests - squeeze.images[:, None]
    return tuple(float(np.degrees(np.abs(x[kept]).max())) for x in (rests, breaks))  # type: ignore[return-value]


def robustness(
    plan: AlignmentPlan,
    array: ActuatorArray | FieldErrors | Sequence[FieldErrors],
    *,
    method: Method = "dither",
    dead: float = 0.0,
    sigmas: float = 1.0,
    samples: int = 32,
    start_offset: float | None = None,
) -> Robustness:
    r"""Return what the errors of an array leave of a plan.

    Each line's errors turn the plan's step function into a lower and an upper one (`step_bounds`):
    with the direction off by eps and the moment by w U, a part may rest in the cells of
    :math:`\{|U'/U - \tan\epsilon| \le w\}`. Intervals of orientations go through both. A line is
    *guaranteed* if, with all errors at their worst, what it leaves could still be aligned by the
    rest of the plan without errors; *likely* if so with `sigmas` standard deviations; else *lost*:
    not to be relied on, though some starts may succeed.

    Parameters
    ----------
    plan : AlignmentPlan
        The plan.
    array : ActuatorArray, FieldErrors or one FieldErrors for each line
        What drives the part: errors are measured by `FieldErrors.of`, or given.
    method, dead, samples, start_offset
        For the measurement; see `FieldErrors.of`.
    sigmas : float
        Standard deviations of pixel and spread errors that count as likely. One is enough: these
        errors change sign within a pitch, and a part stops only where no load is left in any
        direction; measured in ``docs/robustness.md``.

    Returns
    -------
    Robustness

    Raises
    ------
    InputError
        A plan for a neutral part; an array without room for the part or without push; errors for
        another number of lines.

    Notes
    -----
    The plan's model is taken at its word: with "squeeze" a part first moves onto the line and then
    turns. How far that is true is another question, that of `verify_alignment`. The worst of the
    pixel errors is the worst of the poses that were measured.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> part = Part.from_file("paper_t")
    >>> plan, array = plan_alignment(part), load_array("resonator64").running_under(part)
    >>> robustness(plan, array).steps
    ('likely', 'likely')
    >>> robustness(plan, array, method="nearest").steps
    ('likely', 'lost')
    """
    turn = turn_function(plan.part)
    if turn.neutral:
        raise InputError("plan", "is for a neutral part: squeezing does not turn it")
    as_positive("sigmas", sigmas)
    if isinstance(array, ActuatorArray):
        errors = tuple(
            FieldErrors.of(
                array,
                plan.part,
                float(line),
                method=method,
                dead=dead,
                samples=samples,
                start_offset=start_offset,
                turn=turn,
            )
            for line in plan.lines
        )
    else:
        errors = tuple(_given(array, len(plan.lines)))
    ratio = MomentRatio(turn)
    worst, likely = (
        propagate(
            plan,
            [
                step_bounds(plan.squeeze, ratio, e.tangent, width)
                for e, width in zip(errors, widths, strict=True)
            ],
        )
        for widths in ([e.worst for e in errors], [e.likely(sigmas) for e in errors])
    )
    return Robustness(plan, errors, worst, likely, sigmas)


def _given(errors: FieldErrors | Sequence[FieldErrors], lines: int) -> Iterator[FieldErrors]:
    """Yield errors that a user gave, one for each line."""
    each = [errors] * lines if isinstance(errors, FieldErrors) else list(errors)
    if len(each) != lines:
        raise InputError("array", f"holds errors of {len(each)} lines; the plan has {lines}")
    for one in each:
        if not isinstance(one, FieldErrors):
            raise InputError("array", "is no ActuatorArray and no FieldErrors", value=one)
        yield one
