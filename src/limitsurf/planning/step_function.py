"""What one step of a plan does to an orientation, under each model of its execution."""

from __future__ import annotations

from typing import Literal, get_args

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.basin_steps import (
    centred_squeeze_function,
    shift_squeeze_function,
    unknown_offset_function,
)
from limitsurf.planning.ideal_squeeze import as_mobility_ratio
from limitsurf.planning.squeeze_function import SqueezeFunction, squeeze_function
from limitsurf.planning.turn_function import turn_function

__all__ = ["Model", "step_function"]

Model = Literal["squeeze", "centred", "push-squeeze", "unknown-offset"]


def step_function(part: Part, model: Model, mobility_ratio: float) -> SqueezeFunction:
    """Return the step function of a model; see `plan_alignment`.

    Raises
    ------
    InputError
        An unknown model, or a mobility ratio that is neither 0 nor in [1e-6, 1e6].
    """
    ratio = as_mobility_ratio(mobility_ratio)
    if model == "squeeze":
        return squeeze_function(turn_function(part))
    if model == "centred":
        return centred_squeeze_function(part, ratio)
    if model == "push-squeeze":
        return shift_squeeze_function(part, ratio)
    if model == "unknown-offset":
        return unknown_offset_function(part, ratio)
    raise InputError(
        "model", "is unknown", value=model, remedy=f"use one of {', '.join(get_args(Model))}"
    )
