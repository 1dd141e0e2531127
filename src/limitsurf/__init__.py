"""Optimization-based contact mechanics: limit surfaces, frictional loads, sensorless alignment.

Imported as ``ls`` in the documentation. Names are loaded on first use, so that importing the
package is quick.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from limitsurf.actuators.activation import Activation as Activation
    from limitsurf.actuators.activation import squeeze_activation as squeeze_activation
    from limitsurf.actuators.actuator_array import ActuatorArray as ActuatorArray
    from limitsurf.actuators.actuator_array import load_array as load_array
    from limitsurf.geometry.part import Part as Part
    from limitsurf.motion.simulate import simulate as simulate
    from limitsurf.motion.trajectory import Trajectory as Trajectory
    from limitsurf.planning.alignment import AlignmentPlan as AlignmentPlan
    from limitsurf.planning.alignment import plan_alignment as plan_alignment
    from limitsurf.planning.squeeze_function import SqueezeFunction as SqueezeFunction
    from limitsurf.planning.squeeze_function import squeeze_function as squeeze_function
    from limitsurf.planning.turn_function import TurnFunction as TurnFunction
    from limitsurf.planning.turn_function import turn_function as turn_function
    from limitsurf.planning.verification import Verification as Verification
    from limitsurf.planning.verification import verify_alignment as verify_alignment

__version__ = "0.1.0"

_HOME = {
    "Activation": "actuators.activation",
    "ActuatorArray": "actuators.actuator_array",
    "AlignmentPlan": "planning.alignment",
    "Part": "geometry.part",
    "SqueezeFunction": "planning.squeeze_function",
    "Trajectory": "motion.trajectory",
    "TurnFunction": "planning.turn_function",
    "Verification": "planning.verification",
    "load_array": "actuators.actuator_array",
    "plan_alignment": "planning.alignment",
    "simulate": "motion.simulate",
    "squeeze_activation": "actuators.activation",
    "squeeze_function": "planning.squeeze_function",
    "turn_function": "planning.turn_function",
    "verify_alignment": "planning.verification",
}
_MODULES = ("errors", "plot", "units")

__all__ = [*_HOME, *_MODULES]


def __getattr__(name: str) -> Any:
    """Import a public name from the module that defines it (PEP 562)."""
    if name in _HOME:
        return getattr(import_module(f"limitsurf.{_HOME[name]}"), name)
    if name in _MODULES:
        return import_module(f"limitsurf.{name}")
    raise AttributeError(f"module 'limitsurf' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted([*__all__, "__version__"])
