"""One piece of a force density: linear on a convex region."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_number

__all__ = ["DensityPiece", "finite"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DensityPiece:
    """A force density ``force + slope (x - anchor)`` on the region ``normals x <= bounds``.

    Attributes
    ----------
    force : (2,) float
        Density at the anchor [N/m^2].
    slope : (2, 2) float, optional
        Its derivative [N/m^3]; zero by default.
    anchor : (2,) float, optional
        Where the density is `force` [m]; the origin by default.
    normals, bounds : (h, 2) and (h,) float, optional
        Half-planes, any lengths of the normals; the whole plane by default.
    level : float, optional
        Potential at the anchor [N/m], if the field has one: it must be continuous across borders.
    """

    force: Array
    slope: Array
    anchor: Array
    normals: Array
    bounds: Array
    level: float | None

    def __init__(
        self,
        force: ArrayLike,
        slope: ArrayLike = ((0.0, 0.0), (0.0, 0.0)),
        anchor: ArrayLike = (0.0, 0.0),
        normals: ArrayLike = (),
        bounds: ArrayLike = (),
        level: float | None = None,
    ) -> None:
        ways = as_array("normals", normals, None, 2)
        length = np.hypot(*ways.T)
        if not (length > 0.0).all():
            raise InputError("normals", "has rows of zeros", remedy="leave these half-planes out")
        object.__setattr__(self, "force", as_array("force", force, 2))
        object.__setattr__(self, "slope", as_array("slope", slope, 2, 2))
        object.__setattr__(self, "anchor", as_array("anchor", anchor, 2))
        object.__setattr__(self, "normals", ways / length[:, None])
        object.__setattr__(self, "bounds", as_array("bounds", bounds, len(ways)) / length)
        object.__setattr__(self, "level", None if level is None else finite("level", level))
        if level is not None and self.slope[0, 1] != self.slope[1, 0]:
            raise InputError("level", "needs a symmetric slope", remedy="leave out the level")


def finite(name: str, value: float) -> float:
    """Return a finite number, or raise."""
    number = as_number(name, value)
    if not np.isfinite(number):
        raise InputError(name, "must be finite", value=value)
    return number
