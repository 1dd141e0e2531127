"""Drives that change at given times: activations of an array, gaits of a walker."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, TypeVar

import numpy as np

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_number

__all__ = ["Schedule"]

Drive = TypeVar("Drive")

_MOST = 1e6  # pieces


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
        object.__setattr__(self, "entries", _pairs(entries))
        object.__setattr__(self, "period", None if period is None else as_number("period", period))
        times = [t for t, _ in self.entries]
        if not times:
            raise InputError("schedule", "has no entries", remedy="give pairs (time, drive)")
        if times[0] != 0.0 or not np.isfinite(times).all():
            raise InputError("schedule", "must start at 0 s with finite times", value=times)
        for before, after in pairwise([*times, *([] if self.period is None else [self.period])]):
            if not before < after:
                raise InputError(
                    "schedule",
                    f"goes back in time from {before:g} s to {after:g} s",
                    remedy="sort the entries; the period comes after the last",
                )

    def at(self, time: float) -> Drive:
        """Return the drive at a time [s]."""
        t = _checked("time", time)
        cycle = self._cycle(t)
        return [drive for begin, drive in self.entries if self._shift(cycle) + begin <= t][-1]

    def _shift(self, cycle: int) -> float:
        return 0.0 if self.period is None else cycle * self.period

    def _cycle(self, time: float) -> int:
        """Return the period that a time lies in, by the rounded times at which they begin."""
        if self.period is None:
            return 0
        cycle = int(time // self.period)
        while self._shift(cycle) > time:
            cycle -= 1
        while self._shift(cycle + 1) <= time:
            cycle += 1
        return cycle

    def pieces(self, duration: float) -> list[tuple[float, float, Drive]]:
        """Return ``(begin, end, drive)`` up to a time [s].

        Raises
        ------
        InputError
            A time that is negative or not finite; more than a million pieces.

        Examples
        --------
        >>> Schedule([(0.0, "a"), (1.0, "b")]).pieces(1.0)
        [(0.0, 1.0, 'a')]
        """
        limit = _checked("duration", duration)
        if self.period is not None and limit / self.period * len(self.entries) > _MOST:
            raise InputError("period", "is too short", value=self.period, remedy="raise it")
        begins = [
            (self._shift(cycle) + t, drive)
            for cycle in range(self._cycle(limit) + 1)
            for t, drive in self.entries
            if self._shift(cycle) + t < limit
        ]
        ends = [*(t for t, _ in begins), limit][1:]
        return [(begin, end, drive) for (begin, drive), end in zip(begins, ends, strict=True)]

    def __repr__(self) -> str:
        """Return number of entries and the period."""
        again = "" if self.period is None else f", repeating every {self.period:g} s"
        return f"Schedule({len(self.entries)} entries{again})"


def _pairs(entries: Iterable[tuple[float, Drive]]) -> tuple[tuple[float, Drive], ...]:
    """Return the entries of a schedule, their times as numbers."""
    try:
        pairs = [(t, drive) for t, drive in entries]
    except (TypeError, ValueError) as error:
        raise InputError("schedule", "has no pairs", remedy="give pairs (time, drive)") from error
    return tuple((as_number("schedule", t), drive) for t, drive in pairs)


def _checked(name: str, time: float) -> float:
    number = as_number(name, time)
    if not (np.isfinite(number) and number >= 0.0):
        raise InputError(name, "must be finite and at least 0 s", value=time)
    return number
