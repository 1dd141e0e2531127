"""Model files: TOML in which every number has a unit and says where it comes from.

A number is a small table, ``{ value = "200 um", source = "paper, section 5" }``, or with
``assumed = "why"`` where no source gives it.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import CoreSchema, core_schema

from limitsurf.errors import InputError, ModelError
from limitsurf.units import parse_quantity

__all__ = [
    "Model",
    "Sourced",
    "describe_models",
    "find_model",
    "list_models",
    "load_model",
    "number",
    "read_toml",
]


class Model(BaseModel):
    """Base of the schemas: unknown keys are errors, values are immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


@dataclass(frozen=True)
class Sourced:
    """A number in SI units with its origin.

    Attributes
    ----------
    value : float
        The number, SI.
    note : str
        Its source, or why it was assumed.
    assumed : bool
        True if no source gives it.
    """

    value: float
    note: str
    assumed: bool


M = TypeVar("M", bound=Model)


@dataclass(frozen=True)
class SourcedNumber:
    """Reads a sourced number in `unit`, optionally bounded from below; describes itself as JSON."""

    unit: str
    above: float | None = None
    at_least: float | None = None

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Validate by `read` alone."""
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Return a table with a value and exactly one of source, assumed."""
        text = {"type": "string", "description": f"quantity in units of {self.unit}"}
        plain: dict[str, Any] = {"type": "number"}
        if self.above is not None:
            plain["exclusiveMinimum"] = self.above
        if self.at_least is not None:
            plain["minimum"] = self.at_least
        return {
            "type": "object",
            "properties": {
                "value": text if self.unit else {"anyOf": [plain, {"type": "string"}]},
                "source": {"type": "string", "description": "where the value comes from"},
                "assumed": {"type": "string", "description": "why it was assumed"},
            },
            "required": ["value"],
            "oneOf": [{"required": ["source"]}, {"required": ["assumed"]}],
            "additionalProperties": False,
        }

    def read(self, raw: Any) -> Sourced:
        """Return the number in SI units with its origin."""
        if not isinstance(raw, Mapping):
            raise ValueError(
                "write it as { value = ..., source = ... } or { value = ..., assumed = ... }"
            )
        unknown = sorted(set(raw) - {"value", "source", "assumed"})
        if unknown:
            raise ValueError(
                f"unknown key {unknown[0]!r}; a number has value, and source or assumed"
            )
        if "value" not in raw or ("source" in raw) == ("assumed" in raw):
            raise ValueError("needs value and exactly one of source, assumed")
        if self.unit and not isinstance(raw["value"], str):
            raise ValueError(f'value needs a unit, such as "{raw["value"]} {self.unit}"')
        return self._bounded(raw, parse_quantity(raw["value"], self.unit, name="value"))

    def _bounded(self, raw: Mapping[str, Any], value: float) -> Sourced:
        note = raw.get("source", raw.get("assumed"))
        if not isinstance(note, str) or not note.strip():
            raise ValueError("source or assumed must say something")
        if self.above is not None and not value > self.above:
            raise ValueError(f"must be greater than {self.above:g} (got {raw['value']!r})")
        if self.at_least is not None and not value >= self.at_least:
            raise ValueError(f"must be at least {self.at_least:g} (got {raw['value']!r})")
        return Sourced(value, note, "assumed" in raw)


def number(unit: str, *, above: float | None = None, at_least: float | None = None) -> Any:
    """Return the annotation of a sourced number in `unit`, optionally bounded from below."""
    return SourcedNumber(unit, above, at_least)


def models_folder() -> Path:
    """Return the folder of the shipped models: in the wheel, or at the top of a checkout."""
    package = Path(__file__).parent
    shipped = package / "models"
    return shipped if shipped.is_dir() else package.parents[1] / "models"


def list_models(kind: str) -> list[str]:
    """Return the names of the shipped models of one kind, such as parts or arrays."""
    return sorted(path.stem for path in (models_folder() / kind).glob("*.toml"))


def describe_models(kind: str) -> dict[str, str]:
    """Return name and description of the shipped models of one kind."""
    folder = models_folder() / kind
    texts = {n: (folder / f"{n}.toml").read_text(encoding="utf-8") for n in list_models(kind)}
    return {name: str(tomllib.loads(text)["description"]) for name, text in texts.items()}


def find_model(kind: str, name_or_path: str | Path) -> Path:
    """Return the file of a shipped model by name, or the path itself if there is such a file.

    Upper and lower case, ``-`` and ``_`` are the same in names.

    Raises
    ------
    ModelError
        Neither a file nor a known name; the error lists the names.
    """
    path = Path(name_or_path)
    if path.is_file():
        return path
    names = list_models(kind)
    wanted = _plain(str(name_or_path))
    for name in names:
        if _plain(name) == wanted:
            return models_folder() / kind / f"{name}.toml"
    raise ModelError(
        name_or_path, "", "no such file or model", remedy=f"known {kind}: {', '.join(names)}"
    )


def read_toml(path: Path) -> dict[str, Any]:
    """Read any TOML file.

    Raises
    ------
    ModelError
        Unreadable file or broken TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ModelError(path, "", f"cannot be read: {error}", remedy="check the path") from error
    except tomllib.TOMLDecodeError as error:
        raise ModelError(path, "", f"is no TOML: {error}", remedy="mend that line") from error


def load_model(path: Path, schema: type[M]) -> M:
    """Read and check one TOML file against its schema.

    Raises
    ------
    ModelError
        Unreadable file, broken TOML, or the first field that does not fit.
    """
    data = read_toml(path)
    try:
        return schema.model_validate(data)
    except ValidationError as error:
        raise _model_error(path, schema, error) from error


def _model_error(path: Path, schema: type[Model], error: ValidationError) -> ModelError:
    first = error.errors()[0]
    field = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        known = ", ".join(sorted(_fields_at(schema, first["loc"][:-1])))
        return ModelError(path, field, "unknown key", remedy=f"known here: {known}")
    if first["type"] == "missing":
        return ModelError(path, field, "is missing", remedy="add it")
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        field = f"{field}.{cause.argument}"
        return ModelError(path, field, cause.problem, value=cause.value, remedy=cause.remedy)
    return ModelError(path, field, str(cause or first["msg"]))


def _fields_at(schema: type[Model], location: tuple[str | int, ...]) -> list[str]:
    current: Any = schema
    for name in location:
        fields = getattr(current, "model_fields", {})
        current = fields[name].annotation if name in fields else None
    return list(getattr(current, "model_fields", {}))


def _plain(name: str) -> str:
    return name.lower().replace("_", "-")
