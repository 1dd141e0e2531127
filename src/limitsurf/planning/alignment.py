"""Sensorless alignment plans of a part: sequences of lines that bring it to one orientation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from limitsurf.errors import NoPlan
from limitsurf.geometry.part import Part
from limitsurf.planning.line_plan import LinePlan
from limitsurf.planning.plan_json import read_plan, write_plan
from limitsurf.planning.plan_lines import plan_lines
from limitsurf.planning.step_function import Model, step_function
from limitsurf.planning.turn_function import turn_function

if TYPE_CHECKING:
    from limitsurf.actuators.actuator_array import ActuatorArray
    from limitsurf.planning.field_errors import FieldErrors
    from limitsurf.planning.robustness import Robustness

__all__ = ["AlignmentPlan", "plan_alignment"]


@dataclass(frozen=True, eq=False, repr=False)
class AlignmentPlan(LinePlan):
    """Lines to squeeze a part towards, one after the other, whatever its first orientation.

    Attributes
    ----------
    lines, margins, final, period, squeeze
        See `LinePlan`.
    part : Part
        The part.
    model : str
        How the steps are executed; see `plan_alignment`.
    mobility_ratio : float
        Ratio of mobilities of rotation and translation that the model assumes; see `IdealSqueeze`.
    """

    part: Part
    model: Model = "squeeze"
    mobility_ratio: float = 1.0

    def robustness(
        self, array: ActuatorArray | FieldErrors | Sequence[FieldErrors], **options: Any
    ) -> Robustness:
        """Return what the errors of a real array leave of the plan; see `Robustness`."""
        from limitsurf.planning.robustness import robustness

        return robustness(self, array, **options)

    def expected_duration(self, drive: ActuatorArray, **options: Any) -> float:
        """Return the expected time of the whole plan on a drive [s]."""
        from limitsurf.planning.duration import expected_duration

        return expected_duration(self, drive, **options)

    def to_json(self) -> str:
        """Return the plan as JSON text; angles in radians, the outline in metres."""
        return write_plan(self)

    @classmethod
    def from_json(cls, text: str | Path) -> AlignmentPlan:
        """Read a plan from JSON text or from a file; a ModelError names the field that is wrong."""
        return cls(*read_plan(text))


def plan_alignment(
    part: Part,
    *,
    model: Model = "squeeze",
    lines: ArrayLike | int | None = None,
    min_margin: float = 0.0,
    mobility_ratio: float = 1.0,
    goal: float | None = None,
) -> AlignmentPlan:
    """Return the shortest plan of squeezes that aligns a part, with the largest margin.

    Parameters
    ----------
    part : Part
        The part.
    model : {"squeeze", "centred", "push-squeeze", "unknown-offset"}
        How the steps are executed: the part first moves onto the line and then turns ("squeeze",
        the paper's 2PHASE); it does both at once, starting with its centroid on the line
        ("centred"), wholly to the left of the directed line ("push-squeeze"), or anywhere
        ("unknown-offset").
    lines : (L,) float or int, optional
        World angles that may be used [rad], or their number if they are evenly spaced; any
        angles if not given.
    min_margin : float
        Least error of a line's angle [rad] that every step has to tolerate; a longer plan is
        accepted for it.
    mobility_ratio : float
        For the models of motion at once; see `IdealSqueeze`.
    goal : float, optional
        Orientation at the end [rad], modulo the plan's period; to 1e-6 rad if `lines` are given.

    Returns
    -------
    AlignmentPlan
        As few lines as possible, and among these plans one with the largest least margin.

    Raises
    ------
    NoPlan
        The part is neutral, or no plan meets the request; the error says why and what is
        reachable.
    InputError
        An unknown model; a margin below 0; lines that are repeated or none; no finite goal.

    References
    ----------
    K. Goldberg, Orienting polygonal parts without sensors, Algorithmica 10, 1993.

    Examples
    --------
    >>> part = Part([(0, 0), (2, 0), (2.1, 2), (0, 2.2)])
    >>> plan_alignment(part)
    AlignmentPlan(lines at 0.00, 44.27 deg, margin 6.05 deg)
    >>> plan_alignment(part, lines=8)
    AlignmentPlan(lines at 135.00, 0.00 deg, margin 5.31 deg)
    >>> plan_alignment(part, goal=0.5).predict([1.0, 2.0])
    array([0.5, 0.5])
    """
    squeeze = step_function(part, model, mobility_ratio)
    if squeeze.steps == 0:
        raise _neutral(part)
    try:
        plan = plan_lines(squeeze, lines=lines, min_margin=min_margin, goal=goal)
    except NoPlan as failure:
        if failure.plan is not None:
            failure.plan = _of_part(failure.plan, part, model, mobility_ratio)
        raise
    return _of_part(plan, part, model, mobility_ratio)


def _of_part(plan: LinePlan, part: Part, model: Model, mobility_ratio: float) -> AlignmentPlan:
    return AlignmentPlan(
        plan.lines,
        plan.margins,
        plan.final,
        plan.period,
        plan.squeeze,
        part,
        model,
        float(mobility_ratio),
    )


def _neutral(part: Part) -> NoPlan:
    angle = np.degrees(turn_function(part).critical_angle)
    return NoPlan(
        "part: cannot be aligned: squeezing does not turn it (neutral). Its moment is nowhere more "
        f"than {np.radians(angle):.1e} of its potential, so pushes that are off by {angle:.1e} deg "
        "outweigh it at every orientation. Disks are like this, and so are Zindler curves, which "
        "are no disks: what counts is the symmetry of the squeeze function, not of the part; "
        "change the outline so that it is longer in one direction",
        0.0,
    )
