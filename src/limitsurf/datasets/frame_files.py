"""Data frames in CSV and parquet files, with notes; written as a whole or not at all."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from limitsurf.errors import DataError, InputError
from limitsurf.motion.netcdf import as_target

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["read_frame", "write_frame"]

_SUFFIXES = (".csv", ".parquet")
_NO_PYARROW = "parquet files need pyarrow"
_INSTALL = "pip install 'limitsurf[fit]', or take .csv"


def write_frame(frame: pd.DataFrame, path: str | Path) -> None:
    """Write a data frame and its `attrs`; an interrupted write leaves the file before."""
    target = as_target(path, "path")
    if target is None or (suffix := target.suffix.lower()) not in _SUFFIXES:
        raise InputError("path", "must end in .csv or .parquet", value=str(path))
    unfinished = target.with_name(target.name + ".part")
    try:
        if suffix == ".csv":
            notes = "".join(f"# {key}: {value}\n" for key, value in frame.attrs.items())
            unfinished.write_text(notes + frame.to_csv(index=False, lineterminator="\n"), "utf-8")
        else:
            frame.to_parquet(unfinished, engine="pyarrow", index=False)
        unfinished.replace(target)
    except ImportError as error:
        raise InputError("path", _NO_PYARROW, value=str(path), remedy=_INSTALL) from error
    finally:
        unfinished.unlink(missing_ok=True)


def read_frame(path: str | Path, ignore: str | Sequence[str] = ()) -> pd.DataFrame:
    """Read a data frame; the rows of a CSV file are numbered by their lines in it.

    Raises
    ------
    DataError
        No such file, another suffix, rows of unequal length, entries that are no numbers in
        columns that are not ignored.
    """
    file, ignored = Path(path), [ignore] if isinstance(ignore, str) else list(ignore)
    if (suffix := file.suffix.lower()) not in _SUFFIXES:
        raise DataError(file, "must end in .csv or .parquet")
    try:
        return _read_csv(file, ignored) if suffix == ".csv" else _read_parquet(file)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DataError(file, f"cannot be read: {error}", remedy="check the path") from error


def _read_parquet(file: Path) -> pd.DataFrame:
    import pandas as pd

    try:
        import pyarrow as pa
    except ImportError as error:
        raise DataError(file, _NO_PYARROW, remedy=_INSTALL) from error
    try:
        return pd.read_parquet(file, engine="pyarrow")
    except pa.ArrowInvalid as error:
        raise DataError(file, f"is no parquet file: {error}") from error


def _read_csv(file: Path, ignore: Sequence[str]) -> pd.DataFrame:
    import pandas as pd

    lines = file.read_text(encoding="utf-8-sig").splitlines(keepends=True)
    head = next((k for k, line in enumerate(lines) if not line.startswith("#")), len(lines))
    notes = [line[1:].partition(":") for line in lines[:head]]
    reader = csv.reader(io.StringIO("".join(lines[head:])), skipinitialspace=True)
    numbered = [(head + reader.line_num, row) for row in reader if any(map(str.strip, row))]
    if not numbered:
        raise DataError(file, "holds no table", remedy="begin with a row of titles")
    titles = [title.strip() for title in numbered[0][1]]
    for line, row in numbered[1:]:
        if len(row) != len(titles):
            raise DataError(file, f"has {len(row)} entries, not {len(titles)}", line=line)
    columns = [
        [
            row[k] if title in ignore else _number(file, line, title, row[k])
            for line, row in numbered[1:]
        ]
        for k, title in enumerate(titles)
    ]
    index = pd.Index([line for line, _ in numbered[1:]], name="line", dtype="int64")
    frame = pd.concat([pd.Series(c, index=index, dtype=object) for c in columns], axis=1)
    frame.columns = pd.Index(titles)
    frame.attrs = {key.strip(): text.strip() for key, colon, text in notes if colon}
    return frame


def _number(file: Path, line: int, title: str, text: str) -> float:
    try:
        return float(text) if text.strip() else float("nan")
    except ValueError as error:
        raise DataError(file, "is no number", line=line, column=title, value=text) from error
