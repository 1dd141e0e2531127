"""Pairs of an applied load and the motion under it: read, checked, and scaled to one unit."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.fitting.columns import named_rows
from limitsurf.sets.arguments import as_positive

__all__ = ["Pairs", "read_pairs", "scaled_loads", "scaled_motions"]

Array = NDArray[np.float64]

_FAR = 100.0  # moments that weigh this many times more in the loads than in the motions


@dataclass(frozen=True, eq=False)
class Pairs:
    """Loads applied to a part and the directions in which it slid.

    Attributes
    ----------
    loads : (n, 3) float
        Applied loads ``(fx, fy, m/rho)`` [N].
    motions : (n, 3) float
        Unit vectors along ``(vx, vy, rho omega)``.
    weight : (n,) float
        Positive weights; 2 counts like two pairs.
    rho : float
        The length that makes moments forces [m].
    """

    loads: Array
    motions: Array
    weight: Array
    rho: float

    def __len__(self) -> int:
        """Return the number of pairs."""
        return len(self.loads)

    @property
    def force(self) -> float:
        """Typical size of the loads [N]: the median norm."""
        return float(np.median(np.linalg.norm(self.loads, axis=1)))


def scaled_loads(loads: Any, rho: float) -> Array:
    """Return ``(fx, fy, m/rho)`` [N] of loads [N, N, N m]; rows may hold NaN, not infinity."""
    return np.asarray(_rows("loads", loads) / np.array([1.0, 1.0, as_positive("rho", rho)]))


def scaled_motions(twists: Any, rho: float) -> Array:
    """Return unit vectors along ``(vx, vy, rho omega)``; zeros for no motion, NaN for unknown."""
    rows = _rows("twists", twists) * np.array([1.0, 1.0, as_positive("rho", rho)])
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(np.divide(rows, length, out=np.zeros_like(rows), where=length != 0.0))


def read_pairs(
    loads: Any,
    twists: Any,
    sample_weight: ArrayLike | None,
    rho: float,
    *,
    least: int = 1,
    passive: bool = True,
) -> Pairs:
    """Check, clean and scale measured pairs.

    Pairs that say nothing are dropped with a warning that counts them: those with NaN, without
    motion, and, for `passive` contacts, without load or with one that brakes (negative power).

    Parameters
    ----------
    loads : (n, 3) array, data frame or xarray
        Loads applied to the part [N, N, N m]; see `named_rows` for named columns.
    twists : (n, 3) array, data frame or xarray
        Velocities or small displacements [m, m, rad], in any unit of time.
    sample_weight : (n,) float, optional
        Weights, at least 0; a pair of weight 2 counts like two pairs.
    rho : float
        Length that makes moments forces [m], such as the radius of gyration.
    least : int
        Number of pairs needed.
    passive : bool
        Whether the contacts only brake; then power cannot be negative.

    Raises
    ------
    InputError
        Different lengths, too few pairs, most powers negative (a wrong sign), or moments that weigh
        a hundred times more, or less, in the loads than in the motions (a wrong unit).
    """
    F, v = scaled_loads(loads, rho), scaled_motions(twists, rho)
    if len(F) != len(v):
        raise InputError("twists", f"has {len(v)} rows, but loads has {len(F)}")
    weight = _weights(sample_weight, len(F))
    F, v, weight = _informative(F, v, weight, passive)
    if passive:
        _check_units(F, v)
        F, v, weight = _with_power(F, v, weight)
    if len(F) < least:
        raise InputError(
            "loads",
            f"n_samples = {len(F)} usable pairs, but {least} is the minimum",
            remedy="measure more pairs, or fit a model with fewer parameters",
        )
    return Pairs(F, v, weight, rho)


def _rows(name: str, value: Any) -> Array:
    rows = named_rows(name, value)
    if np.isinf(rows).any():
        raise InputError(name, "has infinite entries (inf)", remedy="remove these rows")
    return rows


def _weights(sample_weight: ArrayLike | None, n: int) -> Array:
    if sample_weight is None:
        return np.ones(n)
    weight = np.asarray(sample_weight, dtype=np.float64)
    if weight.shape != (n,):
        raise InputError("sample_weight", f"has shape {weight.shape}, not ({n},)")
    if not np.isfinite(weight).all() or (weight < 0.0).any():
        raise InputError("sample_weight", "must be finite and at least 0")
    if n and not weight.any():
        raise InputError("sample_weight", "all weights are zero")
    return weight


def _informative(F: Array, v: Array, weight: Array, passive: bool) -> tuple[Array, Array, Array]:
    unknown = ~(np.isfinite(F).all(axis=1) & np.isfinite(v).all(axis=1))
    unloaded = ~unknown & ~F.any(axis=1) & passive  # active contacts move an unloaded part
    still = ~unknown & ~unloaded & ~v.any(axis=1)
    _tell(unknown, "NaN")
    _tell(unloaded, "no load")
    _tell(still, "no motion")
    keep = ~(unknown | unloaded | still) & (weight > 0.0)
    return F[keep], v[keep], weight[keep]


def _with_power(F: Array, v: Array, weight: Array) -> tuple[Array, Array, Array]:
    brakes = np.asarray((F * v).sum(axis=1)) < 0.0
    if len(F) and brakes.mean() > 0.5:
        raise InputError(
            "loads",
            f"{brakes.sum()} of {len(F)} loads point against the motion",
            remedy="give the loads applied to the part, not those of its contacts: change the sign",
        )
    _tell(brakes, "negative power, which friction does not allow")
    return F[~brakes], v[~brakes], weight[~brakes]


def _tell(drop: Any, what: str) -> None:
    if drop.any():
        warnings.warn(f"dropped {drop.sum()} of {len(drop)} pairs: {what}", stacklevel=5)


def _check_units(F: Array, v: Array) -> None:
    """Compare the share of moments in the loads with that of rotations in the motions.

    Of a support with feet at distances near d both shares are alike up to a factor ``(d/rho)^2``.
    """
    shares = [_moment_share(rows) for rows in (F, v)]
    if min(shares, default=0.0) <= 0.0 or not np.isfinite(shares).all():
        return
    ratio = shares[0] / shares[1]
    if not 1.0 / _FAR < ratio < _FAR:
        raise InputError(
            "loads",
            f"moments weigh {ratio:.3g} times as much in the loads as rotations do in the motions",
            remedy="give moments in N m, translations in m, angles in rad, rho in m and near the "
            "size of the support",
        )


def _moment_share(rows: Array) -> float:
    force = float(np.hypot(rows[:, 0], rows[:, 1]).sum())
    moment = float(np.abs(rows[:, 2]).sum())
    return moment / force if force > 0.0 else np.inf
