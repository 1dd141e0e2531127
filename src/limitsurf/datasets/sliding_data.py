"""Pairs of load and motion of a sliding part, with what is known about them."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.datasets.plausibility import warn_of_units
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array, as_positive

__all__ = ["Motion", "SlidingData"]

Array = NDArray[np.float64]

Motion = Literal["displacement", "velocity"]


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

    def __post_init__(self) -> None:
        """Check all, and make the arrays read-only."""
        loads = as_array("loads", self.loads, None, 3)
        if len(loads) == 0:
            raise InputError("loads", "are none", remedy="give at least one pair")
        twists = as_array("twists", self.twists, len(loads), 3)
        rho = as_positive("rho", self.rho)
        if self.motion not in ("displacement", "velocity"):
            raise InputError("motion", "must be displacement or velocity", value=self.motion)
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

    def __repr__(self) -> str:
        """Return name, number of pairs, and the largest loads and motions with their units."""
        force, moment = _largest(self.loads)
        way, turn = _largest(self.twists)
        per = "" if self.motion == "displacement" else "/s"
        return (
            f"SlidingData({self.name + ', ' if self.name else ''}{len(self)} pairs: "
            f"to {force:.3g} N, {moment:.3g} N m and {way:.3g} m{per}, {turn:.3g} rad{per}; "
            f"rho {self.rho:g} m)"
        )


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
