r"""The twist of a part that is pushed over contacts with friction: one closest-point problem.

.. math:: v = \arg\min_v\; \tfrac12 v^T Q v + \sum m_i |G_i^T v| - F \cdot v, \qquad
          Q v = F + F_f

with Q diagonal: the drag of quasi-static motion, or the mass, which gives the acceleration from
rest. Scaled by :math:`\rho = \sqrt{Q_3/Q_1}` and by :math:`Q_1` the metric is the identity.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import BLOCK, Contacts
from limitsurf.kernels.contact_problem import (
    BOUND,
    EPS,
    LOAD,
    TWIST,
    WITNESS,
    Problem,
    new_setting,
    second_moments,
)
from limitsurf.kernels.contact_sum import solve_contact_sum
from limitsurf.kernels.contact_totals import new_table

__all__ = ["driven_twist"]

_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@compiled
def driven_twist(
    contacts: Floats,
    force: Floats,
    Q: Floats,
    tol: float,
    best: Floats,
    out: Floats,
) -> tuple[bool, float]:
    """Fill twist and friction; return whether the part sticks, and the certified error.

    Parameters
    ----------
    contacts : (3, n) float
        Positions from the reference point, and friction radii.
    force, Q : (3,) float
        The load F, and the diagonal with ``Q_1 = Q_2``.
    tol : float
        As in `new_setting`.
    best : (15,) float
        From `new_best`, or from a problem nearby, from which to start; receives the answer.
    out : (6,) float
        Receives the twist, exactly zero if the part sticks, and the load of friction.
    """
    n, rho = contacts.shape[1], math.sqrt(Q[2] / Q[0])
    data = np.empty((3, n))
    data[:2], data[2] = contacts[:2] / rho, contacts[2]
    scaled = Contacts(data, 1, None)
    c = force[0], force[1], force[2] / rho
    setting = new_setting(n, second_moments(scaled), _IDENTITY, c, 1.0, tol)
    v = best[WITNESS], best[WITNESS + 1], best[WITNESS + 2]
    table = new_table(n)[: -(-n // BLOCK) + 1]
    solve_contact_sum(Problem(scaled, table, setting), best, v, best[EPS], np.empty((0, 2)))
    sticks = best[TWIST] == 0.0 and best[TWIST + 1] == 0.0 and best[TWIST + 2] == 0.0
    for k in range(3):
        unit = rho if k == 2 else 1.0
        out[3 + k] = -best[LOAD + k] * unit
        out[k] = 0.0 if sticks else (c[k] - best[LOAD + k]) / (Q[0] * unit)
    return sticks, best[BOUND] + setting.rounding
