"""Parts on known feet, whose friction is fitted."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.load_sharing import share_load
from limitsurf.errors import InputError
from limitsurf.fitting.base import LimitSurfaceModel
from limitsurf.fitting.contact_model import ContactModel
from limitsurf.fitting.contact_slopes import motions_under
from limitsurf.fitting.pairs import Pairs
from limitsurf.sets.arguments import as_array, as_positive
from limitsurf.sets.contact_sum import ContactSum

__all__ = ["ThreePointModel"]

Array = NDArray[np.float64]


class ThreePointModel(LimitSurfaceModel):
    """Three feet at known places: their friction radii are fitted.

    Parameters
    ----------
    positions : (3, 2) float
        Feet, from the reference point [m].
    rho : float, optional
        Length that makes moments forces [m]; by default the root mean square distance of the feet.
    one_friction : bool
        One friction coefficient for all feet, about the centre of mass: statics shares the weight,
        and one number is fitted.
    huber : (2,) float, optional
        As in `ContactModel`.

    Attributes
    ----------
    surface_ : ContactSum
        What the feet exert on the part.
    radii_ : (3,) float
        Friction radii [N].

    Examples
    --------
    >>> v = np.random.default_rng(0).normal(size=(20, 3))
    >>> feet = ContactSum([[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]], [2.0, 1.0, 1.0])
    >>> model = ThreePointModel(feet.position).fit(feet.support_point(v), v)
    >>> model.radii_.round(3)
    array([2., 1., 1.])
    """

    def __init__(
        self,
        positions: ArrayLike,
        rho: float | None = None,
        *,
        one_friction: bool = False,
        huber: tuple[float, float] | None = (0.1, 0.15),
    ) -> None:
        self.positions = positions
        self.rho = rho  # type: ignore[assignment]
        self.one_friction = one_friction
        self.huber = huber

    @property
    def _feet(self) -> Array:
        feet = as_array("positions", self.positions, 3, 2)
        if not feet.any():
            raise InputError("positions", "are all the reference point")
        return feet

    @property
    def _length(self) -> float:
        if self.rho is not None:
            return as_positive("rho", self.rho)
        return float(np.sqrt((self._feet**2).sum(axis=1).mean()))

    def _fit(self, pairs: Pairs) -> ContactSum:
        feet = self._feet
        if self.one_friction:
            share = share_load(feet, 1.0, rule="three-point").normal_force
            self.radii_ = share * _size(pairs, feet / pairs.rho, share)
        else:
            model = ContactModel(pairs.rho, feet, huber=self.huber, smoothing=0.0)
            model._fit(pairs)
            self.radii_ = np.zeros(3)
            self.radii_[model.carries_] = model.radii_
        return ContactSum(feet, self.radii_)

    def _directions(self, loads: Array) -> Array:
        return motions_under(loads, self._feet / self._length, self.radii_)


def _size(pairs: Pairs, places: Array, share: Array) -> float:
    """Return the friction of all feet: the weighted median of ``F.v / h(v)`` for shares of 1."""
    x, y = places.T
    v = pairs.motions
    speed = np.hypot(v[:, :1] - v[:, 2:] * y, v[:, 1:2] + v[:, 2:] * x)
    sizes = (pairs.loads * v).sum(axis=1) / np.maximum(speed @ share, np.finfo(np.float64).tiny)
    order = np.argsort(sizes)
    half = np.searchsorted(np.cumsum(pairs.weight[order]), 0.5 * pairs.weight.sum())
    return float(sizes[order][half])
