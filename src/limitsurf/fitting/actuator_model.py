r"""What one actuator of a driven array exerts, identified from pushes on a part on many."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.fitting.base import LimitSurfaceModel
from limitsurf.fitting.contact_slopes import load_slopes, motions_under
from limitsurf.fitting.nonnegative import Penalty, Residuals, nonnegative_weights
from limitsurf.fitting.pairs import Pairs
from limitsurf.sets.arguments import as_array, as_positive
from limitsurf.sets.contact_sum import ContactSum

__all__ = ["ActuatorModel"]

Array = NDArray[np.float64]

_WIDTH = 1e-6  # of the smoothing: places are known


class ActuatorModel(LimitSurfaceModel):
    r"""Equal active contacts at known places: offset and friction of one are fitted.

    .. math:: L = \sum_i G_i \{R_i a + m f_i : |f_i| \le 1\}

    The load that a motion needs is linear in a and m: non-negative least squares, with Huber's
    loss.

    Parameters
    ----------
    positions : (N, 2) float
        Actuators under the part, from its reference point [m].
    headings : (N,) float, optional
        Angles of their axes x [rad], which R_i turns by; 0 by default.
    rho : float
        Length that makes moments forces [m].
    huber : float
        Errors of loads, relative to their typical size, from which the loss grows linearly;
        infinity for squares.

    Attributes
    ----------
    surface_ : ContactSum
        What all of them exert on the part.
    offset_ : (2,) float
        Active offset a of one, in its own axes [N].
    radius_ : float
        Friction radius m of one [N].

    Examples
    --------
    >>> tips = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0], [0.5, 0.5]])
    >>> array = ContactSum(tips, np.full(4, 0.5), center=[0.8, 0.0, -0.1])  # offset 0.2 along x
    >>> v = np.random.default_rng(0).normal(size=(30, 3))
    >>> model = ActuatorModel(tips, rho=1.0).fit(-array.support_point(-v), v)
    >>> model.offset_.round(6) + 0.0, round(model.radius_, 6)
    (array([0.2, 0. ]), 0.5)
    """

    def __init__(
        self,
        positions: ArrayLike,
        headings: ArrayLike | None = None,
        rho: float = 0.05,
        *,
        huber: float = 0.1,
    ) -> None:
        self.positions = positions
        self.headings = headings
        self.rho = rho
        self.huber = huber

    @property
    def _passive(self) -> bool:
        return False

    def _fit(self, pairs: Pairs) -> ContactSum:
        size = pairs.force
        places = as_array("positions", self.positions, None, 2)
        if len(places) == 0:
            raise InputError("positions", "are missing", remedy="give at least one actuator")
        push = self._pushes(places / pairs.rho)
        brake = load_slopes(pairs.motions, places / pairs.rho, _WIDTH).sum(axis=2, keepdims=True)
        push_rows = np.broadcast_to(push, (len(brake), 3, 2))
        X = np.concatenate([brake, -push_rows, push_rows], axis=2)
        weight = pairs.weight / pairs.weight.sum()
        residuals = Residuals(X, pairs.loads / size, weight, _limit(self.huber))
        m = nonnegative_weights(residuals, Penalty(np.zeros(5), np.empty((0, 5))))
        self.radius_, self.offset_ = float(m[0] * size), (m[1:3] - m[3:]) * size
        self._center = push @ self.offset_
        radii = np.full(len(places), self.radius_)
        return ContactSum(places, radii, self._center * [1.0, 1.0, pairs.rho])

    def _pushes(self, places: Array) -> Array:
        """Return the load (3, 2) of all actuators per unit of offset along their axes."""
        angle = np.zeros(len(places)) if self.headings is None else self.headings
        angle = as_array("headings", angle, len(places))
        c, s = np.cos(angle), np.sin(angle)
        x, y = places.T
        along = np.array([c, s, x * s - y * c]).sum(axis=1)
        across = np.array([-s, c, x * c + y * s]).sum(axis=1)
        return np.column_stack([along, across])

    def _directions(self, loads: Array) -> Array:
        places = as_array("positions", self.positions, None, 2) / self.rho
        return motions_under(loads + self._center, places, np.full(len(places), self.radius_))


def _limit(value: float) -> float:
    """Return Huber's limit."""
    return np.inf if value == np.inf else as_positive("huber", value)
