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
_SHORTEST = 2.0**-40  # of the duration: loads with kinks need short pieces there
_PIECES = 20_000
_TINY = float(np.finfo(np.float64).tiny)


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
            row = np.concatenate([[0.0, self.duration], value, value])
            self.kernel = Load(row[None], 1, kind)

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
        terms = self.kernel.terms
        control = self.kernel.pieces[:, 2 + 3 * terms :].reshape(-1, 3, terms)
        return np.asarray(np.abs(control).max(axis=(0, 2)))

    @property
    def shortest(self) -> float:
        """Length of the shortest piece [s]."""
        return float((self.kernel.pieces[:, 1] - self.kernel.pieces[:, 0]).min())

    def __call__(self, time: float) -> Array:
        """Return the load (3,) at a time [s]."""
        return np.array(load_at(self.kernel, float(time))[0])

    def __repr__(self) -> str:
        """Return kind, pieces and duration."""
        what = "no load", "constant", f"{len(self.kernel.pieces)} pieces"
        return f"LoadTable({what[self.kernel.kind]}, {self.duration:g} s)"


LoadLike = ArrayLike | Callable[[float], ArrayLike] | LoadTable | None


@cache
def _rules() -> tuple[Array, Array, Array, Array, Array]:
    """Return nodes, values to series, points between, their matrix, series to Bernstein."""
    nodes = np.asarray(chebyshev.chebpts1(_TERMS), dtype=np.float64)
    between = np.array([-0.97, -0.35, 0.4, 0.95])
    fit = np.asarray(np.linalg.inv(chebyshev.chebvander(nodes, _TERMS - 1)))
    p = _TERMS - 1
    k, x = np.arange(_TERMS), 0.5 * (1.0 + nodes)[:, None]
    bernstein = np.linalg.inv(comb(p, k) * x**k * (1.0 - x) ** (p - k))
    vander = chebyshev.chebvander(nodes, p)
    check = np.asarray(chebyshev.chebvander(between, p), dtype=np.float64)
    return nodes, fit, between, check, np.asarray(bernstein @ vander)


def _tabulated(load: Callable[[float], ArrayLike], duration: float) -> Load:
    """Return the table, of pieces that are cut, a level at a time, until they are good."""
    nodes, fit, between, check, bernstein = _rules()
    at = 0.5 * (1.0 + np.concatenate([nodes, between]))
    begin, width, largest = np.zeros(1), np.array([duration]), np.zeros(3)
    rows: list[Array] = []
    while len(begin):
        values = _sampled(load, begin[:, None] + width[:, None] * at)
        largest = np.maximum(largest, np.abs(values).max(axis=(0, 1)))
        largest[:2] = largest[:2].max()
        c = fit @ values[:, :_TERMS]
        wrong = np.abs(check @ c - values[:, _TERMS:]).max(axis=1)
        excess = (wrong / np.maximum(_TOLERANCE * largest, _TINY)).max(axis=1)
        good = excess <= 1.0
        series = [
            x.transpose(0, 2, 1).reshape(len(x), 3 * _TERMS) for x in (c[good], bernstein @ c[good])
        ]
        rows.append(np.column_stack([begin[good], (begin + width)[good], *series]))
        begin, width = _cut(begin[~good], width[~good], excess[~good], duration)
    table = np.concatenate(rows)
    return Load(table[np.argsort(table[:, 0])], _TERMS, VARIES)


def _cut(begin: Array, width: Array, excess: Array, duration: float) -> tuple[Array, Array]:
    """Cut pieces into as many as are needed at least: halves are better by ``2^terms`` at most."""
    if not len(begin):
        return begin, width
    bad = begin[width < duration * _SHORTEST]
    if len(bad) or len(begin) > _PIECES:
        raise InputError(
            "load",
            f"is not smooth near t = {(bad if len(bad) else begin)[0]:.6g} s",
            remedy="split the motion where the load jumps",
        )
    halvings = np.round(np.log2(excess) / _TERMS).astype(np.int64)
    parts = 2 ** np.clip(halvings, 1, 3)
    share = np.concatenate([np.arange(k) for k in parts])
    width = np.repeat(width / parts, parts)
    return np.repeat(begin, parts) + share * width, width


def _sampled(load: Callable[[float], ArrayLike], times: Array) -> Array:
    """Return the loads (n, k, 3) at times (n, k); InputError if they are not finite numbers."""
    try:
        values = np.array([load(t) for t in times.ravel().tolist()], dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("load", "does not return three numbers") from error
    if values.shape != (times.size, 3) or not np.isfinite(values).all():
        raise InputError("load", "does not return three finite numbers", value=values[0].tolist())
    return values.reshape(*times.shape, 3)
