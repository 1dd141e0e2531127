"""Tables of loads and motions: columns by name, with their units in brackets.

``fx [N], fy [N], m [N m]`` with ``dx [m], dy [m], dtheta [rad]`` or with ``vx [m/s], vy [m/s],
omega [rad/s]``, and, all three or none, standard deviations ``sd fx [N]`` and so on.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.datasets.plausibility import DroppedRows
from limitsurf.errors import InputError
from limitsurf.units import parse_quantity

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Motion", "Table", "read_table", "write_table"]

Array = NDArray[np.float64]
Motion = Literal["displacement", "velocity"]

_LOAD = {"fx": "N", "fy": "N", "m": "N m"}
_TWIST: dict[Motion, dict[str, str]] = {
    "displacement": {"dx": "m", "dy": "m", "dtheta": "rad"},
    "velocity": {"vx": "m/s", "vy": "m/s", "omega": "rad/s"},
}
_UNITS = {name: unit for names in (_LOAD, *_TWIST.values()) for name, unit in names.items()}
_UNITS |= {f"sd {name}": unit for name, unit in _UNITS.items()}
_LABEL = re.compile(r"([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?")


@dataclass(frozen=True, eq=False)
class Table:
    """The numbers of a table in SI units, (n, 3) each; deviations None if there are none."""

    loads: Array
    twists: Array
    motion: Motion
    load_deviations: Array | None = None
    twist_deviations: Array | None = None


def write_table(table: Table) -> pd.DataFrame:
    """Return a data frame with named columns in SI units."""
    import pandas as pd

    blocks = {"": (table.loads, table.twists)}
    blocks["sd "] = (table.load_deviations, table.twist_deviations)  # type: ignore[assignment]
    columns: dict[str, Array] = {}
    for prefix, rows in blocks.items():
        for names, block in zip((_LOAD, _TWIST[table.motion]), rows, strict=True):
            if block is not None:
                titles = (f"{prefix}{name} [{unit}]" for name, unit in names.items())
                columns |= dict(zip(titles, block.T, strict=True))
    return pd.DataFrame(columns)


def read_table(frame: pd.DataFrame, ignore: str | Sequence[str] = ()) -> Table:
    """Return the numbers of a data frame, converted to SI units; rows not finite are dropped.

    Columns named in `ignore` are left out.

    Raises
    ------
    InputError
        Unknown, missing or doubled columns; units that are missing or of the wrong dimension;
        entries that are no numbers; no row left. Names the column, and the row by its index.

    Warns
    -----
    DroppedRows
        Says how many rows were dropped, and because of which columns.
    """
    if not hasattr(frame, "columns"):
        raise InputError("frame", "is no data frame", value=frame)
    ignored = [ignore] if isinstance(ignore, str) else list(ignore)
    titles = _titles([str(title) for title in frame.columns if title not in ignored])
    motions = [motion for motion, names in _TWIST.items() if set(names) & set(titles)]
    if len(motions) > 1:
        raise InputError("columns", "hold displacements and velocities", remedy="ignore one kind")
    motion = motions[0] if motions else "displacement"
    wanted = [tuple(_LOAD), tuple(_TWIST[motion])]
    missing = [name for names in wanted for name in names if name not in titles]
    if missing:
        raise InputError(missing[0], "is missing", remedy=f"add a column {_example(missing[0])}")
    values = {name: _numbers(frame, title, name) for name, title in titles.items()}
    kept = _finite(values, titles, frame.index)
    loads, twists = (np.column_stack([values[name][kept] for name in names]) for names in wanted)
    return Table(loads, twists, motion, *(_deviations(values, names, kept) for names in wanted))


def _titles(titles: Iterable[str]) -> dict[str, str]:
    """Return the titles of known columns by their plain names."""
    found: dict[str, str] = {}
    for title in titles:
        match = _LABEL.fullmatch(title.strip())
        name = " ".join(re.split(r"[\s_]+", match[1].lower())) if match else ""
        if name not in _UNITS:
            remedy = f"ignore it, or name it as one of {', '.join(_UNITS)}, with a unit"
            raise InputError(title, "is an unknown column", remedy=remedy)
        if match is None or match[2] is None:
            raise InputError(title, "has no unit", remedy=f"write it like {_example(name)}")
        if name in found:
            raise InputError(title, f"is there twice, also as {found[name]!r}", remedy="ignore one")
        found[name] = title
    return found


def _numbers(frame: pd.DataFrame, title: str, name: str) -> Array:
    import pandas as pd

    unit = _LABEL.fullmatch(title.strip())[2]  # type: ignore[index]
    scale = parse_quantity(f"1 {unit}", _UNITS[name], name=title)
    values = pd.to_numeric(frame[title], errors="coerce")
    wrong = (values.isna() & frame[title].notna()).to_numpy()
    if wrong.any():
        k = int(np.argmax(wrong))
        row = f"{frame.index.name or 'row'} {frame.index[k]}"
        raise InputError(title, f"is no number in {row}", value=frame[title].iloc[k])
    return np.asarray(values.to_numpy(dtype=np.float64, na_value=np.nan) * scale)


def _finite(values: dict[str, Array], titles: dict[str, str], index: Any) -> NDArray[np.bool_]:
    bad = {titles[name]: ~np.isfinite(column) for name, column in values.items()}
    dropped = np.logical_or.reduce(list(bad.values()))
    if dropped.any():
        why = ", ".join(f"{title} ({b.sum()})" for title, b in bad.items() if b.any())
        rows = ", ".join(str(i) for i in index[dropped][:5]) + (
            ", ..." if dropped.sum() > 5 else ""
        )
        text = f"{dropped.sum()} of {len(dropped)} rows dropped, not finite in {why}"
        warnings.warn(f"{text}: {index.name or 'row'} {rows}", DroppedRows, stacklevel=4)
    if dropped.all():
        raise InputError("rows", "are none", remedy="give at least one complete row")
    return np.asarray(~dropped)


def _deviations(
    values: dict[str, Array], names: tuple[str, ...], kept: NDArray[np.bool_]
) -> Array | None:
    given = [f"sd {name}" in values for name in names]
    if not any(given):
        return None
    if not all(given):
        lacking = f"sd {names[given.index(False)]}"
        raise InputError(lacking, "is missing", remedy="give all three deviations or none")
    return np.column_stack([values[f"sd {name}"][kept] for name in names])


def _example(name: str) -> str:
    return f"{name} [{_UNITS[name]}]"
