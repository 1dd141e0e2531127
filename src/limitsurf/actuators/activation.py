"""Which actuators of an array run: activations, and the one that squeezes towards a line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_number

__all__ = ["Activation", "direction_error", "squeeze_activation"]

Method = Literal["dither", "nearest"]

# Fractional parts of i a1 + j a2 fill [0, 1) evenly over any block of pixels: the additive
# recurrence of the plastic number p (p^3 = p + 1), a1 = 1/p, a2 = 1/p^2 (M. Roberts, 2018).
_PLASTIC = 1.324717957244746
_DITHER = (1 / _PLASTIC, 1 / _PLASTIC**2)


@dataclass(frozen=True, eq=False)
class Activation:
    """A choice of running actuators.

    Attributes
    ----------
    array : ActuatorArray
        The array.
    active : (R, C) bool
        True at the sites that are switched on; see `running`.
    line : float or None
        World angle of the line that the activation squeezes towards [rad], if any.
    """

    array: ActuatorArray
    active: NDArray[np.bool_]
    line: float | None = None

    def __post_init__(self) -> None:
        """Check the shape against the array."""
        expected = self.array.site_directions.shape[:2]
        if self.active.shape != expected or self.active.dtype != np.bool_:
            raise InputError("active", f"must be bool of shape {expected}", value=self.active.shape)

    @property
    def running(self) -> NDArray[np.bool_]:
        """Which actuators run, (R, C): those that are active and not dead."""
        return self.active if self.array.spread is None else self.active & self.array.alive

    def __repr__(self) -> str:
        """Return the number of running actuators."""
        line = "" if self.line is None else f", line at {np.degrees(self.line):.2f} deg"
        return f"Activation({int(self.active.sum())} of {self.active.size} actuators{line})"


def squeeze_activation(
    array: ActuatorArray, line: float, *, method: Method = "dither"
) -> Activation:
    r"""Return the activation that squeezes towards a line through the array's centre.

    One actuator runs in each pixel, in one of the two axis directions towards the line; none if
    that one is dead.

    Parameters
    ----------
    array : ActuatorArray
        The array.
    line : float
        World angle of the line [rad].
    method : {"dither", "nearest"}
        ``"dither"`` mixes the two directions in the ratio ``|cos| : |sin|`` of the normal by a
        fixed low-discrepancy pattern, so that the mean force is normal to the line.
        ``"nearest"`` always takes the axis nearest to the normal: off by up to 45 degrees, and
        the part may spin.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> squeeze_activation(load_array("resonator32"), 0.5)
    Activation(1024 of 4096 actuators, line at 28.65 deg)
    """
    if not np.isfinite(as_number("line", line)):
        raise InputError("line", "must be a finite angle", value=line)
    if method not in ("dither", "nearest"):
        raise InputError("method", "is unknown", value=method, remedy="use dither or nearest")
    wanted = _pixel_directions(array, line, method).repeat(2, axis=0).repeat(2, axis=1)
    active: NDArray[np.bool_] = np.sum(wanted * array.nominal_directions, axis=-1) > 0.5
    return Activation(array, active & array.alive, float(line))


def _pixel_directions(array: ActuatorArray, line: float, method: Method) -> NDArray[np.float64]:
    """Return the axis direction (rows, columns, 2) in which each pixel pushes."""
    normal = np.array([-np.sin(line), np.cos(line)])
    normal[np.abs(normal) < 1e-12] = 0.0
    towards = -_sides(array, line)[..., None] * normal
    share = np.abs(normal[0]) / np.abs(normal).sum()  # of the pixels that push along x
    if method == "nearest":
        threshold = np.full((array.rows, array.columns), 0.5)
    else:
        i, j = np.indices((array.rows, array.columns))
        threshold = np.mod(0.5 + _DITHER[0] * j + _DITHER[1] * i, 1.0)
    along_x = threshold < share
    axis = np.where(along_x[..., None], [1.0, 0.0], [0.0, 1.0])
    return np.asarray(axis * np.sign(towards))


def _sides(array: ActuatorArray, line: float) -> NDArray[np.float64]:
    """Return 1 for pixels on the left of the line, -1 on the right.

    Pixels whose centre lies on the line take sides in turn along it: by rounding, half of the
    line could push one way and half the other, which turns a part by several degrees.
    """
    centers = array.pixel_centers
    offset = np.cos(line) * centers[..., 1] - np.sin(line) * centers[..., 0]
    along = np.cos(line) * centers[..., 0] + np.sin(line) * centers[..., 1]
    sides = np.asarray(np.sign(offset))
    on_line = np.abs(offset) < 1e-9 * array.pixel.pitch
    rank = np.argsort(np.argsort(along[on_line]))
    sides[on_line] = np.where(rank % 2 == 0, 1.0, -1.0)
    return sides


def direction_error(activation: Activation) -> float:
    """Return the angle [rad] between the mean push on either side of the line and its normal."""
    array, line = activation.array, activation.line
    if line is None:
        raise InputError("activation", "has no line", remedy="use squeeze_activation")
    normal = np.array([-np.sin(line), np.cos(line)])
    side = np.kron(_sides(array, line), np.ones((2, 2)))
    errors = []
    for sign in (-1.0, 1.0):
        push = array.site_directions[activation.active & (side == sign)].sum(axis=0)
        cosine, sine = -sign * push @ normal, push[0] * normal[1] - push[1] * normal[0]
        errors.append(abs(np.arctan2(sine, cosine)) if push.any() else 0.0)
        errors[-1] = min(errors[-1], np.pi - errors[-1])
    return float(max(errors))
