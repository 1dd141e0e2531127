r"""All sign changes of a function whose slope has an upper bound, with proof.

A function f with :math:`f' \le L` cannot climb faster than L. Over an interval of length h it stays
negative if :math:`-f(a) > L h`, and positive if :math:`f(b) > L h`: one-sided, so that it may
fall as it likes. Intervals that neither test decides are halved. What is still undecided at
the finest resolution is reported.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["SignChanges", "sign_changes"]

Array = NDArray[np.float64]

_NODES = 256
_POLISHING = 80
_SHORT = 0.02


@dataclass(frozen=True, eq=False)
class SignChanges:
    """Where a periodic function changes its sign.

    Attributes
    ----------
    rising, falling : (k,) float
        From minus to plus and from plus to minus, ascending, in [0, period); as many of one as
        of the other.
    gaps : (g, 2) float
        Intervals in which the sign is not proven; outside of them the function has no zero.
    zero : bool
        True if no value exceeds the noise.
    period : float
        The period.
    proven : bool
        Whether the gaps rest on a bound of the slope.
    """

    rising: Array
    falling: Array
    gaps: Array
    zero: bool

    period: float
    proven: bool

    @property
    def isolated(self) -> bool:
        """Whether the gaps are proven and short, and none shows more than one change."""
        found = np.concatenate([self.rising, self.falling])
        first, width = self.gaps[:, :1], np.diff(self.gaps)
        inside = np.mod(found - first, self.period) <= width
        short = (width < _SHORT * self.period).all()
        return bool(self.proven and short and (inside.sum(axis=1) <= 1).all())


def sign_changes(
    function: Callable[[Array], Array],
    period: float,
    rise: float,
    *,
    noise: float,
    resolution: float = 1e-7,
    budget: int = 200_000,
) -> SignChanges:
    """Return all sign changes of a continuous periodic function.

    Parameters
    ----------
    function : callable
        Maps abscissae (k,) to values (k,).
    period : float
        Its period.
    rise : float
        Upper bound of its slope. If infinite, four times the steepest rise between the first
        values stands for it, and nothing is proven.
    noise : float
        Bound on the rounding error of its values.
    resolution : float
        Length of the shortest intervals, relative to the period.
    budget : int
        About how many values to compute at most.

    Examples
    --------
    >>> found = sign_changes(np.sin, 2 * np.pi, 1.0, noise=1e-15)
    >>> [float(x.round(12)) + 0.0 for x in (*found.rising, *found.falling)], found.isolated
    ([0.0, 3.14159265359], True)
    """
    x = period * (np.arange(_NODES + 1) - 0.414) / _NODES
    f = function(x[:-1])
    f, proven = np.append(f, f[0]), bool(np.isfinite(rise))
    if np.abs(f).max() <= 2.0 * noise:
        none, whole = np.empty(0), x[[0, -1]][None]
        return SignChanges(none, none, whole, zero=True, period=period, proven=proven)
    if not proven:
        rise = 4.0 * float(np.abs(np.diff(f)).max()) * _NODES / period
    while True:
        h = np.diff(x)
        undecided = (-f[:-1] <= rise * h + noise) & (f[1:] <= rise * h + noise)
        split = np.flatnonzero(undecided & (h > resolution * period))
        if len(split) == 0 or len(x) + len(split) > budget:
            break
        middle = x[split] + 0.5 * h[split]
        x, f = np.insert(x, split + 1, middle), np.insert(f, split + 1, function(middle))
    rising, falling = _roots(function, x[:-1], f[:-1], period, noise)
    return SignChanges(
        _reduced(rising, period),
        _reduced(falling, period),
        _merged(x, undecided),
        zero=False,
        period=period,
        proven=proven,
    )


def _roots(
    function: Callable[[Array], Array], x: Array, f: Array, period: float, noise: float
) -> tuple[Array, Array]:
    """Return where values that are clear of noise change their sign, polished."""
    clear = np.abs(f) > noise
    x, f = x[clear], f[clear]
    x, f = np.append(x, x[0] + period), np.append(f, f[0])
    k = np.flatnonzero(np.diff(np.sign(f)))
    roots = _polished(function, x[k], x[k + 1], f[k], f[k + 1])
    return roots[f[k] < 0.0], roots[f[k] > 0.0]


def _polished(
    function: Callable[[Array], Array], a: Array, b: Array, fa: Array, fb: Array
) -> Array:
    """Return the zeros in brackets: the Illinois method, every third step a bisection."""
    for step in range(_POLISHING):
        live = np.flatnonzero(b - a > 4e-16 * np.maximum(np.abs(b), 1.0))
        if len(live) == 0:
            break
        share = 0.5 if step % 3 == 2 else fa[live] / (fa[live] - fb[live])
        x = a[live] + np.clip(share, 1e-9, 1.0 - 1e-9) * (b[live] - a[live])
        f = function(x)
        left = np.sign(f) == np.sign(fa[live])
        exact, up, down = f == 0.0, live[left], live[~left]
        a[up], fa[up], fb[up] = x[left], f[left], 0.5 * fb[up]
        b[down], fb[down], fa[down] = x[~left], f[~left], 0.5 * fa[down]
        a[live[exact]] = b[live[exact]] = x[exact]
    return 0.5 * (a + b)


def _reduced(roots: Array, period: float) -> Array:
    inside = np.mod(roots, period)
    inside[period - inside < 1e-12 * period] = 0.0
    return np.sort(inside)


def _merged(x: Array, undecided: NDArray[np.bool_]) -> Array:
    """Return the runs of undecided intervals, (g, 2)."""
    runs: list[tuple[float, float]] = []
    for open_, group in itertools.groupby(range(len(undecided)), key=lambda k: bool(undecided[k])):
        places = list(group)
        if open_:
            runs.append((float(x[places[0]]), float(x[places[-1] + 1])))
    return np.array(runs).reshape(-1, 2)
