"""Verify an alignment plan by executing it from random starts."""

from __future__ import annotations

from typing import overload

import numpy as np

from limitsurf.actuators.activation import Method
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.options import Mode
from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.planning.array_verification import ArrayVerification, verify_on_array
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.ideal_verification import IdealVerification, verify_in_ideal_field
from limitsurf.planning.verification_record import Verification
from limitsurf.sets.arguments import as_count, as_instance, as_positive

__all__ = ["Verification", "verify_alignment"]

_ARRAY_TOLERANCE = float(np.radians(6.0))
_IDEAL_TOLERANCE = 1e-4


@overload
def verify_alignment(
    plan: AlignmentPlan,
    part: Part,
    drive: ActuatorArray,
    samples: int = ...,
    seed: int = ...,
    *,
    mode: Mode = ...,
    method: Method = ...,
    tolerance: float | None = ...,
    start_offset: float | None = ...,
    progress: bool = ...,
    jobs: int = ...,
) -> ArrayVerification: ...


@overload
def verify_alignment(
    plan: AlignmentPlan,
    part: Part,
    drive: IdealSqueeze,
    samples: int = ...,
    seed: int = ...,
    *,
    tolerance: float | None = ...,
    start_offset: float | None = ...,
) -> IdealVerification: ...


def verify_alignment(
    plan: AlignmentPlan,
    part: Part,
    drive: ActuatorArray | IdealSqueeze,
    samples: int = 200,
    seed: int = 0,
    *,
    mode: Mode = "inertial",
    method: Method = "dither",
    tolerance: float | None = None,
    start_offset: float | None = None,
    progress: bool = False,
    jobs: int = -1,
) -> Verification:
    """Execute a plan from random starts and count successes.

    Orientations at the start are uniform in [0, 2 pi). On an array, centres of mass are uniform in
    a disk about its centre. In an ideal field the offset from each line is what the plan's model
    says: uniform over all offsets at which the line meets the part, drawn anew for every line;
    zero for ``"centred"``; the whole part on the left for ``"push-squeeze"``. On an array, both of
    these begin each line with a linear radial field that centres the part, and a push-squeeze
    goes towards a line that passes by it. A run succeeds if the part comes to rest on every line
    and ends within `tolerance` of the plan's final orientation, modulo the plan's period.

    Parameters
    ----------
    plan : AlignmentPlan
        The plan.
    part : Part
        The part, with areal density.
    drive : ActuatorArray or IdealSqueeze
        An array, whose voltage has to lift the part, or the ideal field.
    samples, seed : int
        Number of runs and seed of their starts. Results do not depend on `jobs`.
    mode : {"inertial", "quasi-static"}
        See `simulate`; arrays only.
    method : {"dither", "nearest"}
        See `squeeze_activation`; arrays only.
    tolerance : float, optional
        Largest error that counts as success [rad]; 6 degrees on an array, 1e-4 in an ideal field.
    start_offset : float, optional
        Radius of the disk of starts [m]; half of the part's circumradius. In an ideal field the
        largest offset; then it need not meet the part.
    progress : bool
        Show a progress bar; arrays only.
    jobs : int
        Threads; -1 takes all cores; arrays only.

    Returns
    -------
    ArrayVerification or IdealVerification

    Raises
    ------
    InputError
        No samples; an array too small for the part and its start offsets; a plan whose model the
        drive cannot execute.
    PartTooHeavy
        The array cannot lift the part at its voltage.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> part = Part.from_file("paper_t")
    >>> verify_alignment(plan_alignment(part), part, load_array("resonator64"), samples=10)
    Verification(10 of 10 runs aligned, 95 % interval 72.2 to 100.0 %)
    >>> verify_alignment(plan_alignment(part), part, IdealSqueeze(0.0), samples=100)
    Verification(100 of 100 runs aligned, 95 % interval 96.3 to 100.0 %)
    """
    as_instance("plan", plan, AlignmentPlan, remedy="make one with plan_alignment")
    as_instance("part", part, Part)
    as_count("samples", samples)
    as_count("seed", seed, 0)
    if tolerance is not None:
        as_positive("tolerance", tolerance)
    if isinstance(drive, IdealSqueeze):
        accepted = _IDEAL_TOLERANCE if tolerance is None else tolerance
        return verify_in_ideal_field(plan, part, drive, samples, seed, accepted, start_offset)
    if not isinstance(drive, ActuatorArray):
        raise InputError("drive", "must be an ActuatorArray or an IdealSqueeze", value=drive)
    return verify_on_array(
        plan,
        part,
        drive,
        samples,
        seed,
        mode=mode,
        method=method,
        tolerance=_ARRAY_TOLERANCE if tolerance is None else tolerance,
        start_offset=start_offset,
        progress=progress,
        jobs=jobs,
    )
