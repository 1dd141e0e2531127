"""A resonator as the plain records that the kernels read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scipy.constants import epsilon_0

from limitsurf.errors import InputError
from limitsurf.kernels.part_height import Tips
from limitsurf.kernels.resonator_balance import Drive, Grid
from limitsurf.kernels.rim_torque import RimSide
from limitsurf.kernels.tip_contact import ContactLaw
from limitsurf.sets.arguments import as_number

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["contact_law", "drive_record", "grid_record", "tips_record"]


def grid_record(resonator: TorsionalResonator) -> Grid:
    """Return stiffness, inertia, damping and the rim's sides."""
    right, left = resonator.levers
    length, gap = resonator.grid_length, resonator.clearance
    return Grid(
        resonator.stiffness,
        resonator.inertia,
        resonator.damping,
        RimSide(right, length, gap),
        RimSide(left, length, gap),
    )


def drive_record(resonator: TorsionalResonator, voltage: float) -> Drive:
    """Return the strength of the drive of either side."""
    if not 0.0 < as_number("voltage", voltage) < float("inf"):
        raise InputError("voltage", "must be positive and finite", value=voltage)
    strength = 0.5 * epsilon_0 * resonator.effective_width * float(voltage) ** 2
    return Drive(
        strength if resonator.driven in ("+x", "both") else 0.0,
        strength if resonator.driven in ("-x", "both") else 0.0,
        resonator.drive == "biased",
    )


def tips_record(resonator: TorsionalResonator) -> Tips:
    """Return levers and heights of the tips."""
    right, left = resonator.levers
    return Tips(right, -left, *resonator.tip_heights)


def contact_law(resonator: TorsionalResonator) -> ContactLaw:
    """Return the contact; its loss is the damping over the stiffness [s]."""
    stiffness = resonator.contact_stiffness
    return ContactLaw(stiffness, resonator.contact_damping / stiffness, resonator.restitution)
