"""What one step of a plan does to an orientation, under each model of its execution."""

from __future__ import annotations

from typing import Literal

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.squeeze_function import SqueezeFunction, squeeze_function
from limitsurf.planning.turn_function import turn_function

__all__ = ["Model", "step_function"]

Model = Literal["squeeze", "centred", "push-squeeze", "unknown-offset"]


def step_function(part: Part, model: Model, mobility_ratio: float) -> SqueezeFunction:
    """Return the step function of a model; see `plan_alignment`."""
    if model == "squeeze":
        return squeeze_function(turn_function(part))
    raise InputError("model", "is none of the models", value=model)
