"""Closest points of many small contact sums at once, a load each."""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.contact_pass import BLOCK, Contacts
from limitsurf.kernels.contact_problem import new_best, second_moments
from limitsurf.kernels.contact_sum import COLD
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.project_loads import Cloud, solve_one
from limitsurf.kernels.vectors import Vector, row

__all__ = ["project_ragged"]

_ZERO = (0.0, 0.0, 0.0)


@compiled
def _shifted(
    x: Floats, y: Floats, m: Floats, offset: Floats, here: Floats
) -> tuple[float, float, Vector]:
    """Fill contacts about their centroid; return it, and the load of the offsets."""
    total = sx = sy = 0.0
    for i in range(x.shape[0]):
        total += m[i]
        sx += m[i] * x[i]
        sy += m[i] * y[i]
    cx, cy = (sx / total, sy / total) if total > 0.0 else (0.0, 0.0)
    fx = fy = moment = 0.0
    for i in range(x.shape[0]):
        here[0, i], here[1, i], here[2, i] = x[i] - cx, y[i] - cy, m[i]
        if offset.shape[0] > 0:
            fx += offset[i, 0]
            fy += offset[i, 1]
            moment += x[i] * offset[i, 1] - y[i] * offset[i, 0]
    return cx, cy, (fx, fy, moment)


@compiled
def project_ragged(
    x: Floats,
    y: Floats,
    m: Floats,
    offset: Floats,
    ptr: Ints,
    points: Floats,
    C: Floats,
    tol: float,
    first: int,
    last: int,
    answers: Floats,
) -> None:
    """Fill a row of answers for each of many small problems with a load each.

    Parameters
    ----------
    x, y, m : (M,) float
        Positions about the reference points and radii; problem k has ``ptr[k]:ptr[k + 1]``.
    offset : (M, 2) or (0, 2) float
        Offsets of the forces.
    ptr : (K + 1,) int
        Where the contacts of a problem begin.
    points, C, tol
        As in `project_loads`, (K, 3) loads.
    first, last : int
        The problems to solve: threads take a range each.
    answers : (K, COLUMNS) float
        Receives the answers.
    """
    most = 0
    for k in range(first, last):
        most = max(most, ptr[k + 1] - ptr[k])
    buffer, few = np.empty(3 * most), Contacts(np.empty((3, 0)), 1, None)
    rows = row(C, 0), row(C, 1), row(C, 2)
    table, none, bests = new_table(most), new_table(0), (new_best(), new_best())
    for k in range(first, last):
        s, n = slice(ptr[k], ptr[k + 1]), ptr[k + 1] - ptr[k]
        own = offset[s] if offset.shape[0] > 0 else offset
        data = buffer[: 3 * n].reshape(3, n)
        cx, cy, center = _shifted(x[s], y[s], m[s], own, data)
        contacts = Contacts(data, 1, None)
        moments = second_moments(contacts)
        cloud = Cloud(contacts, moments, (cx, cy), center, few, moments)
        blocks = table[: -(-n // BLOCK) + 1]
        p = row(points, k)
        solve_one(cloud, (blocks, none), p, rows, tol, _ZERO, COLD, bests, answers[k])
