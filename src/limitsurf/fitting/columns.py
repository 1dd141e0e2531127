"""Rows of three numbers from arrays, data frames and xarray, with columns found by name."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.units import parse_quantity

__all__ = ["column_names", "named_rows"]

Array = NDArray[np.float64]

_NAMES = {
    "loads": (("fx", "fy", "m"),),
    "twists": (("vx", "vy", "omega"), ("dx", "dy", "dtheta")),
}
_UNITS = {
    "loads": (("N",), ("N",), ("N*m",)),
    "twists": (("m/s", "m"), ("m/s", "m"), ("rad/s", "rad")),
}
_TITLE = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\]]*)\])?\s*")


def named_rows(name: str, value: Any) -> Array:
    """Return `value` as rows (n, 3); rows may hold NaN.

    Parameters
    ----------
    name : {"loads", "twists"}
        What it is.
    value : array_like, data frame, or xarray DataArray or Dataset
        Without names, three columns in the order of the conventions. With names, the columns
        ``fx, fy, m`` of loads, and ``vx, vy, omega`` or ``dx, dy, dtheta`` of twists, in any
        order and among others; a unit may follow in brackets, such as ``m [N mm]``, and is
        converted.

    Raises
    ------
    InputError
        No numbers, other than three columns, names missing, or unknown units.

    Examples
    --------
    >>> import pandas as pd
    >>> frame = pd.DataFrame({"m [N mm]": [50.0], "fx [N]": [1.0], "fy [N]": [2.0]})
    >>> named_rows("loads", frame)
    array([[1.  , 2.  , 0.05]])
    """
    titles = column_names(value)
    found = {_TITLE.fullmatch(t)["name"].lower(): t for t in titles if _TITLE.fullmatch(t)}  # type: ignore[index]
    for names in _NAMES[name]:
        if set(names) <= set(found):
            columns = [_column(value, found[key]) for key in names]
            scales = [_scale(found[key], u) for key, u in zip(names, _UNITS[name], strict=True)]
            return np.asarray(np.column_stack(columns) * np.array(scales))
    if titles and not _plain(value):
        wanted = " or ".join(", ".join(names) for names in _NAMES[name])
        raise InputError(name, f"has columns {', '.join(titles)}", remedy=f"name them {wanted}")
    return _array(name, value)


def column_names(value: Any) -> list[str]:
    """Return the names of the columns of a data frame or xarray object; none of an array."""
    if hasattr(value, "data_vars"):
        return [str(key) for key in value.data_vars]
    if hasattr(value, "columns"):
        titles = list(value.columns)
    elif hasattr(value, "dims") and value.ndim == 2 and value.dims[1] in value.coords:
        titles = list(value.coords[value.dims[1]].values)
    else:
        return []
    return [str(t) for t in titles] if all(isinstance(t, str) for t in titles) else []


def _plain(value: Any) -> bool:
    return not hasattr(value, "data_vars") and getattr(value, "shape", (0, 0))[1] == 3


def _column(value: Any, title: str) -> Array:
    if hasattr(value, "dims") and not hasattr(value, "data_vars"):
        value = value.sel({value.dims[1]: title})
    else:
        value = value[title]
    return np.asarray(value, dtype=np.float64)


def _scale(title: str, units: tuple[str, ...]) -> float:
    """Return how many SI units one unit of a column is."""
    unit = _TITLE.fullmatch(title)["unit"]  # type: ignore[index]
    if unit is None:
        return 1.0
    for target in units[:-1]:
        try:
            return parse_quantity(f"1 {unit}", target, name=title)
        except InputError:
            continue
    return parse_quantity(f"1 {unit}", units[-1], name=title)


def _array(name: str, value: Any) -> Array:
    if hasattr(value, "toarray"):
        raise InputError(name, "is a sparse matrix", remedy="give a dense array")
    array = np.asarray(value)
    if np.iscomplexobj(array):
        raise InputError(name, "Complex data not supported", remedy="give real numbers")
    try:
        rows = array.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, "is no array of numbers", remedy="check its entries") from error
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InputError(
            name, f"has shape {rows.shape}, not (n, 3)", remedy="three columns: Reshape your data"
        )
    return rows
