r"""How far the field that an array makes for one line is from the squeeze field that was planned.

All errors but the direction are moments over the potential U of the part: tangents of the error of
direction that would do the same, so that they add up and compare; see `moment_ratio`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from limitsurf.actuators.activation import Activation, Method, squeeze_activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.contacts.lattice_contacts import LatticeContacts
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.starts import check_room
from limitsurf.planning.moment_ratio import MomentRatio
from limitsurf.planning.turn_function import TurnFunction, turn_function
from limitsurf.sets.arguments import as_count, as_number

__all__ = ["FieldErrors"]

Array = NDArray[np.float64]

_UNLUCKY = 4.0  # standard deviations that count as the worst of unknown dead actuators
_ANGLES = 45  # orientations at which the deadband is looked at


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
        poses = _poses(turn, line, array.pixel.pitch, reach, as_count("samples", samples))
        sums = _sums(squeeze_activation(same, line, method=method), part, poses)
        ratio, tangent = sums[:, 0] / sums[:, 1], sums[:, 2].sum() / sums[:, 1].sum()
        off = MomentRatio(turn)(poses[:, 0]) - tangent - ratio
        share = np.mean(sums[:, 1] / sums[:, 4] * part.area / turn.potential(poses[:, 0]))
        other = np.zeros(len(poses))
        if array.spread is not None:
            real = _sums(squeeze_activation(array, line, method=method), part, poses)
            other = real[:, 0] / real[:, 1] - ratio
        variance = dead / (1.0 - dead) * sums[:, 3] / sums[:, 1] ** 2
        grip = array.pixel.residual_fraction / array.pixel.offset_fraction
        return cls(
            direction=float(np.arctan(tangent)),
            pixels=float(np.sqrt(np.mean(off**2))),
            pixels_worst=float(np.abs(off).max()),
            deadband=float(grip / share * _held(turn)) if grip > 0.0 else 0.0,
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


def _poses(turn: TurnFunction, line: float, pitch: float, reach: float, samples: int) -> Array:
    """Return rows ``phi, x, y, theta, px, py``: poses, and the middle of the median chord there."""
    part = turn.part
    rests = np.concatenate([turn.stable, turn.unstable])
    unit = 2.0 * qmc.Halton(3, scramble=False).random(samples * len(rests) + 1)[1:] - 1.0
    phi = np.tile(rests, samples) + pitch / part.circumradius * unit[:, 0]
    along, normal = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    middles = np.array([_chord_middle(turn, angle) for angle in phi])
    cosine, sine = np.cos(phi + line), np.sin(phi + line)
    x, y = middles.T
    arm = np.column_stack([cosine * x - sine * y, sine * x + cosine * y])
    offset = -(arm @ normal) + 0.5 * pitch * unit[:, 1]
    place = offset[:, None] * normal + reach * unit[:, 2:] * along
    return np.asarray(np.column_stack([phi, place, phi + line, arm]), dtype=np.float64)


def _chord_middle(turn: TurnFunction, phi: float) -> Array:
    """Return the middle of the median's chords from the centroid, part frame [m]."""
    center = turn.median(float(phi))[1].centroid
    x, y = turn.part.centroid
    return np.array([center.x - x, center.y - y])


def _sums(activation: Activation, part: Part, poses: Array) -> Array:
    """Return rows of sums over running tips, pushes in units of the nominal one.

    Moment about the chord's middle; work against the line, the U of the array; moment that turned
    directions take away; variance of the first without its mean, per dead tip; number of tips.
    """
    line = activation.line
    assert line is not None
    along, normal = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    rows = []
    for (x, y, *_), arm, spots, push in _tips(activation, part, poses):
        s, n, height = push @ along, push @ normal, (spots - arm) @ normal
        moment = (spots - arm) @ along * n - height * s
        work = -(spots + np.array([x, y])) @ normal * n
        moment_sum, work_sum = moment.sum(), work.sum()
        off = moment - moment_sum / work_sum * work
        rows.append([moment_sum, work_sum, (height * s).sum(), (off**2).sum(), len(spots)])
    return np.array(rows)


def _tips(
    activation: Activation, part: Part, poses: Array
) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Yield pose, arm, and positions and pushes of the running tips, for each row of poses."""
    array, running = activation.array, activation.running
    sites = LatticeContacts(part, array.site_pitch, array.first_site, running.shape)
    pushes = array.site_directions
    for row in poses:
        sites.move(row[1:4])
        runs = running[tuple(sites.sites.T)]
        if not runs.any():
            raise InputError("array", "leaves no running actuator under the part")
        yield row[1:4], row[4:6], sites.positions[runs], pushes[tuple(sites.sites[runs].T)]


def _held(turn: TurnFunction) -> float:
    """Return the largest moment of unit friction, turning about the chord's middle, over U."""
    friction = UniformFriction(turn.part, 1.0)
    phi = np.concatenate([np.linspace(0.0, np.pi, _ANGLES), turn.stable, turn.unstable])
    x, y = np.array([_chord_middle(turn, angle) for angle in phi]).T
    moments = friction.support(np.column_stack([y, -x, np.ones_like(x)]))
    return float(np.max(moments / turn.potential(phi)))
