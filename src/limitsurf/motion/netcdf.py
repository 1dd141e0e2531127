"""NetCDF files of motions: checked before a long run, and written as a whole."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from limitsurf.errors import InputError

if TYPE_CHECKING:
    import xarray

__all__ = ["as_target", "write_netcdf"]


def as_target(path: str | Path | None, name: str = "save") -> Path | None:
    """Return a path at which a file can be written, None for None; errors name the argument.

    Raises
    ------
    InputError
        No path; a folder that is missing or may not be written to; a folder itself.
    """
    if path is None:
        return None
    if not isinstance(path, str | Path):
        raise InputError(name, "is no path", value=path)
    target = Path(path)
    if not target.parent.is_dir():
        raise InputError(name, "lies in no folder", value=str(target), remedy="make it first")
    if target.is_dir() or not os.access(target.parent, os.W_OK):
        raise InputError(name, "cannot be written", value=str(target), remedy="choose a file")
    return target


def write_netcdf(dataset: xarray.Dataset, path: Path) -> None:
    """Write a dataset as a whole: an interrupted write leaves the file before."""
    unfinished = path.with_name(path.name + ".part")
    dataset.to_netcdf(unfinished, engine="scipy")
    unfinished.replace(path)
