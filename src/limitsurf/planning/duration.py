"""How long a plan takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from limitsurf.actuators.actuator_array import ActuatorArray

if TYPE_CHECKING:
    from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["expected_duration"]


def expected_duration(plan: AlignmentPlan, drive: ActuatorArray) -> float:
    """Return the expected time of a plan [s]."""
    raise NotImplementedError
