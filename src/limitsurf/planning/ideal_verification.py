"""Execute a plan in the ideal squeeze field, under the model it was made for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.squeeze_flow import MOVING
from limitsurf.motion.trajectory import Outcome
from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.planning.ideal_squeeze import STEP_ERROR, IdealSqueeze, SqueezePath
from limitsurf.planning.verification_record import Verification
from limitsurf.sets.arguments import as_number

__all__ = ["IdealVerification", "verify_in_ideal_field"]

Array = NDArray[np.float64]

_SHARE = 1e-3  # of the least margin: errors of steps must not carry a part over a border
_LEAST_STEP_ERROR = 1e-13


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class IdealVerification(Verification):
    """Outcome of executions in an ideal squeeze field; lines pass through the origin.

    Attributes
    ----------
    drive : IdealSqueeze
        The field.
    offsets : (n, k) float
        Offset of each line from the centroid before the part moves [m].
    """

    drive: IdealSqueeze
    offsets: Array

    def replay(self, run: int) -> list[SqueezePath]:
        """Return the path of one run on each line; orientations relative to the line."""
        self.check_run(run)
        before = self.poses[run, :-1, 2] - self.plan.lines
        return [
            self.drive.path(self.part, float(z), float(phi))
            for z, phi in zip(self.offsets[run], before, strict=True)
        ]


def verify_in_ideal_field(
    plan: AlignmentPlan,
    part: Part,
    drive: IdealSqueeze,
    samples: int,
    seed: int,
    tolerance: float,
    start_offset: float | None,
) -> IdealVerification:
    """Do what `verify_alignment` does in an ideal field."""
    rng = np.random.default_rng(seed)
    turns, places = rng.random(samples), rng.random((samples, len(plan.lines)))
    angle = 2 * np.pi * turns
    step_error = min(STEP_ERROR, max(_SHARE * plan.least_margin, _LEAST_STEP_ERROR))
    poses: list[Array] = []
    offsets: list[Array] = []
    outcomes: list[NDArray[np.int64]] = []
    for line, place in zip(plan.lines, places.T, strict=True):
        z = _start_offsets(plan, part, angle - line, place, start_offset)
        if not poses:
            poses.append(_poses(z, angle, line))
        rest, turned, status = drive.settle(part, z, angle - line, step_error)
        angle = turned + line
        offsets.append(z)
        poses.append(_poses(rest, angle, line))
        outcomes.append(np.where(status == MOVING, Outcome.TIME_LIMIT, Outcome.REST))
    return IdealVerification(
        plan=plan,
        part=part,
        seed=seed,
        tolerance=tolerance,
        poses=np.stack(poses, axis=1),
        outcomes=np.stack(outcomes, axis=1).astype(np.int64),
        drive=drive,
        offsets=np.stack(offsets, axis=1),
    )


def _start_offsets(
    plan: AlignmentPlan, part: Part, phi: Array, place: Array, start_offset: float | None
) -> Array:
    """Return the offset of the line from the centroid before each run; `place` in [0, 1)."""
    if plan.model in ("centred", "push-squeeze"):
        if start_offset is not None:
            raise InputError("start_offset", f"is known to the model {plan.model!r}")
        clear = 0.0 if plan.model == "centred" else -part.circumradius * (1.0 + place)
        return np.broadcast_to(clear, phi.shape)
    if start_offset is not None:
        reach = as_number("start_offset", start_offset)
        if not (np.isfinite(reach) and reach >= 0.0):
            raise InputError("start_offset", "must be at least 0 m", value=start_offset)
        return reach * (2 * place - 1)
    x, y = part.edges[:, 0], part.edges[:, 1]
    across = np.outer(np.sin(phi), x) + np.outer(np.cos(phi), y)  # n.x with theta = -phi
    low, high = across.min(axis=1), across.max(axis=1)
    return np.asarray(low + (high - low) * place)


def _poses(offset: Array, angle: Array, line: float) -> Array:
    """Return poses (n, 3) at an offset from a line through the origin."""
    return np.column_stack([offset * np.sin(line), -offset * np.cos(line), angle])
