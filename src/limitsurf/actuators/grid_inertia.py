"""Moment of inertia of a resonator's grid and poles about its rods."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["grid_inertia", "pole_sides"]


def pole_sides(poles: str) -> tuple[bool, bool]:
    """Return whether the +x and the -x side have poles."""
    return poles in ("+x", "both"), poles in ("-x", "both")


def grid_inertia(p: Mapping[str, Any], poles: str) -> Any:
    """Return the inertia [kg m^2]; the numbers in `p` may be arrays.

    The grid counts as a plate of the solid fraction ``1 - (1 - beam_width/beam_pitch)^2``, the
    poles as columns on the edges. The rods' own inertia, some 1e-4 of it, is left out.

    Parameters
    ----------
    p : mapping
        Fields of `TorsionalResonator` by name [SI].
    poles : {"+x", "-x", "both", "none"}
        Sides that have poles.

    Examples
    --------
    A solid plate of unit density, with the rods along its edge, has ``m a^2 / 3``:

    >>> unit = dict.fromkeys(("grid_width", "grid_length", "beam_width", "beam_pitch"), 1.0)
    >>> thin = {"beam_height": 1e-9, "density": 1e9, "rod_offset": 0.5, "pole_height": 0.0}
    >>> round(grid_inertia({**unit, **thin, "pole_section": 0.0}, "none"), 9)
    0.333333333
    """
    filled = 1.0 - (1.0 - p["beam_width"] / p["beam_pitch"]) ** 2
    mass = p["density"] * p["beam_height"] * filled * p["grid_width"] * p["grid_length"]
    grid = mass * ((p["grid_width"] ** 2 + p["beam_height"] ** 2) / 12 + p["rod_offset"] ** 2)
    pole = p["density"] * p["pole_section"] * p["pole_height"]
    up = 0.5 * (p["beam_height"] + p["pole_height"])
    own = p["pole_height"] ** 2 / 12 + up**2
    right, left = pole_sides(poles)
    half = 0.5 * p["grid_width"]
    for present, lever in ((right, half - p["rod_offset"]), (left, half + p["rod_offset"])):
        grid = grid + present * pole * (lever**2 + own)
    return grid
