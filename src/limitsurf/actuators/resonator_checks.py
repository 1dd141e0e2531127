"""What the numbers of a resonator must satisfy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_number

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["check_resonator"]

_POSITIVE = (
    "grid_width",
    "grid_length",
    "beam_width",
    "beam_height",
    "beam_pitch",
    "rod_length",
    "clearance",
    "effective_width",
    "cell_area",
    "density",
    "shear_modulus_tall",
    "shear_modulus_flat",
    "quality",
    "contact_stiffness",
)
_NOT_NEGATIVE = ("pole_height", "pole_section", "contact_damping", "restitution")
_CHOICES = {
    "poles": ("+x", "-x", "both", "none"),
    "driven": ("+x", "-x", "both"),
    "drive": ("sine", "biased"),
}


def check_resonator(resonator: TorsionalResonator) -> None:
    """Raise InputError naming the first field that no resonator can have."""
    for name in (*_POSITIVE, *_NOT_NEGATIVE):
        value = as_number(name, getattr(resonator, name))
        if name in _POSITIVE and not (np.isfinite(value) and value > 0.0):
            raise InputError(name, "must be positive and finite", value=value)
        if name in _NOT_NEGATIVE and not (np.isfinite(value) and value >= 0.0):
            raise InputError(name, "must be finite and not negative", value=value)
    for name, choices in _CHOICES.items():
        value = getattr(resonator, name)
        if value not in choices:
            remedy = f"use one of {', '.join(choices)}"
            raise InputError(name, "is unknown", value=value, remedy=remedy)
    _check_shape(resonator)
    _check_loss(resonator)


def _check_shape(resonator: TorsionalResonator) -> None:
    offset, half = as_number("rod_offset", resonator.rod_offset), 0.5 * resonator.grid_width
    if not abs(offset) < half:
        remedy = f"keep it below half the grid width, {half:g} m"
        raise InputError("rod_offset", "puts the rods off the grid", value=offset, remedy=remedy)
    pitch, width = resonator.beam_pitch, resonator.beam_width
    if pitch < width:
        remedy = f"the beams are {width:g} m wide"
        raise InputError("beam_pitch", "is less than a beam", value=pitch, remedy=remedy)


def _check_loss(resonator: TorsionalResonator) -> None:
    e = resonator.restitution
    if e > 1.0:
        raise InputError("restitution", "must be at most 1", value=e, remedy="1 is no loss")
    if e < 1.0 and resonator.contact_damping > 0.0:
        remedy = "set contact_damping to 0 or restitution to 1"
        raise InputError("restitution", "would count the loss twice", value=e, remedy=remedy)
