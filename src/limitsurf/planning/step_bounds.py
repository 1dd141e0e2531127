r"""Bounds of a step function on a real array: interval arithmetic for orientations.

The squeeze function is monotone, so errors turn it into two monotone step functions, a lower and an
upper bound. A part near an unstable orientation may go either way or stay, so the upper bound
steps up before it and the lower one after it; a part may rest anywhere in the cell about a stable
orientation, so the steps' images are the two ends of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.planning.moment_ratio import MomentRatio, Zones
from limitsurf.planning.squeeze_function import SqueezeFunction

__all__ = ["StepBounds", "exact_bounds", "step_bounds"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StepBounds:
    """Where a step may leave orientations, relative to the line.

    Attributes
    ----------
    bands : (k, 2) float
        Before each step, the orientations from which the part may go either way or stay [rad].
    rests : (k, 2) float
        Where a part may be after each step [rad].
    modulus : float
        Orientations count modulo this [rad].
    lost : (k,) bool
        Steps that have no stable orientation of their own left.
    """

    bands: Array
    rests: Array
    modulus: float
    lost: NDArray[np.bool_]

    def reach(self, intervals: Array) -> Array:
        """Return hulls (n, 2) of where parts may be that started in intervals (n, 2) [rad]."""
        if self.lost.all():
            return np.column_stack([intervals[:, 0], intervals[:, 0] + self.modulus])
        shift = self.modulus * np.floor(intervals[:, :1] / self.modulus)
        low, high = (intervals - shift).T
        turns = self.modulus * np.repeat(np.arange(-2, 3), len(self.bands))[:, None]
        bands, rests = (np.tile(x, (5, 1)) + turns for x in (self.bands, self.rests))
        up = np.minimum.accumulate(bands[::-1, 0])[::-1]
        down = np.maximum.accumulate(bands[:, 1])
        lowest = rests[np.searchsorted(down, low, side="left") - 1, 0]
        highest = rests[np.searchsorted(up, high, side="right") - 1, 1]
        found = shift + np.column_stack([lowest, highest])
        found[:, 1] = np.minimum(found[:, 1], found[:, 0] + self.modulus)
        return np.asarray(found)


def exact_bounds(squeeze: SqueezeFunction) -> StepBounds:
    """Return the bounds of a step without errors: the step function itself."""
    before = np.append(squeeze.ends[-1] - squeeze.modulus, squeeze.ends[:-1])
    return StepBounds(
        np.column_stack([before, squeeze.breaks]),
        np.column_stack([squeeze.images, squeeze.images]),
        squeeze.modulus,
        np.zeros(len(squeeze.breaks), dtype=bool),
    )


def step_bounds(
    squeeze: SqueezeFunction, ratio: MomentRatio, tangent: float, width: float
) -> StepBounds:
    """Return bounds of a step with a direction and a moment that are off.

    Parameters
    ----------
    squeeze : SqueezeFunction
        The step without errors.
    ratio : MomentRatio
        Of the part.
    tangent, width : float
        Tangent of the direction error, and half-width of the ratio U'/U [1].

    Notes
    -----
    A break that is no unstable orientation, as of parts that start off the line, is assumed to move
    as far as the unstable orientation between the images on its two sides.
    """
    zones, exact = ratio.zones(tangent, width), exact_bounds(squeeze)
    if not zones.has_unstable:
        return _nothing_known(squeeze)
    bands, rests = exact.bands.copy(), np.full_like(exact.rests, np.nan)
    previous = np.append(squeeze.images[-1] - squeeze.modulus, squeeze.images[:-1])
    for i, (before, image) in enumerate(zip(previous, squeeze.images, strict=True)):
        bands[i] += _shift(zones, _between(ratio.turn.unstable, before, image))
        rests[i] = _rest(zones, ratio.turn.unstable, image)
    lost = np.isnan(rests[:, 0])
    if lost.all():
        return _nothing_known(squeeze)
    return StepBounds(bands, _filled(rests, squeeze.modulus), squeeze.modulus, lost)


def _nothing_known(squeeze: SqueezeFunction) -> StepBounds:
    """Return the bounds of a step that may leave a part anywhere: it spins, or does not move."""
    half = 0.5 * squeeze.modulus
    around = squeeze.images[:, None] + np.array([-half, half])
    return StepBounds(around, around, squeeze.modulus, np.ones(len(around), dtype=bool))


def _between(unstable: Array, left: float, right: float) -> Array:
    """Return the unstable orientations between two stable ones, not reduced."""
    turns = np.arange(np.floor(left / np.pi) - 1, np.floor(right / np.pi) + 2)
    lifted = np.sort((unstable + np.pi * turns[:, None]).ravel())
    return np.asarray(lifted[(lifted > left) & (lifted < right)])


def _shift(zones: Zones, unstable: Array) -> tuple[float, float]:
    """Return how far unstable cells reach from the unstable orientations, down and up."""
    cells = np.array([zones.source_of(float(u)) for u in unstable]) - unstable[:, None]
    return float(cells[:, 0].min()), float(cells[:, 1].max())


def _rest(zones: Zones, unstable: Array, image: float) -> tuple[float, float]:
    """Return where a part may rest about a stable orientation; NaN if that is lost."""
    around = _between(unstable, image - np.pi - 1e-9, image + np.pi + 1e-9)
    i = int(np.searchsorted(around, image))
    left, right = zones.source_of(float(around[i - 1])), zones.source_of(float(around[i]))
    return zones.rest_between(left[1], right[0]) or (np.nan, np.nan)


def _filled(rests: Array, modulus: float) -> Array:
    """Give a lost step what its neighbours have: the lower end of one, the upper of the other."""
    full, k = rests.copy(), len(rests)
    for i in range(2 * k):  # twice around, for the first and the last
        if np.isnan(full[i % k, 0]):
            full[i % k, 0] = full[(i - 1) % k, 0] - (modulus if i % k == 0 else 0.0)
        j = k - 1 - i % k
        if np.isnan(full[j, 1]):
            full[j, 1] = full[(j + 1) % k, 1] + (modulus if j == k - 1 else 0.0)
    return full
