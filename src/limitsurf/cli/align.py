"""``limitsurf align``: plan the alignment of a part and verify it on an array."""

from __future__ import annotations

import os
import re
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
    import numpy as np
    from numpy.typing import NDArray

    from limitsurf.actuators.actuator_array import ActuatorArray
    from limitsurf.planning.alignment import AlignmentPlan
    from limitsurf.planning.array_verification import ArrayVerification
    from limitsurf.planning.robustness import Robustness
    from limitsurf.report.alignment import Findings

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
    pieces: Annotated[
        bool, typer.Option("--pieces", help="Several outlines are pieces of one rigid part.")
    ] = False,
    voltage: Annotated[
        str | None, typer.Option(help="Drive voltage, such as 50 or '50 V'; else the model's.")
    ] = None,
    samples: Annotated[int, typer.Option(help="Number of simulated runs.")] = 200,
    seed: Annotated[int, typer.Option(help="Seed of the random starts.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Folder for plan.json, runs.nc and report.html.")
    ] = None,
    model: Annotated[
        Literal["squeeze", "centred", "push-squeeze", "unknown-offset"],
        typer.Option(help="How the steps are executed, and what the plan allows for."),
    ] = "squeeze",
    lines: Annotated[
        str | None, typer.Option(help="Angles that lines may take, such as '0, 45, 90 deg'.")
    ] = None,
    goal: Annotated[
        str | None, typer.Option(help="Orientation at the end, such as '30 deg'.")
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
    from limitsurf.planning.verification import verify_alignment

    begin = time.perf_counter()
    _check_out(out)
    the_part = Part.from_file(part, unit=unit, areal_density=areal_density, pieces=pieces)
    the_array = load_array(array, voltage=_optional(voltage, "V", "voltage"))
    offset = _optional(start_offset, "m", "start_offset")
    plan = plan_alignment(
        the_part,
        model=model,
        lines=None if lines is None else _angles(lines),
        min_margin=_optional(min_margin, "rad", "min_margin") or 0.0,
        goal=_optional(goal, "rad", "goal"),
    )
    if push == "computed":
        the_array = the_array.running_under(the_part)
    robustness = plan.robustness(the_array, method=method, start_offset=offset)
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
    _report(robustness, verification, _durations(plan, the_array, method, offset), out, begin)


_FILES = ("plan.json", "runs.nc", "report.html")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_LINES = "write it like '0, 45, 90 deg'"


def _optional(text: str | None, unit: str, name: str) -> float | None:
    """Return a quantity in the SI unit; None if not given.

    A bare number is in that unit already if it is the voltage; angles and lengths need a unit, as
    nobody means 30 radians.
    """
    from limitsurf.units import parse_quantity

    if text is None:
        return None
    bare = unit == "V" and re.fullmatch(_NUMBER, text.strip())
    return parse_quantity(float(text) if bare else text, unit, name=name)


def _angles(text: str) -> list[float]:
    """Return the angles of a list such as '0, 45, 90 deg' [rad].

    Numbers without a unit have that of the next one that has.
    """
    from limitsurf.units import parse_quantity

    unit, angles = "", []
    for word in reversed(text.split(",")):
        found = re.fullmatch(rf"\s*({_NUMBER})\s*([^\W\d][^\s,]*|°)?\s*", word)
        if found is None:
            raise InputError("lines", "is no list of angles", value=text, remedy=_LINES)
        unit = found[2] or unit
        if not unit:
            raise InputError("lines", "has no unit at its end", value=text, remedy=_LINES)
        angles.append(parse_quantity(f"{found[1]} {unit}", "rad", name="lines"))
    return angles[::-1]


def _report(
    robustness: Robustness,
    verification: ArrayVerification,
    durations: NDArray[np.float64],
    out: Path | None,
    begin: float,
) -> None:
    """Write the files, if there is a folder for them, and print what came out."""
    from limitsurf.planning.turn_function import turn_function
    from limitsurf.report.alignment import Findings

    findings = Findings(turn_function(verification.part), robustness, verification, durations)
    if out is not None:
        _write(out, findings)
    _print(findings, time.perf_counter() - begin)
    if out is not None:
        typer.echo(f"wrote {', '.join(str(out / name) for name in _FILES)}")


def _durations(
    plan: AlignmentPlan, array: ActuatorArray, method: str, offset: float | None
) -> NDArray[np.float64]:
    """Return the expected time of each line [s]; nan if it is not known.

    That is if some starts take too long, and if pushes are not normal to the line.
    """
    import numpy as np

    from limitsurf.errors import SolveFailed
    from limitsurf.planning.duration import line_durations

    unknown = np.full(len(plan.lines), np.nan)
    if method != "dither":
        return unknown
    try:
        return line_durations(plan, array, start_offset=offset)
    except SolveFailed:
        return unknown


def _check_out(out: Path | None) -> None:
    """Raise before the long work if the output folder cannot be used."""
    if out is None:
        return
    nearest = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    if not nearest.is_dir():
        raise InputError("out", f"{nearest} is a file", remedy="name a folder")
    if not os.access(nearest, os.W_OK):
        raise InputError("out", f"{nearest} cannot be written", remedy="name another folder")


def _write(out: Path, findings: Findings) -> None:
    """Write all files beside the folder first, then move them in: never a half-written one."""
    from limitsurf.report.alignment import alignment_page

    out.absolute().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.absolute().parent, prefix=".limitsurf-") as folder:
        draft = Path(folder)
        verification = findings.verification
        (draft / "plan.json").write_text(verification.plan.to_json(), encoding="utf-8")
        verification.to_dataset().to_netcdf(draft / "runs.nc", engine="scipy")
        (draft / "report.html").write_text(alignment_page(findings), encoding="utf-8")
        out.mkdir(parents=True, exist_ok=True)
        for name in _FILES:
            shutil.move(draft / name, out / name)


def _print(findings: Findings, seconds: float) -> None:
    from limitsurf.report.alignment import PLAN_HEAD, plan_rows, summary_rows, verdict

    console = Console()
    summary = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for row in summary_rows(findings):
        summary.add_row(*row)
    summary.add_row("computing time", f"{seconds:.1f} s")
    plan = Table(*PLAN_HEAD, box=None, padding=(0, 2, 0, 0))
    for row in plan_rows(findings):
        plan.add_row(*row)
    console.print(summary)
    console.print()
    console.print(plan)
    console.print()
    console.print(verdict(findings.verification))
