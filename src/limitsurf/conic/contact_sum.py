"""Closest point of a sum of Coulomb disks as a conic program: the slow twin of the kernel."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import SolveFailed

__all__ = ["closest_contact_load"]

Array = NDArray[np.float64]


def closest_contact_load(position: ArrayLike, radius: ArrayLike, load: ArrayLike) -> Array:
    r"""Return the point of ``sum_i G_i {f : |f| <= m_i}`` closest to a load.

    .. math::
        \min_f \tfrac12 \Big| \sum_i G_i f_i - c \Big|^2 \quad \text{s.t. } |f_i| \le m_i,
        \qquad G f = (f_x, f_y, x f_y - y f_x)

    Parameters
    ----------
    position : (N, 2) float
        Contact positions, in units in which the metric is the identity.
    radius : (N,) float
        Disk radii m_i >= 0.
    load : (3,) float
        The load c.

    Raises
    ------
    SolveFailed
        Clarabel did not reach its tolerances.
    """
    import cvxpy as cp

    x, y = np.asarray(position, dtype=np.float64).T
    force = cp.Variable((len(x), 2))
    total = cp.hstack([cp.sum(force[:, 0]), cp.sum(force[:, 1]), x @ force[:, 1] - y @ force[:, 0]])
    program = cp.Problem(
        cp.Minimize(0.5 * cp.sum_squares(total - np.asarray(load))),
        [cp.norm(force, axis=1) <= np.asarray(radius)],
    )
    tight = {"tol_gap_abs": 1e-10, "tol_gap_rel": 1e-10, "tol_feas": 1e-10}
    program.solve(solver=cp.CLARABEL, **tight)
    if program.status != cp.OPTIMAL:
        raise SolveFailed(f"Clarabel ended with status {program.status}")
    return np.asarray(total.value, dtype=np.float64)
