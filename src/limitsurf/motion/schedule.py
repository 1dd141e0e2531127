"""Drives that change at given times: activations of an array, gaits of a walker."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, TypeVar

import numpy as np

from limitsurf.errors import InputError

__all__ = ["Schedule"]

Drive = TypeVar("Drive")


@dataclass(frozen=True)
class Schedule(Generic[Drive]):
    """Drives, each from its time on.

    Parameters
    ----------
    entries : pairs (time, drive)
        From time [s] on, until the next entry, this drive. Times rise from 0.
    period : float, optional
        The schedule repeats with this period [s]; it must be later than the last entry.

    Raises
    ------
    InputError
        No entries, times that are not finite, that do not start at 0, or that go back.

    Examples
    --------
    >>> gait = Schedule([(0.0, "left"), (0.2, "right")], period=0.5)
    >>> gait.at(0.3), gait.at(0.5)
    ('right', 'left')
    >>> gait.pieces(0.7)
    [(0.0, 0.2, 'left'), (0.2, 0.5, 'right'), (0.5, 0.7, 'left')]
    """

    entries: tuple[tuple[float, Drive], ...]
    period: float | None = None

    def __init__(self, entries: Iterable[tuple[float, Drive]], period: float | None = None) -> None:
        object.__setattr__(self, "entries", tuple((float(t), drive) for t, drive in entries))
        object.__setattr__(self, "period", None if period is None else float(period))
        times = [t for t, _ in self.entries]
        if not times:
            raise InputError("schedule", "has no entries", remedy="give pairs (time, drive)")
        if times[0] != 0.0 or not np.isfinite(times).all():
            raise InputError("schedule", "must start at 0 s with finite times", value=times)
        for before, after in pairwise([*times, *([] if period is None else [float(period)])]):
            if not before < after:
                raise InputError(
                    "schedule",
                    f"goes back in time from {before:g} s to {after:g} s",
                    remedy="sort the entries; the period comes after the last",
                )

    def at(self, time: float) -> Drive:
        """Return the drive at a time [s]."""
        return self.pieces(time, instant=True)[-1][2]

    def pieces(self, duration: float, *, instant: bool = False) -> list[tuple[float, float, Drive]]:
        """Return ``(begin, end, drive)`` up to a time [s]; with `instant` also what begins there.

        Examples
        --------
        >>> Schedule([(0.0, "a"), (1.0, "b")]).pieces(1.0)
        [(0.0, 1.0, 'a')]
        """
        found: list[tuple[float, float, Drive]] = []
        cycle = 0
        while True:
            shift = 0.0 if self.period is None else cycle * self.period
            ends = [shift + t for t, _ in self.entries[1:]]
            ends.append(np.inf if self.period is None else shift + self.period)
            for (t, drive), end in zip(self.entries, ends, strict=True):
                begin = shift + t
                if begin > duration or (begin == duration and not instant):
                    return found
                found.append((begin, min(end, duration), drive))
            if self.period is None:
                return found
            cycle += 1

    def __repr__(self) -> str:
        """Return number of entries and the period."""
        again = "" if self.period is None else f", repeating every {self.period:g} s"
        return f"Schedule({len(self.entries)} entries{again})"
