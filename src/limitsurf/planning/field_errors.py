r"""How far the field that an array makes for one line is from the squeeze field that was planned.

All errors but the direction are moments over the potential U of the part: tangents of the error of
direction that would do the same, so that they add up and compare; see `moment_ratio`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Method, squeeze_activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.starts import check_room
from limitsurf.planning.moment_ratio import MomentRatio
from limitsurf.planning.tip_sums import held_moment, poses_near_rest, tip_sums
from limitsurf.planning.turn_function import TurnFunction, turn_function
from limitsurf.sets.arguments import as_count, as_number

__all__ = ["FieldErrors"]

Array = NDArray[np.float64]

_UNLUCKY = 4.0  # standard deviations that count as the worst of unknown dead actuators


@dataclass(frozen=True)
class FieldErrors:
    """Errors of one line's squeeze field, as seen by a part.

    Attributes
    ----------
    direction : float
        Angle by which pushes on both sides are turned from the normal, counter-clockwise [rad].
    pixels, pixels_worst : float
        Moment error of the lattice over U, root mean square and largest [1].
    deadband : float
        Moment that friction of the running tips holds, over U [1].
    spread, spread_worst : float
        Moment error of actuators that are dead or differ, over U, root mean square and largest.

    Examples
    --------
    A direction known to two degrees, either way, and nothing else:

    >>> FieldErrors(pixels=0.0, pixels_worst=np.tan(np.radians(2.0)))
    FieldErrors(direction 0.00 deg, pixels up to 2.00 deg)
    """

    direction: float = 0.0
    pixels: float = 0.0
    pixels_worst: float = 0.0
    deadband: float = 0.0
    spread: float = 0.0
    spread_worst: float = 0.0

    def __post_init__(self) -> None:
        """Check that the numbers are errors."""
        for name, value in vars(self).items():
            number = as_number(name, value)
            if not np.isfinite(number) or (name != "direction" and number < 0.0):
                raise InputError(name, "must be finite and not negative", value=value)
        if not abs(self.direction) < 0.5 * np.pi:
            raise InputError("direction", "must be less than 90 degrees", value=self.direction)

    @property
    def tangent(self) -> float:
        """Tangent of the direction error."""
        return float(np.tan(self.direction))

    @property
    def worst(self) -> float:
        """Half-width of the ratio U'/U if all goes wrong at once [1]."""
        return self.deadband + self.pixels_worst + self.spread_worst

    def likely(self, sigmas: float) -> float:
        """Half-width of the ratio U'/U for so many standard deviations [1]."""
        width = self.deadband + sigmas * float(np.hypot(self.pixels, self.spread))
        return min(width, self.worst)

    @property
    def sources(self) -> dict[str, FieldErrors]:
        """The errors one by one."""
        parts = {
            "direction": {"direction": self.direction},
            "pixels": {"pixels": self.pixels, "pixels_worst": self.pixels_worst},
            "deadband": {"deadband": self.deadband},
            "spread": {"spread": self.spread, "spread_worst": self.spread_worst},
        }
        return {name: FieldErrors(**values) for name, values in parts.items()}

    @classmethod
    def of(
        cls,
        array: ActuatorArray,
        part: Part,
        line: float,
        *,
        method: Method = "dither",
        dead: float = 0.0,
        samples: int = 32,
        start_offset: float | None = None,
        turn: TurnFunction | None = None,
    ) -> FieldErrors:
        """Measure the errors of an array, squeezing a part towards a line.

        The running tips under the part are added up over poses near all equilibria: orientations
        within a pitch at the part's rim, offsets within half a pitch of the median, places along
        the line within the start offset. Moments are taken about the middle of the median chord:
        to first order that leaves what turns the part once it has gone to where no force acts.

        Parameters
        ----------
        array : ActuatorArray
            The array; what its own `spread` does is told apart from what the lattice does.
        part : Part
            The part.
        line : float
            World angle of the line [rad].
        method : {"dither", "nearest"}
            See `squeeze_activation`.
        dead : float
            Share of actuators that fail besides, nobody knows which. The error is that of first
            order; its worst is four standard deviations.
        samples : int
            Poses near each equilibrium; the same ones at every call.
        start_offset : float, optional
            How far along the line the part may be from the centre [m]; half of its circumradius.
        turn : TurnFunction, optional
            That of the part, if it is at hand.

        Raises
        ------
        InputError
            A neutral part, an array without room for it or without push.

        Examples
        --------
        >>> from limitsurf.actuators.actuator_array import load_array
        >>> part, array = Part.from_file("paper_t"), load_array("resonator64")
        >>> errors = FieldErrors.of(array, part, np.pi / 4, method="nearest")
        >>> round(abs(np.degrees(errors.direction)))
        45
        """
        turn = turn_function(part) if turn is None else turn
        if turn.neutral:
            raise InputError("part", "is neutral: squeezing does not turn it", value=part)
        if not 0.0 <= as_number("dead", dead) < 1.0:
            raise InputError("dead", "must be at least 0 and below 1", value=dead)
        if array.pixel.offset_fraction <= 0.0:
            raise InputError("array", "its actuators do not push", remedy="raise offset_fraction")
        reach = 0.5 * part.circumradius if start_offset is None else start_offset
        check_room(part, array, reach)
        same = replace(array, spread=None)
        poses = poses_near_rest(turn, line, array.pixel.pitch, reach, as_count("samples", samples))
        sums = tip_sums(squeeze_activation(same, line, method=method), part, poses)
        ratio, tangent = sums[:, 0] / sums[:, 1], sums[:, 2].sum() / sums[:, 1].sum()
        off = MomentRatio(turn)(poses[:, 0]) - tangent - ratio
        share = np.mean(sums[:, 1] / sums[:, 4] * part.area / turn.potential(poses[:, 0]))
        other = np.zeros(len(poses))
        if array.spread is not None:
            real = tip_sums(squeeze_activation(array, line, method=method), part, poses)
            other = real[:, 0] / real[:, 1] - ratio
        variance = dead / (1.0 - dead) * sums[:, 3] / sums[:, 1] ** 2
        grip = array.pixel.residual_fraction / array.pixel.offset_fraction
        return cls(
            direction=float(np.arctan(tangent)),
            pixels=float(np.sqrt(np.mean(off**2))),
            pixels_worst=float(np.abs(off).max()),
            deadband=float(grip / share * held_moment(turn)) if grip > 0.0 else 0.0,
            spread=float(np.sqrt(np.mean(other**2 + variance))),
            spread_worst=float(np.max(np.abs(other) + _UNLUCKY * np.sqrt(variance))),
        )

    def __repr__(self) -> str:
        """Return the errors in degrees, those that are zero left out."""
        worst = {
            "pixels": self.pixels_worst,
            "deadband": self.deadband,
            "spread": self.spread_worst,
        }
        shown = [f"direction {np.degrees(self.direction) + 0.0:.2f} deg"]
        shown += [
            f"{k} up to {np.degrees(np.arctan(w)):.2f} deg" for k, w in worst.items() if w > 0.0
        ]
        return f"FieldErrors({', '.join(shown)})"
