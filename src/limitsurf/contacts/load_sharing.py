"""Who carries the weight of a part."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError, OutsideSupports, SolveFailed
from limitsurf.kernels.load_sharing import share_minimum_norm
from limitsurf.sets.arguments import as_array, as_number
from limitsurf.tolerances import GIVEN_LOAD, SHARED_LOAD

__all__ = ["LoadShare", "share_load"]

Array = NDArray[np.float64]
_EPS = float(np.finfo(np.float64).eps)

Rule = Literal["equal", "minimum-norm", "three-point"]


@dataclass(frozen=True, eq=False)
class LoadShare:
    """Normal loads of the supports of a part.

    Attributes
    ----------
    normal_force : (n,) float
        Loads N_i >= 0 [N].
    carried : float
        Weight that the supports carry, without what is lifted off [N].
    imbalance : (3,) float
        ``sum N - carried`` [N], and the moments ``sum N (x, y)`` about the centre of mass [N m].
        Equal loads balance no moments in general.
    residual : float
        The same as one number: the norm, relative to `carried` and to the largest distance of a
        support from the centre of mass.
    rule : str
        How it was shared.
    multipliers : (3,) float or None
        Minimum-norm loads only: ``N_i = max(0, l . (1, x_i, y_i))`` about the centre of mass, which
        with `residual` = 0 proves them optimal [N, N/m, N/m].
    iterations : int
        Newton steps.
    """

    normal_force: Array
    carried: float
    imbalance: Array
    residual: float
    rule: str
    multipliers: Array | None = None
    iterations: int = 0

    def __repr__(self) -> str:
        """Return the rule, the loaded supports and the residual."""
        n = len(self.normal_force)
        loaded = int(np.count_nonzero(self.normal_force))
        return (
            f"LoadShare({self.rule}, {self.carried:.4g} N on {loaded} of {n} supports, "
            f"residual {self.residual:.1e})"
        )


def share_load(
    positions: ArrayLike,
    weight: float,
    center_of_mass: ArrayLike = (0.0, 0.0),
    rule: Rule | ArrayLike = "minimum-norm",
    *,
    lift: float = 0.0,
) -> LoadShare:
    r"""Return the normal loads of supports that carry a part.

    .. math:: \sum N_i = (1 - \text{lift})\, W, \quad \sum N_i (r_i - c) = 0, \quad N_i \ge 0

    Parameters
    ----------
    positions : (n, 2) float
        Supports r_i [m].
    weight : float
        Weight W >= 0 of the part [N].
    center_of_mass : (2,) float
        Its centre of mass c, in the frame of the positions [m].
    rule : {"minimum-norm", "equal", "three-point"} or (n,) float
        "minimum-norm": the loads of least ``sum N^2`` in equilibrium, as on equal springs under a
        rigid part without tension. "equal": W/n on each; `LoadShare.imbalance` says which moments
        that leaves. "three-point": the only loads of three supports in equilibrium. Or the
        loads themselves [N], which must be in equilibrium to 1e-9.
    lift : float
        Share of the weight, from 0 to 1, that air nozzles take off at the centre of mass.

    Raises
    ------
    OutsideSupports
        The centre of mass is outside the supports: no loads that only push are in equilibrium.
    InputError
        Arguments of the wrong shape, sign or size; three-point loads on other than three supports
        or on a line; given loads out of equilibrium.

    Examples
    --------
    A weight over the middle of a square table, and over a corner of it:

    >>> legs = [[1, 1], [-1, 1], [-1, -1], [1, -1]]
    >>> share_load(legs, 4.0).normal_force
    array([1., 1., 1., 1.])
    >>> share_load(legs, 4.0, [0.8, 0.8]).normal_force.round(12)
    array([3.2, 0.4, 0. , 0.4])
    >>> share_load(legs[:3], 4.0, [-0.5, 0.5], "three-point", lift=0.5).normal_force
    array([0.5, 1. , 0.5])
    """
    places = as_array("positions", positions, None, 2)
    center = as_array("center_of_mass", center_of_mass, 2)
    carried = _carried(weight, lift)
    if len(places) == 0:
        raise InputError("positions", "are missing", remedy="give at least one support")
    arms = _arms(places, center)
    if not isinstance(rule, str):
        return _given(arms, carried, rule)
    if carried == 0.0 and rule in ("minimum-norm", "three-point"):
        return _share(arms, 0.0, np.zeros(len(places)), rule)
    if rule == "equal":
        return _share(arms, carried, np.full(len(places), carried / len(places)), rule)
    if rule == "three-point":
        return _share(arms, carried, _three_point(arms, carried), rule)
    if rule == "minimum-norm":
        return _minimum_norm(arms, carried)
    raise InputError("rule", "is unknown", value=rule, remedy="equal, minimum-norm or three-point")


@dataclass(frozen=True, eq=False)
class _Arms:
    """Supports about the centre of mass.

    `xy` is (2, n), `reach` the largest distance, `noise` how far rounding moves a support.
    """

    xy: Array
    center: Array
    reach: float
    noise: float


def _arms(places: Array, center: Array) -> _Arms:
    xy = places.T - center[:, None]
    reach = float(np.sqrt((xy[0] ** 2 + xy[1] ** 2).max())) or 1.0
    noise = 4.0 * _EPS * (reach + float(np.abs(center).max()))
    xy[np.abs(xy) <= noise] = 0.0
    return _Arms(np.ascontiguousarray(xy), center, reach, noise)


def _carried(weight: float, lift: float) -> float:
    if not (np.isfinite(as_number("weight", weight)) and weight >= 0.0):
        raise InputError("weight", "must be at least 0", value=weight)
    if not 0.0 <= as_number("lift", lift) <= 1.0:
        raise InputError(
            "lift", "must lie between 0 and 1", value=lift, remedy="it is a share of the weight"
        )
    return float(weight) * (1.0 - float(lift))


def _share(arms: _Arms, carried: float, loads: Array, rule: str) -> LoadShare:
    imbalance = np.array([loads.sum() - carried, *(arms.xy @ loads)])
    scale = np.array([1.0, arms.reach, arms.reach]) * (carried or 1.0)
    residual = float(np.linalg.norm(imbalance / scale))
    return LoadShare(loads, carried, imbalance, residual, rule)


def _given(arms: _Arms, carried: float, rule: ArrayLike) -> LoadShare:
    loads = as_array("rule", rule, arms.xy.shape[1])
    if (loads < 0.0).any():
        raise InputError(
            "rule", "has negative loads", value=float(loads.min()), remedy="supports only push"
        )
    share = _share(arms, carried, loads, "given")
    if share.residual > GIVEN_LOAD:
        force, mx, my = share.imbalance
        raise InputError(
            "rule",
            f"the loads are not in equilibrium: off by {force:.3g} N and {mx:.3g}, {my:.3g} N m",
            remedy="give loads that are, about the centre of mass, or take minimum-norm ones",
        )
    return share


def _three_point(arms: _Arms, carried: float) -> Array:
    x, y = arms.xy
    if len(x) != 3:
        raise InputError(
            "positions", f"are {len(x)}, not three supports", remedy="take rule minimum-norm"
        )
    opposite = np.roll(x, -1) * np.roll(y, -2) - np.roll(y, -1) * np.roll(
        x, -2
    )  # areas seen from c
    area = opposite.sum()
    rounding = arms.noise * arms.reach
    if abs(area) <= rounding:
        raise InputError(
            "positions", "lie on a line: not statically determinate", remedy="rule minimum-norm"
        )
    shares = opposite / area
    if (shares * abs(area) < -rounding).any():
        raise _outside(arms)
    return np.asarray(carried * np.maximum(shares, 0.0))


def _minimum_norm(arms: _Arms, carried: float) -> LoadShare:
    A = _principal(arms)
    x, y = A @ arms.xy
    blur = SHARED_LOAD + arms.noise * np.abs(A).max(axis=1)
    lam, steps, balanced = share_minimum_norm(x, y, (SHARED_LOAD, float(blur[0]), float(blur[1])))
    if not balanced:
        if _distance(arms) > arms.noise:
            raise _outside(arms)
        raise SolveFailed("share_load: the loads do not balance to rounding", best=np.array(lam))
    unit = carried / len(x)
    loads = np.maximum(lam[0] + lam[1] * x + lam[2] * y, 0.0) * unit
    multipliers = unit * np.array([lam[0], *(lam[1:] @ A)])
    return replace(
        _share(arms, carried, loads, "minimum-norm"), multipliers=multipliers, iterations=steps
    )


def _principal(arms: _Arms) -> Array:
    """Return a map (2, 2) to principal axes, of root mean square 1; zero where that is rounding."""
    _, turn = np.linalg.eigh(arms.xy @ arms.xy.T)
    turned = turn.T @ arms.xy
    spread = np.sqrt(np.einsum("ij,ij->i", turned, turned) / arms.xy.shape[1])
    scale = np.divide(1.0, spread, out=np.zeros(2), where=spread > arms.noise)
    return np.asarray(scale[:, None] * turn.T)


def _distance(arms: _Arms) -> float:
    hull = shapely.convex_hull(shapely.multipoints(arms.xy.T))
    return float(shapely.distance(hull, shapely.Point(0.0, 0.0)))


def _outside(arms: _Arms) -> OutsideSupports:
    return OutsideSupports(tuple(arms.center.tolist()), _distance(arms))
