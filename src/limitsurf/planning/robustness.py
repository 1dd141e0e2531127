"""What the errors of a real array leave of a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from limitsurf.actuators.actuator_array import ActuatorArray

if TYPE_CHECKING:
    from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["Robustness", "robustness"]


@dataclass(frozen=True, eq=False)
class Robustness:
    """Outcome of an interval propagation through a plan."""


def robustness(plan: AlignmentPlan, array: ActuatorArray) -> Robustness:
    """Return what the errors of an array leave of a plan."""
    raise NotImplementedError
