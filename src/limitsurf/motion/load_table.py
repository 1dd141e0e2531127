"""External loads that change in time, tabulated for compiled integrators."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray
from scipy.special import comb

from limitsurf.errors import InputError
from limitsurf.kernels.load_table import CONSTANT, NONE, VARIES, Load, load_at
from limitsurf.sets.arguments import as_array

__all__ = ["LoadLike", "LoadTable"]

Array = NDArray[np.float64]

_TERMS = 12
_TOLERANCE = 1e-10  # of the largest load, at points between the nodes
_DEPTH = 40  # halvings: pieces down to 1e-12 of the duration, for loads with kinks
_PIECES = 20_000


class LoadTable:
    """A load (3,) as a function of time, about the centre of mass, world axes.

    A callable is sampled once, on pieces that are halved until a Chebyshev series of twelve terms
    agrees with it between its nodes to 1e-10 of the largest load. A table can serve many motions.

    Parameters
    ----------
    load : (3,) float, callable ``t -> (3,)``, or None
        The load [N, N, N m]; None is no load.
    duration : float
        The table holds for times from 0 to this [s].

    Raises
    ------
    InputError
        Values that are not three finite numbers, or a load that jumps.

    Examples
    --------
    >>> table = LoadTable(lambda t: (np.sin(t), 0.0, 0.0), 10.0)
    >>> bool(abs(table(2.5)[0] - np.sin(2.5)) < 1e-10)
    True
    """

    def __init__(self, load: ArrayLike | Callable[[float], ArrayLike] | None, duration: float):
        self.duration = float(duration)
        if callable(load):
            self.kernel = _tabulated(load, self.duration)
        else:
            value = np.zeros(3) if load is None else as_array("load", load, 3)
            kind = CONSTANT if value.any() else NONE
            series = value.reshape(1, 3, 1).copy()
            self.kernel = Load(np.array([0.0, self.duration]), series, series, kind)

    @classmethod
    def of(cls, load: LoadLike, duration: float) -> LoadTable:
        """Return a load as a table; a table that is long enough as it is."""
        if not isinstance(load, LoadTable):
            return cls(load, duration)
        if load.steady or load.duration >= duration:
            return load
        raise InputError(
            "load",
            f"is a table of {load.duration:g} s",
            remedy=f"make one for {duration:g} s",
        )

    @property
    def steady(self) -> bool:
        """Whether the load is constant."""
        return self.kernel.kind != VARIES

    @property
    def largest(self) -> Array:
        """Largest magnitude of each component (3,) [N, N, N m], or a little more."""
        return np.abs(self.kernel.bernstein).max(axis=(0, 2))

    def __call__(self, time: float) -> Array:
        """Return the load (3,) at a time [s]."""
        return np.array(load_at(self.kernel, float(time))[0])

    def __repr__(self) -> str:
        """Return kind, pieces and duration."""
        what = "no load", "constant", f"{len(self.kernel.series)} pieces"
        return f"LoadTable({what[self.kernel.kind]}, {self.duration:g} s)"


LoadLike = ArrayLike | Callable[[float], ArrayLike] | LoadTable | None


@cache
def _rules() -> tuple[Array, Array, Array, Array, Array]:
    """Return nodes, values to series, points between, their matrix, series to Bernstein."""
    nodes = chebyshev.chebpts1(_TERMS)
    between = np.array([-0.97, -0.35, 0.4, 0.95])
    fit = np.linalg.inv(chebyshev.chebvander(nodes, _TERMS - 1))
    p = _TERMS - 1
    k, x = np.arange(_TERMS), 0.5 * (1.0 + nodes)[:, None]
    bernstein = np.linalg.inv(comb(p, k) * x**k * (1.0 - x) ** (p - k))
    vander = chebyshev.chebvander(nodes, p)
    return nodes, fit, between, chebyshev.chebvander(between, p), bernstein @ vander


def _tabulated(load: Callable[[float], ArrayLike], duration: float) -> Load:
    nodes, fit, between, check, bernstein = _rules()
    todo, begins, series, largest = [(0.0, duration, 0)], [], [], np.zeros(3)
    while todo:
        begin, end, depth = todo.pop()
        at = begin + 0.5 * (end - begin) * (1.0 + np.concatenate([nodes, between]))
        values = _sampled(load, at)
        largest = np.maximum(largest, np.abs(values).max(axis=0))
        largest[:2] = largest[:2].max()
        c = fit @ values[:_TERMS]
        wrong = np.abs(check @ c - values[_TERMS:]).max(axis=0)
        if (wrong <= _TOLERANCE * np.maximum(largest, np.finfo(float).tiny)).all():
            begins.append(begin)
            series.append(c.T)
        elif depth == _DEPTH or len(begins) + len(todo) > _PIECES:
            raise InputError(
                "load",
                f"is not smooth near t = {begin:.6g} s",
                remedy="split the motion where the load jumps",
            )
        else:
            middle = 0.5 * (begin + end)
            todo += [(middle, end, depth + 1), (begin, middle, depth + 1)]
    table = np.ascontiguousarray(series)
    control = np.ascontiguousarray(table @ bernstein.T)
    return Load(np.array([*begins, duration]), table, control, VARIES)


def _sampled(load: Callable[[float], ArrayLike], times: Array) -> Array:
    """Return the loads (n, 3) at times; InputError if they are not three finite numbers."""
    try:
        values = np.array([load(t) for t in times.tolist()], dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("load", "does not return three numbers") from error
    if values.shape != (len(times), 3) or not np.isfinite(values).all():
        raise InputError("load", "does not return three finite numbers", value=values[0].tolist())
    return values
