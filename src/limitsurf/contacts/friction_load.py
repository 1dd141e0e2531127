r"""The frictional load on a part: the point of its limit surface closest to what pulls at it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import SolveFailed
from limitsurf.sets.arguments import as_array, as_points, read_metric
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.projection import Projection

__all__ = ["Dissipation", "FrictionLoad", "friction_load"]

Array = NDArray[np.float64]

_STEPS = 60
_EPS = float(np.finfo(np.float64).eps)


class Dissipation(Protocol):
    """A smooth convex potential of the twist, such as that of rate-dependent contacts."""

    def potential(self, v: Array) -> Any:
        """Return Phi(v), v of shape (3,)."""

    def gradient(self, v: Array) -> Array:
        """Return the gradient (3,): minus the load on the part."""

    def hessian(self, v: Array) -> Array:
        """Return the Hessian (3, 3)."""


@dataclass(frozen=True, eq=False)
class FrictionLoad:
    """What friction does to a part under an external load.

    Attributes
    ----------
    friction : (..., 3) float
        Load of the contacts on the part [N, N, N m].
    net : (..., 3) float
        External load plus friction, and plus `rate`; zero if the part sticks.
    sticks : (...,) bool
        Whether the part stays at rest: minus the external load lies in the limit surface.
    projection : Projection
        The closest point behind it, with twist and certified error.
    rate : (3,) float or None
        Load of the rate-dependent contacts.
    """

    friction: Array
    net: Array
    sticks: NDArray[np.bool_]
    projection: Projection
    rate: Array | None = None

    @property
    def twist(self) -> Array:
        """Twist (..., 3): ``W net``, zero if the part sticks."""
        return self.projection.twist

    def __repr__(self) -> str:
        """Return the friction, or the number of loads."""
        if self.friction.ndim > 1:
            return f"FrictionLoad({self.sticks.size} loads, {int(self.sticks.sum())} stick)"
        where = np.array2string(self.friction, precision=6, separator=", ")
        return f"FrictionLoad({where}, {'sticks' if self.sticks else 'slides'})"


def friction_load(
    surface: ConvexSet | ContactSet,
    external: ArrayLike,
    metric: ArrayLike | None = None,
    *,
    dissipation: Dissipation | None = None,
) -> FrictionLoad:
    r"""Return the frictional load on a part from rest.

    .. math:: F_f = \arg\min_{F \in L} \tfrac12 |F + F_{ext}|_W^2, \qquad
              W^{-1} v = F_{ext} + F_f

    Parameters
    ----------
    surface : ConvexSet or ContactSet
        Limit surface L: loads that the contacts can exert on the part.
    external : (..., 3) float
        External loads [N, N, N m].
    metric : (3, 3) or (3,) float, optional
        W; physically the inverse inertia ``diag(1/mass, 1/mass, 1/J)``.
    dissipation : Dissipation, optional
        Rate-dependent contacts: :math:`\Phi` is added to the dual,
        :math:`W^{-1} v = F_{ext} + F_f - \nabla\Phi(v)`. One load, shape (3,).

    Examples
    --------
    >>> block = ContactSet([[0.1, 0.1], [0.1, -0.1], [-0.1, 0.1], [-0.1, -0.1]], 0.5)
    >>> friction_load(block, [3.0, 0.0, 0.0]).net.round(12)
    array([1., 0., 0.])
    >>> friction_load(block, [1.5, 0.0, 0.0]).sticks
    array(True)
    """
    if dissipation is not None:
        return _with_dissipation(surface, as_array("external", external, 3), metric, dissipation)
    rows, shape = as_points("external", external, 3)
    load = rows.reshape(*shape, 3)
    projection = surface.project(-load, metric)
    friction = projection.point
    sticks = np.asarray(~projection.twist.any(axis=-1))
    net = np.where(sticks[..., None], 0.0, load + friction)
    return FrictionLoad(friction, net, sticks, projection)


def _with_dissipation(
    surface: ConvexSet | ContactSet, F: Array, metric: ArrayLike | None, smooth: Dissipation
) -> FrictionLoad:
    r"""Minimise :math:`\tfrac12 v^T W^{-1} v + h_L(-v) + \Phi(v) - F^T v` by proximal Newton steps.

    :math:`\Phi` is replaced by its quadratic model at v; what remains is a projection in the metric
    :math:`(W^{-1} + \nabla^2\Phi)^{-1}`, steps of which are shortened until the value falls.
    """
    limit = surface.limit_surface() if isinstance(surface, ContactSet) else surface
    Q = np.linalg.inv(read_metric(metric, 3).W)
    v, projection = np.zeros(3), None

    def value(v: Array) -> float:
        own = 0.5 * v @ Q @ v + smooth.potential(v) - F @ v
        return float(own + limit.support(-v))

    lowest, share, rest = value(v), 1.0, F
    for _ in range(_STEPS):
        g, B = smooth.gradient(v), smooth.hessian(v)
        projection = limit.project(-(F - g + B @ v), np.linalg.inv(Q + 0.5 * (B + B.T)))
        step, share = projection.twist - v, 1.0
        noise = 16.0 * _EPS * (abs(lowest) + abs(F @ v))
        while value(v + share * step) > lowest + noise and share > 1e-6:
            share *= 0.5
        v = v + share * step
        lowest = value(v)
        rest = F + projection.point - smooth.gradient(v) - Q @ v
        if share == 1.0 and np.linalg.norm(rest) <= 1e-12 * (np.linalg.norm(F) + abs(lowest)):
            break
    assert projection is not None
    rate = -smooth.gradient(v)
    left, size = (
        float(np.sqrt(sum(x @ np.linalg.solve(Q, x) for x in loads)))
        for loads in ((rest,), (F, projection.point, rate))
    )
    if not left <= 1e-6 * size:
        raise SolveFailed("friction_load: the dissipation is not smooth and convex", best=v)
    friction = projection.point
    left, *parts = (float(np.sqrt(x @ np.linalg.solve(Q, x))) for x in (rest, F, rate, friction))
    if left > 1e-6 * sum(parts):
        raise SolveFailed("friction_load: the dissipation is not smooth and convex", best=v)
    sticks = np.asarray(not v.any())
    net = F + friction + rate
    return FrictionLoad(friction, net, sticks, projection, rate)
