"""``limitsurf models``: list, show and check model files, and export their schemas."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from limitsurf.errors import InputError, ModelError
from limitsurf.modelfiles import describe_models, find_model, list_models, read_toml

if TYPE_CHECKING:
    from limitsurf.modelfiles import Model

__all__ = ["models"]

KINDS = ("parts", "arrays", "actuators", "resonators")

models = typer.Typer(help="List, show and check model files.", invoke_without_command=True)

Kind = Annotated[str | None, typer.Option(help=f"Kind of model: {', '.join(KINDS)}.")]


def schemas() -> dict[str, type[Model]]:
    """Return the schema of every kind of model file."""
    from limitsurf.actuators.actuator_array import ArrayModel
    from limitsurf.actuators.resonator_model import ResonatorModel
    from limitsurf.actuators.resonator_pixel import PixelModel
    from limitsurf.geometry.outline_files import PartModel

    return dict(zip(KINDS, (PartModel, ArrayModel, PixelModel, ResonatorModel), strict=True))


def _loaders() -> dict[str, Callable[[Path], Any]]:
    """Return what builds a thing from a model file, with all that the schema cannot check."""
    from limitsurf.actuators.actuator_array import load_array
    from limitsurf.actuators.resonator_pixel import load_pixel
    from limitsurf.actuators.torsional_resonator import TorsionalResonator
    from limitsurf.geometry.part import Part

    return dict(
        zip(
            KINDS,
            (Part.from_file, load_array, load_pixel, TorsionalResonator.from_model),
            strict=True,
        )
    )


@models.callback()
def _without_command(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        list_all()


@models.command("list")
def list_all(kind: Kind = None) -> None:
    """List the models that come with limitsurf."""
    for each in _kinds(kind):
        typer.echo(f"{each}:")
        for name, description in describe_models(each).items():
            typer.echo(f"  {name:16} {description}")


@models.command()
def show(
    model: Annotated[str, typer.Argument(help="Name of a model, or a TOML file.")],
    kind: Kind = None,
) -> None:
    """Show every number of a model with its unit and where it comes from."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    for each, path in _located(model, kind):
        data = read_toml(path)
        table = Table("number", "value", "", "origin", title=f"{each}/{path.stem}")
        for name, entry in entries(data):
            mark = "assumed" if "assumed" in entry else "source"
            value = entry.get("value", "(outline)")
            table.add_row(name, escape(str(value)), mark, escape(str(entry.get(mark, ""))))
        typer.echo(data.get("description", ""))
        Console().print(table)


@models.command()
def check(
    paths: Annotated[
        list[str] | None,
        typer.Argument(help="Names of models, or TOML files; all shipped models by default."),
    ] = None,
    kind: Kind = None,
) -> None:
    """Check model files: schema, units, origins, and that what they describe can be built."""
    load = _loaders()
    chosen = [found for path in paths or [] for found in _located(path, kind)]
    if not paths:
        chosen = [(k, find_model(k, n)) for k in _kinds(kind) for n in list_models(k)]
    for each, path in chosen:
        if each not in load:
            raise InputError("kind", "is unknown", value=each, remedy=f"use {', '.join(KINDS)}")
        load[each](path)
        found = [entry for _, entry in entries(read_toml(path))]
        assumed = sum("assumed" in entry for entry in found)
        typer.echo(f"ok  {each}/{path.stem}: {len(found)} numbers, {assumed} assumed")


@models.command()
def schema(
    kind: Annotated[str | None, typer.Argument(help=f"One of {', '.join(KINDS)}.")] = None,
) -> None:
    """Print the JSON schema of one kind of model file, or of all by kind."""
    kinds = _kinds(kind)
    known = schemas()
    found = {each: known[each].model_json_schema() for each in kinds}
    typer.echo(json.dumps(found if kind is None else found[kinds[0]], indent=2))


def entries(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield name and table of every number, and of an outline, in a model file."""
    for key, value in table.items():
        where = f"{path}.{key}" if path else key
        if isinstance(value, Mapping):
            if "value" in value or {"source", "assumed"} & set(value):
                yield where, value
            yield from entries(value, where)


def guess_kind(path: Path) -> str:
    """Return the kind whose fields a file shares most."""
    keys = set(read_toml(path)) - {"description"}
    shared = {kind: len(keys & set(s.model_fields)) for kind, s in schemas().items()}
    best = max(shared, key=lambda kind: shared[kind])
    if shared[best] == 0:
        remedy = f"say --kind, one of {', '.join(KINDS)}"
        raise ModelError(path, "", "is no kind of model that is known", remedy=remedy)
    return best


def _kinds(kind: str | None) -> tuple[str, ...]:
    if kind is None:
        return KINDS
    if kind not in KINDS:
        raise InputError("kind", "is unknown", value=kind, remedy=f"use {', '.join(KINDS)}")
    return (kind,)


def _located(model: str, kind: str | None) -> list[tuple[str, Path]]:
    """Return kind and file of the models of a name; one name may be of several kinds."""
    if Path(model).is_file():
        return [(kind or guess_kind(Path(model)), Path(model))]
    found = []
    for each in _kinds(kind):
        try:
            found.append((each, find_model(each, model)))
        except ModelError:
            continue
    if not found:
        raise ModelError(model, "", "no such file or model", remedy="limitsurf models list")
    return found
