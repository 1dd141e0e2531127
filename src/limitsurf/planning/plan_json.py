"""Alignment plans as JSON; every number comes back bit for bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.errors import InputError, ModelError
from limitsurf.geometry.part import Part
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.planning.step_function import Model

if TYPE_CHECKING:
    from limitsurf.planning.alignment import AlignmentPlan

__all__ = ["PlanFields", "read_plan", "write_plan"]

Array = NDArray[np.float64]

_FORMAT = "limitsurf alignment plan 2"


class PlanFields(NamedTuple):
    """The fields of an `AlignmentPlan`, in its order."""

    lines: Array
    margins: Array
    final: float
    period: float
    squeeze: SqueezeFunction
    part: Part
    model: Model
    mobility_ratio: float


def write_plan(plan: AlignmentPlan) -> str:
    """Return a plan as JSON text: angles in radians, the outline as GeoJSON in metres."""
    squeeze, part = plan.squeeze, plan.part
    record = {
        "format": _FORMAT,
        "unit": "rad",
        "lines": plan.lines.tolist(),
        "margins": [m if np.isfinite(m) else None for m in plan.margins.tolist()],
        "final": plan.final,
        "period": plan.period,
        "squeeze": {
            "breaks": squeeze.breaks.tolist(),
            "ends": squeeze.ends.tolist(),
            "images": squeeze.images.tolist(),
            "modulus": squeeze.modulus,
        },
        "model": plan.model,
        "mobility_ratio": plan.mobility_ratio,
        "part": {
            "outline": shapely.geometry.mapping(part.polygon),
            "areal_density": part.areal_density,
            "name": part.name,
        },
    }
    return json.dumps(record, indent=2, allow_nan=False) + "\n"


def read_plan(text: str | Path) -> PlanFields:
    """Read a plan from JSON text or from a file.

    Raises
    ------
    ModelError
        No such file, no JSON, another format, or a field that is missing or malformed.
    """
    source = text if isinstance(text, Path) else "plan"
    try:
        content = text.read_text(encoding="utf-8") if isinstance(text, Path) else text
        record = json.loads(content)
    except (OSError, ValueError, TypeError) as error:
        raise ModelError(source, "", f"is no alignment plan: {error}") from error
    fields = _Fields(source, "", record)
    _check_format(fields)
    squeeze, part = fields.record("squeeze"), fields.record("part")
    steps = squeeze.numbers("breaks"), squeeze.numbers("ends"), squeeze.numbers("images")
    lines, margins = fields.numbers("lines"), fields.numbers("margins", null=np.inf)
    if len(lines) == 0 or len(margins) != len(lines):
        raise fields.bad("margins", f"has {len(margins)} entries for {len(lines)} lines")
    if len({len(x) for x in steps}) > 1:
        raise squeeze.bad("ends", "breaks, ends and images differ in number")
    period, modulus = fields.positive("period"), squeeze.positive("modulus")
    model = fields.get("model")
    if model not in get_args(Model):
        raise fields.bad("model", f"is none of {', '.join(get_args(Model))}", model)
    ratio = fields.number("mobility_ratio")
    if ratio < 0.0:
        raise fields.bad("mobility_ratio", "must be at least 0", ratio)
    return PlanFields(
        lines,
        margins,
        fields.number("final"),
        period,
        SqueezeFunction(*steps, period, modulus),
        _part(part),
        model,
        ratio,
    )


class _Fields(NamedTuple):
    """A record of a file, and how to read its fields or to say which one is wrong."""

    source: object
    place: str
    values: Any

    def bad(self, field: str, problem: str, value: Any = None, remedy: str = "") -> ModelError:
        return ModelError(self.source, self.place + field, problem, value=value, remedy=remedy)

    def get(self, field: str) -> Any:
        if not isinstance(self.values, dict) or field not in self.values:
            raise self.bad(field, "is missing: this is no alignment plan")
        return self.values[field]

    def record(self, field: str) -> _Fields:
        value = self.get(field)
        if not isinstance(value, dict):
            raise self.bad(field, "is no record")
        return _Fields(self.source, f"{self.place}{field}.", value)

    def number(self, field: str) -> float:
        return float(self._checked(field, [self.get(field)], np.nan)[0])

    def positive(self, field: str) -> float:
        number = self.number(field)
        if number <= 0.0:
            raise self.bad(field, "must be positive", number)
        return number

    def numbers(self, field: str, null: float = np.nan) -> Array:
        value = self.get(field)
        if not isinstance(value, list):
            raise self.bad(field, "is no list of numbers", value)
        return self._checked(field, value, null)

    def _checked(self, field: str, values: list[Any], null: float) -> Array:
        given = [null if v is None and not np.isnan(null) else v for v in values]
        for value in given:
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not is_number or (value != null and not np.isfinite(value)):
                raise self.bad(field, "is no finite number", value)
        return np.array(given, dtype=np.float64)


def _check_format(fields: _Fields) -> None:
    found = fields.get("format")
    if found == "limitsurf alignment plan 1":
        raise fields.bad("format", "is 1, which lacks the part and the model", remedy="plan again")
    if found != _FORMAT:
        raise fields.bad("format", f"is not {_FORMAT!r}", found)
    if fields.get("unit") != "rad":
        raise fields.bad("unit", "must be rad", fields.get("unit"))


def _part(part: _Fields) -> Part:
    density, name = part.get("areal_density"), part.get("name")
    if density is not None:
        part.positive("areal_density")
    if not isinstance(name, str):
        raise part.bad("name", "is no text", name)
    try:
        return Part(shapely.geometry.shape(part.record("outline").values), density, name=name)
    except InputError as error:
        raise part.bad("outline", error.problem) from error
    except (shapely.errors.ShapelyError, ValueError, TypeError, LookupError, AttributeError) as e:
        raise part.bad("outline", "is no GeoJSON polygon") from e
