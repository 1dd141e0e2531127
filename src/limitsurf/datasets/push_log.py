"""Logs of pushes, as Zhou, Paolini, Bagnell and Mason wrote them: white-space separated numbers.

First the number of pushes. Then for each: the pose before and after, ``x y z [mm] qw qx qy qz``; n
and n rows ``t fx fy`` [s, N]; m and m rows of a time and a pose of the fingertip.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from limitsurf.datasets.recorded_push import RecordedPush
from limitsurf.errors import DataError
from limitsurf.sets.arguments import as_array

__all__ = ["read_push_log"]

Array = NDArray[np.float64]

_MM = 1e-3
_UNIT = 1e-2  # how far from 1 the norm of a quaternion with three digits may be


def read_push_log(path: str | Path, reference: ArrayLike = (0.0, 0.0)) -> tuple[RecordedPush, ...]:
    """Return the pushes of a log, in SI units.

    Parameters
    ----------
    path : str or Path
        The log.
    reference : (2,) float
        The part's reference point, seen from the point whose poses were recorded [m].

    Raises
    ------
    DataError
        No such file, something that is no number, counts that do not fit, times that run backwards,
        quaternions that are none; says in which line and push.
    """
    file, point = Path(path), as_array("reference", reference, 2)
    try:
        log = _Log(file, file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(file, f"cannot be read: {error}", remedy="check the path") from error
    count = log.count("pushes")
    pushes = tuple(_push(log, f"push {k}", point) for k in range(count))
    if log.at < len(log.numbers):
        raise log.wrong(f"goes on after push {count - 1}")
    return pushes


@dataclass
class _Log:
    """The numbers of a log, read one block after the other."""

    file: Path
    text: str
    at: int = 0
    numbers: Array = field(init=False)

    def __post_init__(self) -> None:
        words = self.text.split()
        try:
            self.numbers = np.array(words, dtype=np.float64)
            bad = int(np.argmin(np.isfinite(self.numbers))) if len(words) else 0
        except ValueError:
            bad = next(k for k, word in enumerate(words) if not _is_number(word))
            self.numbers = np.full(len(words), np.nan)
        if not words:
            raise DataError(self.file, "is empty")
        if not np.isfinite(self.numbers[bad]):
            self.at = bad
            raise self.wrong("is no finite number", value=words[bad])

    def count(self, what: str) -> int:
        number = float(self.take(1, f"the number of {what}")[0])
        if number < 1.0 or number != int(number):
            self.at -= 1
            raise self.wrong(f"has no whole number of {what}", value=number)
        return int(number)

    def rows(self, width: int, what: str) -> Array:
        """Return rows after their count; their times, in the first column, must not fall."""
        n = self.count(what)
        table = self.take(n * width, what).reshape(n, width)
        falls = np.flatnonzero(np.diff(table[:, 0]) < 0.0)
        if len(falls):
            self.at -= (n - 1 - int(falls[0])) * width
            raise self.wrong(f"time runs backwards among the {what}")
        return table

    def poses(self, rows: Array, what: str) -> Array:
        """Return poses ``x, y, theta`` [mm, mm, rad] of the last rows ``... x y z qw qx qy qz``."""
        table = rows[:, -7:]
        sizes = np.linalg.norm(table[:, 3:], axis=1)
        off = np.flatnonzero(np.abs(sizes - 1.0) > _UNIT)
        if len(off):
            self.at -= (len(rows) - int(off[0])) * rows.shape[1]
            value = float(sizes[off[0]])
            raise self.wrong(f"has a quaternion of another norm than 1 in {what}", value=value)
        angle = np.unwrap(2.0 * np.arctan2(table[:, 6], table[:, 3]))
        return np.column_stack([table[:, :2], angle])

    def take(self, n: int, what: str) -> Array:
        if self.at + n > len(self.numbers):
            self.at = len(self.numbers) - 1
            raise self.wrong(f"ends within {what}")
        self.at += n
        return self.numbers[self.at - n : self.at]

    def wrong(self, problem: str, value: object = None) -> DataError:
        """Return an error at the line of the number that comes next."""
        words = np.cumsum([len(line.split()) for line in self.text.splitlines()])
        line = int(np.searchsorted(words, self.at, side="right")) + 1
        return DataError(self.file, problem, line=min(line, len(words)), value=value)


def _push(log: _Log, name: str, reference: Array) -> RecordedPush:
    ends = log.take(14, f"the poses of {name}").reshape(2, 7)
    log.poses(ends, f"the poses of {name}")
    forces = log.rows(3, f"forces of {name}")
    tips = log.rows(8, f"tip poses of {name}")
    tip = log.poses(tips, f"the tip poses of {name}") * [_MM, _MM, 1.0]
    before, after = (_reference_pose(row, reference) for row in ends)
    after[2] = before[2] + np.angle(np.exp(1j * (after[2] - before[2])))
    start = forces[0, 0]
    times = forces[:, 0] - start, tips[:, 0] - start
    push = RecordedPush(before, after, times[0], forces[:, 1:], times[1], tip)
    if not push.averaged.any():
        raise log.wrong(f"is after {name}, which has no force worth averaging")
    return push


def _reference_pose(row: Array, reference: Array) -> Array:
    """Return the reference point's pose; the part's tilt counts for its place."""
    turn = Rotation.from_quat([*row[4:], row[3]]).as_matrix()[:2, :2]
    place = _MM * row[:2] + turn @ reference
    return np.array([*place, 2.0 * np.arctan2(row[6], row[3])])


def _is_number(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False
