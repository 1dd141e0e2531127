"""Waveforms over one period: samples that are joined linearly, or functions that are sampled."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError

__all__ = ["Waveform", "read_waveforms"]

Array = NDArray[np.float64]
Waveform = ArrayLike | Callable[[Array], ArrayLike]

_PERIODIC = 1e-9  # relative: sines of large phases lose a few digits


def read_waveforms(
    tip_velocity: Waveform, normal_force: Waveform, samples: int
) -> tuple[Array, Array, tuple[float, float]]:
    """Return velocities and normal forces (..., K), and how far samples miss given functions.

    The last is the largest difference of each halfway between samples, 0 for given samples.
    """
    if not isinstance(samples, Integral) or samples < 2:
        raise InputError("samples", "must be a whole number from 2 on", value=samples)
    w = _sampled("tip_velocity", tip_velocity, _count(normal_force, samples))
    N = _sampled("normal_force", normal_force, w.shape[-1])
    if N.ndim == 0:
        N = np.full(w.shape[-1], float(N))
    if w.shape[-1] != N.shape[-1]:
        raise InputError(
            "normal_force",
            f"has {N.shape[-1]} samples, tip_velocity {w.shape[-1]}",
            remedy="give both at the same times",
        )
    if (N < 0.0).any():
        raise InputError(
            "normal_force",
            "is negative in part of the period",
            value=float(N.min()),
            remedy="a tip cannot pull: set it to 0 while the tip is off",
        )
    return w, N, (_miss(tip_velocity, w), _miss(normal_force, N))


def _count(given: Waveform, samples: int) -> int:
    """Return the samples K of a given array; the wanted number for functions and constants."""
    return samples if callable(given) or np.ndim(given) == 0 else np.shape(given)[-1]


def _sampled(name: str, given: Waveform, count: int) -> Array:
    if not callable(given):
        values = _numbers(name, given)
        if values.ndim == 0 and name == "tip_velocity":
            values = np.full(count, float(values))
        if values.shape[-1:] == (0,):
            raise InputError(name, "has no samples", remedy="give at least one a period")
        return values
    phase = np.arange(count) / count
    values, later = _numbers(name, given(phase)), _numbers(name, given(phase + 1.0))
    if values.shape[-1:] != (count,):
        raise InputError(
            name,
            f"returns shape {values.shape} for {count} phases",
            remedy="return one value a phase, along the last axis",
        )
    gap = float(np.abs(later - values).max())
    if gap > _PERIODIC * max(float(np.abs(values).max()), float(np.abs(later).max())):
        raise InputError(
            name,
            f"is not periodic: it changes by {gap:.3g} from one period to the next",
            remedy="it is called with t/T, and must repeat when that rises by 1",
        )
    return values


def _numbers(name: str, given: Any) -> Array:
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, "is no array of numbers", remedy="check its entries") from error
    if not np.isfinite(values).all():
        raise InputError(name, "has entries that are not finite", remedy="remove NaN and inf")
    return values


def _miss(given: Waveform, values: Array) -> float:
    if not callable(given):
        return 0.0
    count = values.shape[-1]
    halfway = 0.5 * (values + np.roll(values, -1, axis=-1))
    exact = np.asarray(given((np.arange(count) + 0.5) / count), dtype=np.float64)
    return float(np.abs(exact - halfway).max())
