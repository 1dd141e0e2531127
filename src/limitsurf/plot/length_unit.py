"""The unit of length that suits the size of what is drawn."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["LengthUnit", "length_unit"]


class LengthUnit(NamedTuple):
    """A unit's name, and how many of it make a metre."""

    name: str
    scale: float


def length_unit(size: float) -> LengthUnit:
    """Return um below a tenth of a millimetre, mm below a metre, and m from there on.

    Examples
    --------
    >>> length_unit(3e-3).name, length_unit(1e-6).name, length_unit(1e3).name
    ('mm', 'um', 'm')
    """
    if size < 1e-4:
        return LengthUnit("um", 1e6)
    return LengthUnit("mm", 1e3) if size < 1.0 else LengthUnit("m", 1.0)
