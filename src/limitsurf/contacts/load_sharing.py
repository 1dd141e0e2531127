"""Who carries the weight of a part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError, OutsideSupports, SolveFailed
from limitsurf.kernels.load_sharing import share_minimum_norm
from limitsurf.sets.arguments import as_array
from limitsurf.tolerances import GIVEN_LOAD, SHARED_LOAD

__all__ = ["LoadShare", "share_load"]

Array = NDArray[np.float64]
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
    arms = places - center
    if not isinstance(rule, str):
        return _given(arms, carried, rule)
    if rule == "equal":
        return _share(arms, carried, np.full(len(arms), carried / len(arms)), rule)
    if rule == "three-point":
        return _share(arms, carried, _three_point(arms, carried, center), rule)
    if rule == "minimum-norm":
        return _minimum_norm(arms, carried, center)
    raise InputError("rule", "is unknown", value=rule, remedy="equal, minimum-norm or three-point")


def _carried(weight: float, lift: float) -> float:
    if not (np.isfinite(weight) and weight >= 0.0):
        raise InputError("weight", "must be at least 0", value=weight)
    if not 0.0 <= lift <= 1.0:
        raise InputError(
            "lift", "must lie between 0 and 1", value=lift, remedy="it is a share of the weight"
        )
    return float(weight) * (1.0 - float(lift))


def _share(arms: Array, carried: float, loads: Array, rule: str) -> LoadShare:
    imbalance = np.array([loads.sum() - carried, *(loads @ arms)])
    scale = np.array([1.0, *np.full(2, _reach(arms))]) * (carried or 1.0)
    residual = float(np.linalg.norm(imbalance / scale))
    return LoadShare(loads, carried, imbalance, residual, rule)


def _reach(arms: Array) -> float:
    return float(np.hypot(arms[:, 0], arms[:, 1]).max()) or 1.0


def _given(arms: Array, carried: float, rule: ArrayLike) -> LoadShare:
    loads = as_array("rule", rule, len(arms))
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


def _three_point(arms: Array, carried: float, center: Array) -> Array:
    if len(arms) != 3:
        raise InputError(
            "positions", f"are {len(arms)}, not three supports", remedy="take rule minimum-norm"
        )
    after, before = np.roll(arms, -1, axis=0), np.roll(arms, -2, axis=0)
    opposite = after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]  # triangles seen from c
    area = opposite.sum()
    rounding = 1e-14 * _reach(arms) ** 2
    if abs(area) <= rounding:
        raise InputError(
            "positions", "lie on a line: not statically determinate", remedy="rule minimum-norm"
        )
    shares = opposite / area
    if (shares * abs(area) < -rounding).any():
        raise _outside(arms, center)
    return np.asarray(carried * np.maximum(shares, 0.0))


def _minimum_norm(arms: Array, carried: float, center: Array) -> LoadShare:
    n, reach = len(arms), _reach(arms)
    x, y = np.array(arms.T / reach, order="C")
    lam, _, steps, balanced = share_minimum_norm(x, y, (float(n), 0.0, 0.0), SHARED_LOAD)
    if not balanced:
        if _distance(arms) > 1e-14 * reach:
            raise _outside(arms, center)
        raise SolveFailed("share_load: the loads do not balance to rounding", best=np.array(lam))
    unit = carried / n
    loads = np.maximum(lam[0] + lam[1] * x + lam[2] * y, 0.0) * unit
    found = _share(arms, carried, loads, "minimum-norm")
    multipliers = unit * np.array([lam[0], lam[1] / reach, lam[2] / reach])
    return LoadShare(
        loads, carried, found.imbalance, found.residual, found.rule, multipliers, steps
    )


def _distance(arms: Array) -> float:
    hull = shapely.convex_hull(shapely.multipoints(arms))
    return float(shapely.distance(hull, shapely.Point(0.0, 0.0)))


def _outside(arms: Array, center: Array) -> OutsideSupports:
    return OutsideSupports(tuple(center.tolist()), _distance(arms))
