"""Measured planar pushes: Zhou, Paolini, Bagnell, Mason, ICRA 2016, surface "blackboard".

A robot's finger pushes a right-isosceles aluminium triangle that stands on three small feet, or on
its whole face. The data are not part of the library: they are read from a folder, or fetched from
the authors' repository.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.constants import g

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.load_sharing import share_load
from limitsurf.datasets.push_log import read_push_log
from limitsurf.datasets.recorded_push import RecordedPush
from limitsurf.datasets.sliding_data import SlidingData
from limitsurf.datasets.zhou2016_source import (
    LICENCE,
    SOURCE,
    download,
    find_folder,
    given_folder,
    has_logs,
)
from limitsurf.errors import DataError, InputError

__all__ = [
    "CENTROID",
    "LEG",
    "MASS",
    "RHO",
    "SUPPORTS",
    "PushedTriangle",
    "fetch_zhou2016",
    "load_zhou2016",
    "three_feet",
]

Array = NDArray[np.float64]

LEG, MASS, RHO = 0.150, 1.518, 0.05  # m, kg, m
CENTROID = np.array([LEG / 3, LEG / 3])  # from the right-angle corner, where poses are measured

#: The supports on three feet; a name holds their coordinates ``x1_x2_x3_y1_y2_y3`` [mm].
SUPPORTS = (
    "10_130_10_10_10_130",
    "10_90_10_10_30_130",
    "30_63.33_43.33_30_43.33_63.33",
    "30_90_30_30_30_90",
)

_FEET = re.compile(r"(?:^|_)" + "_".join([r"(\d+(?:\.\d+)?)"] * 6) + "$")


@dataclass(frozen=True, eq=False)
class PushedTriangle:
    """The pushes on one support.

    Attributes
    ----------
    name : str
        Name of the log: the feet's coordinates, or ``patch`` for the whole face.
    feet : (3, 2) float or None
        Places of the feet, from the centroid [m]; None if the name holds none.
    data : SlidingData
        The averaged pairs: mean loads about the centroid with the standard deviations of the
        samples behind them, and displacements, in the axes of the triangle.
    pushes : tuple of RecordedPush
        What was recorded, in the same order.
    """

    name: str
    feet: Array | None
    data: SlidingData
    pushes: tuple[RecordedPush, ...]

    def __repr__(self) -> str:
        """Return the name and the number of pushes."""
        return f"PushedTriangle({self.name}, {len(self.pushes)} pushes)"


def load_zhou2016(
    path: str | Path | None = None, supports: str | Iterable[str] | None = None
) -> dict[str, PushedTriangle]:
    """Read the measured pushes of a triangle: five supports with 50 pushes each.

    Parameters
    ----------
    path : str or Path, optional
        Folder that holds the logs in its folder ``logs``. By default ``zhou2016`` in the folder
        that the environment variable LIMITSURF_DATA names, else what `fetch_zhou2016` has fetched.
    supports : str or iterable of str, optional
        Names of logs; by default all that are there.

    Returns
    -------
    dict
        By the names of the logs. A part's `data` are the pairs to fit; rho is 0.05 m.

    Raises
    ------
    DataError
        Data that are missing or broken; says where, and how to get them.

    Notes
    -----
    A pair is a mean load against a secant motion, not a load at an instant: see `RecordedPush`. The
    three feet carry known shares of the weight (`three_feet`), so the limit surface is known up to
    the friction coefficient.
    """
    folder = find_folder(path) / "logs"
    there = {file.stem: file for file in sorted(folder.glob("*.txt"))}
    wanted = [supports] if isinstance(supports, str) else supports
    names = list(there) if wanted is None else list(wanted)
    for name in names:
        if name not in there:
            raise DataError(folder, f"has no log {name}", remedy=f"there are {', '.join(there)}")
    return {name: _triangle(name, there[name]) for name in names}


def fetch_zhou2016(mirror: str | None = None) -> dict[str, PushedTriangle]:
    """Download the measured pushes once, check them, and read them; needs pooch.

    They come from the authors' repository at a fixed commit (Apache-2.0, about 10 MB), and are kept
    in the user's cache. If the environment variable LIMITSURF_DATA names a folder that holds them,
    nothing is downloaded.

    Parameters
    ----------
    mirror : str, optional
        Address of another copy of the source's folder.

    Raises
    ------
    InputError
        No pooch.
    DataError
        No answer, or contents with another checksum.
    """
    given = given_folder()
    return load_zhou2016(given if given and has_logs(given) else download(mirror))


def three_feet(support: str, mu: float = 1.0) -> ContactSet:
    """Return the contacts of the triangle's feet about its centroid; statically determinate.

    Examples
    --------
    >>> contacts = three_feet("10_130_10_10_10_130", mu=0.3)
    >>> abs(contacts.radius.sum() - 0.3 * 1.518 * 9.80665) < 1e-12
    np.True_
    """
    feet = _feet(support)
    if feet is None:
        raise InputError("support", "names no feet", value=support, remedy=f"such as {SUPPORTS[0]}")
    return ContactSet(feet, mu * share_load(feet, MASS * g, rule="three-point").normal_force)


def _feet(support: str) -> Array | None:
    found = _FEET.search(support)
    if found is None:
        return None
    corner = 1e-3 * np.array(found.groups(), dtype=np.float64).reshape(2, 3).T
    return np.asarray(corner - CENTROID)


def _triangle(name: str, file: Path) -> PushedTriangle:
    pushes = read_push_log(file, CENTROID)
    data = SlidingData(
        np.array([push.loads.mean(axis=0) for push in pushes]),
        np.array([push.displacement for push in pushes]),
        RHO,
        load_deviations=np.array([push.loads.std(axis=0) for push in pushes]),
        name=name,
        source=f"Zhou, Paolini, Bagnell, Mason (ICRA 2016), {SOURCE}",
        licence=LICENCE,
    )
    return PushedTriangle(name, _feet(name), data, pushes)
