"""Lines to squeeze a part towards, one after the other, and where they leave it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.sets.arguments import as_numbers

__all__ = ["LinePlan"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class LinePlan:
    """Lines to squeeze towards, one after the other, whatever the first orientation.

    Attributes
    ----------
    lines : (k,) float
        World angles of the lines, in [0, modulus) of the step function [rad].
    margins : (k,) float
        Error of the line's angle, relative to the orientations before it, that each step
        tolerates, while all other steps may err by the least margin [rad]; the first step
        tolerates any (infinity).
    final : float
        Orientation at the end, in [0, period) [rad].
    period : float
        The end orientation is known modulo this [rad].
    squeeze : SqueezeFunction
        What each step does to an orientation.
    """

    lines: Array
    margins: Array
    final: float
    period: float
    squeeze: SqueezeFunction

    def predict(self, phi: ArrayLike) -> Array:
        """Return the orientation, reduced, where the plan leaves a part that starts at phi."""
        orientation = as_numbers("phi", phi)
        for line in self.lines:
            orientation = self.squeeze(orientation - line) + line
        return np.mod(orientation, self.squeeze.modulus)

    @property
    def least_margin(self) -> float:
        """Smallest of the margins [rad]; infinity for a plan of one step."""
        return float(self.margins.min())

    def __repr__(self) -> str:
        """Return lines and least margin in degrees."""
        lines = ", ".join(f"{angle:.2f}" for angle in np.degrees(self.lines))
        margin = f"{np.degrees(self.least_margin):.2f} deg" if len(self.lines) > 1 else "any"
        return f"{type(self).__name__}(lines at {lines} deg, margin {margin})"
