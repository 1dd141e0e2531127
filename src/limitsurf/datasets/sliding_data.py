"""Pairs of load and motion of a sliding part, with what is known about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.datasets.columns import Motion, Table, read_table, write_table
from limitsurf.datasets.frame_files import read_frame, write_frame
from limitsurf.datasets.plausibility import warn_of_units
from limitsurf.errors import DataError, InputError
from limitsurf.sets.arguments import as_array, as_positive
from limitsurf.units import parse_quantity

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["SlidingData", "read_sliding_data"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class SlidingData:
    """n pairs of a load that makes a part slide and the motion it makes.

    Parameters
    ----------
    loads : (n, 3) float
        Loads ``(fx, fy, m)`` APPLIED to the part, about its reference point [N, N, N m]. What the
        contacts exert on the part is minus that.
    twists : (n, 3) float
        Velocities [m/s, m/s, rad/s] or small displacements [m, m, rad], in the axes of the loads.
    rho : float
        Length that makes moments comparable with forces, such as the radius of gyration [m].
    load_deviations, twist_deviations : (n, 3) or (3,) float, optional
        Standard deviations of the loads and of the twists, in their units.
    motion : {"displacement", "velocity"}
        What the twists are.
    name, source, licence : str
        Where the data come from.

    Raises
    ------
    InputError
        Other shapes, entries that are not finite, negative deviations, no pairs at all.

    Warns
    -----
    ImplausibleUnits
        Moments that do not go with the forces, such as N mm beside N, or angles with ways.

    Examples
    --------
    >>> data = SlidingData([[2, 0, 0], [0, 0, 0.1]], [[3e-3, 0, 0], [0, 0, 0.5]], rho=0.05)
    >>> data
    SlidingData(2 pairs: to 2 N, 0.1 N m and 0.003 m, 0.5 rad; rho 0.05 m)
    >>> len(data.take([0]))
    1
    """

    loads: Array
    twists: Array
    rho: float
    _: KW_ONLY
    load_deviations: Array | None = None
    twist_deviations: Array | None = None
    motion: Motion = "displacement"
    name: str = ""
    source: str = ""
    licence: str = ""

    _NOTES: ClassVar = ("name", "source", "licence")

    def __post_init__(self) -> None:
        """Check all, and make the arrays read-only."""
        loads = as_array("loads", self.loads, None, 3)
        if len(loads) == 0:
            raise InputError("loads", "are none", remedy="give at least one pair")
        twists = as_array("twists", self.twists, len(loads), 3)
        rho = as_positive("rho", self.rho)
        if self.motion not in ("displacement", "velocity"):
            raise InputError("motion", "must be displacement or velocity", value=self.motion)
        for note in self._NOTES:
            if not isinstance(text := getattr(self, note), str) or not text.isprintable():
                raise InputError(note, "must be one line of text", value=text)
        sd_loads = _deviations("load_deviations", self.load_deviations, len(loads))
        sd_twists = _deviations("twist_deviations", self.twist_deviations, len(loads))
        self._set(loads=loads, twists=twists, rho=rho)
        self._set(load_deviations=sd_loads, twist_deviations=sd_twists)
        warn_of_units(loads, twists, rho)

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        """Return n."""
        return len(self.loads)

    def take(self, rows: ArrayLike) -> SlidingData:
        """Return some of the pairs, given by their numbers (k,) or by a mask (n,)."""
        try:
            chosen = np.arange(len(self))[np.asarray(rows)]
        except IndexError as error:
            raise InputError("rows", "do not fit the pairs", remedy=str(error)) from error
        sd_loads, sd_twists = self.load_deviations, self.twist_deviations
        return replace(
            self,
            loads=self.loads[chosen],
            twists=self.twists[chosen],
            load_deviations=None if sd_loads is None else sd_loads[chosen],
            twist_deviations=None if sd_twists is None else sd_twists[chosen],
        )

    def to_frame(self) -> pd.DataFrame:
        """Return a data frame with named columns in SI units; rho and notes in its `attrs`."""
        deviations = self.load_deviations, self.twist_deviations
        frame = write_table(Table(self.loads, self.twists, self.motion, *deviations))
        notes = {note: text for note in self._NOTES if (text := getattr(self, note))}
        frame.attrs = {"rho": f"{self.rho!r} m", **notes}
        return frame

    @classmethod
    def from_frame(
        cls,
        frame: pd.DataFrame,
        rho: str | float | None = None,
        *,
        ignore: str | Sequence[str] = (),
    ) -> SlidingData:
        """Return the pairs of a data frame, columns by name and unit, in any order.

        Parameters
        ----------
        frame : DataFrame
            Columns ``fx [N], fy [N], m [N m]``, and ``dx [m], dy [m], dtheta [rad]`` or ``vx [m/s],
            vy [m/s], omega [rad/s]``; standard deviations ``sd fx [N]`` and so on. Other units of
            the same kind are converted, such as ``m [N mm]`` or ``omega [deg/s]``.
        rho : float or str, optional
            Length [m], or text such as ``"50 mm"``; needed unless the frame's `attrs` have it.
        ignore : str or sequence of str
            Columns to leave out; others that are unknown are errors.

        Raises
        ------
        InputError
            See `read_table`; no rho.

        Warns
        -----
        DroppedRows
            Rows that are not finite were dropped; says how many.

        Examples
        --------
        >>> import pandas as pd
        >>> table = {"fx [N]": [1.0], "fy [N]": [0.0], "m [N mm]": [50.0]}
        >>> table |= {"vx [mm/s]": [2.0], "vy [mm/s]": [0.0], "omega [deg/s]": [1.0]}
        >>> SlidingData.from_frame(pd.DataFrame(table), rho="50 mm").loads
        array([[1.  , 0.  , 0.05]])
        """
        notes = getattr(frame, "attrs", {})
        given = notes.get("rho") if rho is None else rho
        table = read_table(frame, ignore)
        if given is None:
            raise InputError("rho", "is not known", remedy="give it, such as rho='50 mm'")
        return cls(
            table.loads,
            table.twists,
            parse_quantity(given, "m", name="rho"),
            load_deviations=table.load_deviations,
            twist_deviations=table.twist_deviations,
            motion=table.motion,
            **{note: str(notes.get(note, "")) for note in cls._NOTES},
        )

    def write(self, path: str | Path) -> None:
        """Write a ``.csv`` or ``.parquet`` file, as a whole or not at all; see `read_sliding_data`.

        Raises
        ------
        InputError
            Another suffix, no such folder, or no pyarrow for parquet.
        """
        write_frame(self.to_frame(), path)

    def __repr__(self) -> str:
        """Return name, number of pairs, and the largest loads and motions with their units."""
        force, moment = _largest(self.loads)
        way, turn = _largest(self.twists)
        per = "" if self.motion == "displacement" else "/s"
        pairs = f"{len(self)} pair{'s' if len(self) > 1 else ''}"
        return (
            f"SlidingData({self.name + ', ' if self.name else ''}{pairs}: "
            f"to {force:.3g} N, {moment:.3g} N m and {way:.3g} m{per}, {turn:.3g} rad{per}; "
            f"rho {self.rho:g} m)"
        )


def read_sliding_data(
    path: str | Path, rho: str | float | None = None, *, ignore: str | Sequence[str] = ()
) -> SlidingData:
    """Read pairs from a ``.csv`` or ``.parquet`` file; see `SlidingData.from_frame`.

    A CSV file has a row of titles, commas and decimal points, and nothing or ``nan`` for what is
    missing; lines before the titles that begin with ``#`` hold notes, such as ``# rho: 50 mm``.

    Raises
    ------
    DataError
        No such file, another suffix, broken or unsuited contents; says where.

    Examples
    --------
    >>> import tempfile
    >>> data = SlidingData([[2, 0, 0.1]], [[3e-3, 0, 0.5]], rho=0.05, name="one push")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     data.write(f"{folder}/push.csv")
    ...     read_sliding_data(f"{folder}/push.csv")
    SlidingData(one push, 1 pair: to 2 N, 0.1 N m and 0.003 m, 0.5 rad; rho 0.05 m)
    """
    frame = read_frame(path, ignore)
    try:
        return SlidingData.from_frame(frame, rho, ignore=ignore)
    except InputError as error:
        raise DataError(
            path, error.problem, column=error.argument, value=error.value, remedy=error.remedy
        ) from error


def _deviations(name: str, value: ArrayLike | None, n: int) -> Array | None:
    if value is None:
        return None
    one_for_all = np.shape(value) == (3,)
    given = np.broadcast_to(np.asarray(value), (n, 3)) if one_for_all else value
    deviations = as_array(name, given, n, 3)
    if deviations.min() < 0.0:
        raise InputError(name, "has negative entries", remedy="standard deviations are >= 0")
    return deviations


def _largest(rows: Array) -> tuple[float, float]:
    """Return the largest norm of the first two columns and the largest size of the third."""
    return float(np.hypot(rows[:, 0], rows[:, 1]).max()), float(np.abs(rows[:, 2]).max())
