r"""What holds feet in place, and what happens first when it no longer does.

For a load F and a positive diagonal Q the twist of a part that friction lets go is
:math:`v = Q^{-1}(F - F^*)`, :math:`F^*` the point of the contact sum closest to F in the metric
:math:`Q^{-1}`; it is exactly zero where the load is held (``contact_problem``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Contacts
from limitsurf.kernels.contact_problem import (
    BOUND,
    EPS,
    LOAD,
    TWIST,
    WITNESS,
    Problem,
    new_best,
    new_setting,
    second_moments,
)
from limitsurf.kernels.contact_sum import solve_contact_sum
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.symmetric3 import Symmetric
from limitsurf.kernels.vectors import Vector, along, scaled

__all__ = ["Holder", "closest", "new_holder", "set_quadratic", "size_of"]

_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_TOL = 1e-12  # of the certificates, relative to the sum of the radii and the load
_COLD = -1.0


class Holder(NamedTuple):
    """Contacts scaled by the radius of gyration of a quadratic term Q, and room for answers.

    `places` are the contacts as they are; `numbers` are the second moments of the scaled ones (6),
    first and last entry of Q, and the radius of a ball of scaled loads that are all held.
    """

    places: Floats
    data: Floats
    numbers: Floats
    table: Floats
    best: Floats
    none: Floats


@compiled
def new_holder(places: Floats) -> Holder:
    """Return a holder of contacts, rows x, y, m and for ellipses xx, xy, yy of S; Q is not set."""
    n = places.shape[1]
    return Holder(places, places.copy(), np.zeros(9), new_table(n), new_best(), np.empty((0, 2)))


@compiled
def set_quadratic(holder: Holder, first: float, last: float) -> None:
    """Set ``Q = diag(first, first, last)`` and forget earlier answers."""
    rho, data, places = math.sqrt(last / first), holder.data, holder.places
    for i in range(data.shape[1]):
        data[0, i], data[1, i] = places[0, i] / rho, places[1, i] / rho
    moments = second_moments(Contacts(data, 1, None))
    for k in range(6):
        holder.numbers[k] = moments[k]
    holder.numbers[6], holder.numbers[7] = first, last
    holder.numbers[8] = _held_radius(holder)
    holder.best[EPS] = _COLD


@compiled
def _held_radius(holder: Holder) -> float:
    r"""Return the radius of a ball in the contact sum.

    The support function is :math:`\sum m |P^T d| \ge \sum m |P^T d|^2 / \max |P|`: at least the
    least eigenvalue of the second moments over :math:`\max |P|`, and that eigenvalue is at least
    :math:`4 \det / \mathrm{trace}^2`.
    """
    data, largest2, stretched = holder.data, 0.0, 1.0
    for i in range(data.shape[1]):
        if data.shape[0] > 3:
            stretched = data[3, i] ** 2 + 2.0 * data[4, i] ** 2 + data[5, i] ** 2
        largest2 = max(largest2, stretched * (1.0 + data[0, i] ** 2 + data[1, i] ** 2))
    xx, xy, yy, xw, yw, ww = _moments(holder.numbers)
    det = xx * (yy * ww - yw * yw) - xy * (xy * ww - yw * xw) + xw * (xy * yw - yy * xw)
    trace = xx + yy + ww
    return max(4.0 * det / trace**2, 0.0) / math.sqrt(largest2) if trace > 0.0 else 0.0


@compiled
def _moments(n: Floats) -> Symmetric:
    return n[0], n[1], n[2], n[3], n[4], n[5]


@compiled
def closest(holder: Holder, F: Vector) -> tuple[Vector, Vector, float]:
    """Return the twist and friction of a load in body axes, and the certified bound.

    The bound is in the metric times the first entry of Q: a force [N].
    """
    first, last = holder.numbers[6], holder.numbers[7]
    rho, best = math.sqrt(last / first), holder.best
    contacts = Contacts(holder.data, 1, None)
    c = F[0], F[1], F[2] / rho
    n = holder.data.shape[1]
    setting = new_setting(n, _moments(holder.numbers), _IDENTITY, c, 1.0, _TOL)
    v = best[WITNESS], best[WITNESS + 1], best[WITNESS + 2]
    solve_contact_sum(Problem(contacts, holder.table, setting), best, v, best[EPS], holder.none)
    bound = best[BOUND] + setting.rounding
    if best[TWIST] == 0.0 and best[TWIST + 1] == 0.0 and best[TWIST + 2] == 0.0:
        return (0.0, 0.0, 0.0), scaled(-1.0, F), bound
    held = best[LOAD], best[LOAD + 1], best[LOAD + 2]
    net = scaled(1.0 / first, along(c, -1.0, held))
    return (net[0], net[1], net[2] / rho), (-held[0], -held[1], -held[2] * rho), bound


@compiled
def size_of(holder: Holder, v: Vector) -> float:
    """Return ``|v|_Q`` over the root of the first entry of Q: a speed."""
    ratio = holder.numbers[7] / holder.numbers[6]
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + ratio * v[2] * v[2])
