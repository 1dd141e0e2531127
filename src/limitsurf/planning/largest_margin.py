"""The largest margin for which a plan exists, exactly."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

__all__ = ["with_largest_gap"]

P = TypeVar("P")


def with_largest_gap(
    plan: P,
    gap_of: Callable[[P], float],
    search: Callable[[float], tuple[P | None, float]],
    most: float,
) -> P:
    """Return the plan with the largest gap that `search` can find.

    Bisection, but every plan found lifts the lower end to its own gap, which is one of finitely
    many numbers, and the last search asks for the next float after it: the end is exact.

    Parameters
    ----------
    plan : P
        A plan to begin with.
    gap_of : callable
        Gap of a plan.
    search : callable
        Returns a plan with at least a given gap, or None, and the largest smaller gap for which the
        outcome may be another. What it can find for a gap, it can find for any smaller one.
    most : float
        No plan has a larger gap than this, except those with an infinite one.
    """
    low, high = gap_of(plan), most
    while low < high:
        better, high_if_none = search(max(float(np.nextafter(low, np.inf)), 0.5 * (low + high)))
        if better is None:
            high = high_if_none
        else:
            plan, low = better, gap_of(better)
    return plan
