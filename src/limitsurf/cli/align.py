"""``limitsurf align``: plan the alignment of a part and verify it on an array."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.console import Console
from rich.table import Table

from limitsurf.errors import InputError

if TYPE_CHECKING:
    from limitsurf.planning.array_verification import ArrayVerification
    from limitsurf.planning.turn_function import TurnFunction

__all__ = ["align"]


def align(
    part: Annotated[
        str, typer.Argument(help="Outline (SVG, WKT, GeoJSON), part model (TOML) or model name.")
    ],
    array: Annotated[str, typer.Option(help="Array model: a name or a TOML file.")],
    areal_density: Annotated[
        str | None, typer.Option(help="Mass per area, such as '80 g/m^2'.")
    ] = None,
    unit: Annotated[
        str | None, typer.Option(help="Length of one unit of the outline, such as mm.")
    ] = None,
    voltage: Annotated[
        str | None, typer.Option(help="Drive voltage, such as 50 or '50 V'; else the model's.")
    ] = None,
    samples: Annotated[int, typer.Option(help="Number of simulated runs.")] = 200,
    seed: Annotated[int, typer.Option(help="Seed of the random starts.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Folder for plan.json, runs.nc and report.html.")
    ] = None,
    method: Annotated[
        Literal["dither", "nearest"],
        typer.Option(help="Directions of the pixels: dither, or nearest axis."),
    ] = "dither",
    mode: Annotated[
        Literal["inertial", "quasi-static"], typer.Option(help="How the part moves.")
    ] = "inertial",
    start_offset: Annotated[
        str | None, typer.Option(help="Radius of the disk of starts, such as '1 mm'.")
    ] = None,
    min_margin: Annotated[
        str, typer.Option(help="Least error of a line that every step tolerates.")
    ] = "0 deg",
    push: Annotated[
        Literal["computed", "model"],
        typer.Option(help="Push of a tip: from its resonator, or as the actuator model says."),
    ] = "computed",
) -> None:
    """Plan the sensorless alignment of PART and verify it by simulation on ARRAY."""
    from limitsurf.actuators.actuator_array import load_array
    from limitsurf.geometry.part import Part
    from limitsurf.planning.alignment import plan_alignment
    from limitsurf.planning.turn_function import turn_function
    from limitsurf.planning.verification import verify_alignment
    from limitsurf.units import parse_quantity

    begin = time.perf_counter()
    _check_out(out)
    the_part = Part.from_file(part, unit=unit, areal_density=areal_density)
    volts = None if voltage is None else parse_quantity(_number(voltage), "V", name="voltage")
    the_array = load_array(array, voltage=volts)
    offset = (
        None if start_offset is None else parse_quantity(start_offset, "m", name="start_offset")
    )
    margin = parse_quantity(min_margin, "rad", name="min_margin")
    plan = plan_alignment(the_part, min_margin=margin)
    if push == "computed":
        the_array = the_array.running_under(the_part)
    verification = verify_alignment(
        plan,
        the_part,
        the_array,
        samples,
        seed,
        mode=mode,
        method=method,
        start_offset=offset,
        progress=True,
    )
    turn = turn_function(the_part)
    if out is not None:
        _write(out, turn, verification)
    _print(turn, verification, time.perf_counter() - begin)
    if out is not None:
        typer.echo(f"wrote {', '.join(str(out / name) for name in _FILES)}")


_FILES = ("plan.json", "runs.nc", "report.html")


def _number(text: str) -> str | float:
    """Return a bare number as a float, which is then in the SI unit."""
    try:
        return float(text)
    except ValueError:
        return text


def _check_out(out: Path | None) -> None:
    """Raise before the long work if the output folder cannot be used."""
    if out is None:
        return
    nearest = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    if not nearest.is_dir():
        raise InputError("out", f"{nearest} is a file", remedy="name a folder")
    if not os.access(nearest, os.W_OK):
        raise InputError("out", f"{nearest} cannot be written", remedy="name another folder")


def _write(out: Path, turn: TurnFunction, verification: ArrayVerification) -> None:
    """Write all files beside the folder first, then move them in: never a half-written one."""
    from limitsurf.report.alignment import alignment_page

    out.absolute().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.absolute().parent, prefix=".limitsurf-") as folder:
        draft = Path(folder)
        (draft / "plan.json").write_text(verification.plan.to_json(), encoding="utf-8")
        verification.to_dataset().to_netcdf(draft / "runs.nc", engine="scipy")
        (draft / "report.html").write_text(alignment_page(turn, verification), encoding="utf-8")
        out.mkdir(parents=True, exist_ok=True)
        for name in _FILES:
            shutil.move(draft / name, out / name)


def _print(turn: TurnFunction, verification: ArrayVerification, seconds: float) -> None:
    from limitsurf.report.alignment import plan_rows, summary_rows, verdict

    console = Console()
    summary = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for row in summary_rows(turn, verification):
        summary.add_row(*row)
    summary.add_row("computing time", f"{seconds:.1f} s")
    plan = Table("step", "line", "margin", "runs at rest", box=None, padding=(0, 2, 0, 0))
    for row in plan_rows(verification):
        plan.add_row(*row)
    console.print(summary)
    console.print()
    console.print(plan)
    console.print()
    console.print(verdict(verification))
