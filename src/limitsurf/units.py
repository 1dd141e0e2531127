"""Quantities with units at the edges of the library; inside it everything is an SI float."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from limitsurf.errors import InputError

__all__ = ["parse_quantity", "unit_scale"]


@cache
def _registry() -> Any:
    import pint  # builds a large table: only when a unit is first read

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def parse_quantity(value: str | float, unit: str, *, name: str = "value") -> float:
    """Return `value` as a float in `unit`.

    Parameters
    ----------
    value : str or float
        Text such as ``"80 g/m^2"``, or a number that is already in `unit`.
    unit : str
        Target unit, SI; ``""`` for a pure number.
    name : str
        Name of the argument, for the error.

    Raises
    ------
    InputError
        Unknown unit, wrong dimension, missing unit, or not a finite number.

    Examples
    --------
    >>> parse_quantity("80 g/m^2", "kg/m^2")
    0.08
    """
    if isinstance(value, str):
        number = _parse_text(value, unit, name)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value)
    else:
        raise InputError(name, "is no quantity", value=value, remedy=_example(unit))
    if not math.isfinite(number):
        raise InputError(name, "must be a finite number", value=value, remedy=_example(unit))
    return number


def unit_scale(unit: str, *, name: str = "unit") -> float:
    """Return the length in metres of one `unit` (``"mm"``, or a length such as ``"1.2 mm"``)."""
    text = str(unit).strip()
    scale = parse_quantity(text if text[:1].isdigit() else f"1 {text}", "m", name=name)
    if scale <= 0.0:
        raise InputError(name, "must be a positive length", value=unit, remedy="such as mm")
    return scale


def _parse_text(text: str, unit: str, name: str) -> float:
    import pint

    try:
        quantity = _registry().Quantity(text)
        if quantity.unitless and unit:
            raise InputError(name, "has no unit", value=text, remedy=_example(unit))
        return float(quantity.to(unit or "dimensionless").magnitude)
    except pint.UndefinedUnitError as error:
        raise InputError(
            name, f"unknown unit: {error}", value=text, remedy=_example(unit)
        ) from error
    except pint.DimensionalityError as error:
        raise InputError(
            name, f"is not in a unit of [{unit or '1'}]", value=text, remedy=_example(unit)
        ) from error
    except InputError:
        raise
    except Exception as error:  # pint raises token errors of several kinds on garbled text
        raise InputError(name, "is no quantity", value=text, remedy=_example(unit)) from error


def _example(unit: str) -> str:
    samples = {"m": "50 um", "kg/m^2": "80 g/m^2", "V": "50 V", "N": "2.8e-7 N", "Pa*s": "18 uPa*s"}
    return f"write it like '{samples.get(unit, f'1.5 {unit}'.strip())}'"
