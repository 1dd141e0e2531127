r"""Sensorless alignment plans: sequences of lines that bring a part to one orientation.

Goldberg's planner (Algorithmica 10, 1993), backwards: the widest step of the squeeze function is
the last arc; the arc before it is the widest run of whole steps whose images span less than that
arc; and so on until an arc is a whole period. The length is the least possible. Among the plans
of that length the one with the largest margin is returned: every arc must exceed the span of
the images it receives by twice the margin, and the greedy choice stays optimal under such a
requirement, so raising it until the plan grows finds the best.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError, ModelError, NoPlan
from limitsurf.geometry.part import Part
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.planning.step_function import Model, step_function
from limitsurf.tolerances import LINE_MARGIN

if TYPE_CHECKING:
    from limitsurf.actuators.actuator_array import ActuatorArray
    from limitsurf.planning.field_errors import FieldErrors
    from limitsurf.planning.robustness import Robustness

__all__ = ["AlignmentPlan", "plan_alignment"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AlignmentPlan:
    """Lines to squeeze a part towards, one after the other, whatever its first orientation.

    Attributes
    ----------
    lines : (k,) float
        World angles of the lines, in [0, pi) [rad].
    margins : (k,) float
        Error of the line's angle, relative to the orientations before it, that each step
        tolerates [rad]; the first step tolerates any (infinity).
    final : float
        Orientation at the end, in [0, period) [rad].
    period : float
        The end orientation is known modulo this [rad].
    squeeze : SqueezeFunction
        What each step does to an orientation.
    part : Part
        The part.
    model : str
        How the steps are executed; see `plan_alignment`.
    mobility_ratio : float
        Ratio of mobilities of rotation and translation that the model assumes; see `IdealSqueeze`.
    """

    lines: Array
    margins: Array
    final: float
    period: float
    squeeze: SqueezeFunction
    part: Part
    model: Model = "squeeze"
    mobility_ratio: float = 1.0

    def predict(self, phi: ArrayLike) -> Array:
        """Return the orientation, reduced, where the plan leaves a part that starts at phi."""
        orientation = np.asarray(phi, dtype=np.float64)
        for line in self.lines:
            orientation = self.squeeze(orientation - line) + line
        return np.mod(orientation, self.squeeze.modulus)

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
        """Return the plan as JSON text; angles in radians."""
        record = {
            "format": "limitsurf alignment plan 2",
            "unit": "rad",
            "lines": self.lines.tolist(),
            "margins": [m if np.isfinite(m) else None for m in self.margins.tolist()],
            "final": self.final,
            "period": self.period,
            "squeeze": {
                "breaks": self.squeeze.breaks.tolist(),
                "ends": self.squeeze.ends.tolist(),
                "images": self.squeeze.images.tolist(),
                "modulus": self.squeeze.modulus,
            },
            "model": self.model,
            "mobility_ratio": self.mobility_ratio,
            "part": {
                "outline": shapely.to_wkt(self.part.polygon, rounding_precision=17),
                "areal_density": self.part.areal_density,
                "name": self.part.name,
            },
        }
        return json.dumps(record, indent=2, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str | Path) -> AlignmentPlan:
        """Read a plan from JSON text or from a file."""
        source = text if isinstance(text, Path) else "plan"
        try:
            record = json.loads(
                text.read_text(encoding="utf-8") if isinstance(text, Path) else text
            )
            return _plan_from(record)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise ModelError(source, "", f"is no alignment plan: {error!r}") from error

    @property
    def least_margin(self) -> float:
        """Smallest of the margins [rad]; infinity for a plan of one step."""
        return float(self.margins.min())

    def __repr__(self) -> str:
        """Return lines and least margin in degrees."""
        lines = ", ".join(f"{angle:.2f}" for angle in np.degrees(self.lines))
        margin = f"{np.degrees(self.least_margin):.2f} deg" if len(self.lines) > 1 else "any"
        return f"AlignmentPlan(lines at {lines} deg, margin {margin})"


def _plan_from(record: dict[str, Any]) -> AlignmentPlan:
    squeeze = SqueezeFunction(
        np.array(record["squeeze"]["breaks"], dtype=np.float64),
        np.array(record["squeeze"]["ends"], dtype=np.float64),
        np.array(record["squeeze"]["images"], dtype=np.float64),
        float(record["period"]),
        float(record["squeeze"]["modulus"]),
    )
    part = Part(
        shapely.from_wkt(record["part"]["outline"]),
        record["part"]["areal_density"],
        name=record["part"]["name"],
    )
    margins = [np.inf if margin is None else float(margin) for margin in record["margins"]]
    return AlignmentPlan(
        np.array(record["lines"], dtype=np.float64),
        np.array(margins),
        float(record["final"]),
        float(record["period"]),
        squeeze,
        part,
        record["model"],
        float(record["mobility_ratio"]),
    )


@dataclass(frozen=True)
class _Arc:
    """A run of whole steps: it starts at `left` and is `width` wide; its images span `span`."""

    left: float
    width: float
    first_image: float
    span: float


def plan_alignment(
    part: Part, *, model: Model = "squeeze", min_margin: float = 0.0, mobility_ratio: float = 1.0
) -> AlignmentPlan:
    """Return the shortest plan of squeezes that aligns a part, with the largest margin.

    Parameters
    ----------
    part : Part
        The part.
    min_margin : float
        Least error of a line's angle [rad] that every step has to tolerate; a longer plan is
        accepted for it.

    Raises
    ------
    NoPlan
        The part is neutral, or no plan reaches `min_margin`; the error says what is reachable.

    Examples
    --------
    >>> t = Part([(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)])
    >>> plan_alignment(t)
    AlignmentPlan(lines at 0.00, 45.00 deg, margin 33.67 deg)
    """
    if not (np.isfinite(min_margin) and min_margin >= 0.0):
        raise InputError("min_margin", "must be at least 0 rad", value=min_margin)
    squeeze = step_function(part, model, mobility_ratio)
    if len(squeeze.breaks) == 0:
        raise NoPlan("the part is neutral: squeezing does not turn it, so nothing aligns it", 0.0)
    arcs = _arcs(squeeze)
    chain = _backward_chain(arcs, squeeze.period, 2 * max(min_margin, LINE_MARGIN))
    if chain is None:
        reachable = _reachable_margin(arcs, squeeze.period)
        raise NoPlan(
            f"min_margin: no plan has a margin of {np.degrees(min_margin):.4g} deg; "
            f"at most {np.degrees(reachable):.4g} deg is reachable",
            reachable,
        )
    return _forward_plan(_widen(chain, arcs, squeeze.period), squeeze, part, model, mobility_ratio)


def _arcs(squeeze: SqueezeFunction) -> list[_Arc]:
    """Return all runs of at most one period of steps that start within one period."""
    k = round(len(squeeze.breaks) * squeeze.period / np.pi)
    breaks = np.append(squeeze.breaks[:k], squeeze.breaks[:k] + squeeze.period)
    images = np.append(squeeze.images[:k], squeeze.images[:k] + squeeze.period)
    ends = np.append(breaks[1:], breaks[k] + squeeze.period)
    return [
        _Arc(
            breaks[i],
            squeeze.period if n == k else ends[i + n - 1] - breaks[i],
            images[i],
            images[i + n - 1] - images[i],
        )
        for i in range(k)
        for n in range(1, k + 1)
    ]


def _backward_chain(arcs: list[_Arc], period: float, gap: float) -> list[_Arc] | None:
    """Return the arcs from the last to the first, each `gap` wider than the images it receives."""
    chain: list[_Arc] = []
    while not chain or chain[-1].width < period:
        room = chain[-1].width - gap if chain else 0.0
        fitting = [arc for arc in arcs if arc.span <= room]
        if not fitting:
            return None
        widest = max(arc.width for arc in fitting)
        best = min((a for a in fitting if a.width >= widest), key=lambda a: (a.span, a.left))
        if chain and best.width <= chain[-1].width:
            return None
        chain.append(best)
    return chain


def _margin(chain: list[_Arc]) -> float:
    gaps = [late.width - early.span for late, early in itertools.pairwise(chain)]
    return min(gaps, default=np.inf) / 2


def _widen(chain: list[_Arc], arcs: list[_Arc], period: float) -> list[_Arc]:
    """Return the chain of the same length with the largest margin."""
    while np.isfinite(_margin(chain)):
        better = _backward_chain(arcs, period, 2 * _margin(chain) * (1 + 1e-12))
        if better is None or len(better) > len(chain):
            return chain
        chain = better
    return chain


def _reachable_margin(arcs: list[_Arc], period: float) -> float:
    """Return the largest margin of a plan of any length; 0 if there is no plan."""
    best, chain = 0.0, _backward_chain(arcs, period, 2 * LINE_MARGIN)
    while chain is not None:
        best = _margin(chain)
        chain = _backward_chain(arcs, period, 2 * best * (1 + 1e-12))
    return best


def _forward_plan(
    chain: list[_Arc], squeeze: SqueezeFunction, part: Part, model: Model, mobility_ratio: float
) -> AlignmentPlan:
    """Turn each line so that the images of one arc fall into the middle of the next."""
    lines, margins = [0.0], [np.inf]
    for early, late in zip(chain[::-1], chain[-2::-1], strict=False):
        margin = 0.5 * (late.width - early.span)
        lines.append(lines[-1] + early.first_image - late.left - margin)
        margins.append(margin)
    final = np.mod(lines[-1] + chain[0].first_image, squeeze.period)
    return AlignmentPlan(
        np.mod(lines, squeeze.modulus),
        np.array(margins),
        float(final),
        squeeze.period,
        squeeze,
        part,
        model,
        mobility_ratio,
    )
