r"""Closest points of a contact sum for many loads.

Contacts are given about their centroid, where velocities are differences of small numbers; loads,
metric and twists about the reference point are carried over and back:

.. math:: m' = m - c_x f_y + c_y f_x, \qquad C' = C T^{-1}, \qquad v = T^T v' .
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
    KINK,
    LOAD,
    PASSES,
    TWIST,
    WITNESS,
    Problem,
    Rows,
    Setting,
    new_best,
    new_setting,
    second_moments,
    times_rows,
)
from limitsurf.kernels.contact_sum import COLD, solve_contact_sum, witness_forces
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.symmetric3 import Symmetric
from limitsurf.kernels.vectors import Vector, along, dot, row

__all__ = [
    "BOUNDS",
    "COLUMNS",
    "COUNTS",
    "DISTANCES",
    "FAILED",
    "HELD_BY_FEW",
    "NORMALS",
    "POINTS",
    "STATUSES",
    "TWISTS",
    "WITNESSES",
    "Cloud",
    "about_centroid",
    "cloud_of",
    "contact_forces",
    "contact_numbers",
    "project_loads",
    "solve_few",
    "solve_one",
    "unit_force",
    "write_answer",
]

# columns of a row of answers; a witness is v, eps, kink, fx, fy
POINTS, NORMALS, TWISTS, WITNESSES = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 16)
DISTANCES, BOUNDS, COUNTS, STATUSES, COLUMNS = 16, 17, 18, 19, 20
_OUTSIDE, _INSIDE, FAILED, _LOOSE = 0, 1, 2, 3
_WRONG = 1e-6  # a bound above this, relative to the size, is no answer
HELD_BY_FEW = -2
_ZERO = (0.0, 0.0, 0.0)
_EPS = float(np.finfo(np.float64).eps)


class Cloud(NamedTuple):
    """Contacts about their centroid, the load of their offsets, and a few that stand for many.

    The sum over the few, each at the centroid of those it stands for, lies in the sum (Jensen's
    inequality): what it holds is held. There are none of them if the contacts are few.
    """

    contacts: Contacts
    moments: Symmetric
    centroid: tuple[float, float]
    center: Vector
    few: Contacts
    few_moments: Symmetric


@compiled
def contact_numbers(data: Floats, few: Floats) -> Floats:
    """Return the second moments of contacts and few, and room for `centroid` and `center`."""
    numbers = np.zeros(17)
    moments, others = (
        second_moments(Contacts(data, 1, None)),
        second_moments(Contacts(few, 1, None)),
    )
    for k in range(6):
        numbers[k], numbers[6 + k] = moments[k], others[k]
    return numbers


@compiled
def cloud_of(data: Floats, few: Floats, n: Floats, threads: int) -> Cloud:
    """Return the cloud of arrays as `project_loads` takes them."""
    return Cloud(
        Contacts(data, threads, None),
        (n[0], n[1], n[2], n[3], n[4], n[5]),
        (n[12], n[13]),
        (n[14], n[15], n[16]),
        Contacts(few, 1, None),
        (n[6], n[7], n[8], n[9], n[10], n[11]),
    )


@compiled
def about_centroid(cloud: Cloud, p: Vector, C: Rows) -> tuple[Vector, Rows]:
    """Return the load without the center, and the factor of the metric, about the centroid."""
    cx, cy = cloud.centroid
    free = along(p, -1.0, cloud.center)
    a, b, c = C
    rows = (
        (a[0] - cy * a[2], a[1] + cx * a[2], a[2]),
        (b[0] - cy * b[2], b[1] + cx * b[2], b[2]),
        (c[0] - cy * c[2], c[1] + cx * c[2], c[2]),
    )
    return (free[0], free[1], free[2] - cx * free[1] + cy * free[0]), rows


@compiled
def unit_force(C: Rows) -> float:
    """Return the norm of a unit force, averaged over directions."""
    square = 0.0
    for i in range(3):
        square += C[i][0] ** 2 + C[i][1] ** 2
    return math.sqrt(0.5 * square)


@compiled
def solve_few(
    cloud: Cloud, table: Floats, here: Rows, c: Vector, unit: float, tol: float, best: Floats
) -> tuple[bool, Vector, float]:
    """Solve for the few; return whether they hold the load, else where all may start."""
    n = cloud.few.data.shape[1]
    setting = new_setting(n, cloud.few_moments, here, c, unit, tol)
    problem = Problem(cloud.few, table, setting)
    held = solve_contact_sum(problem, best, _ZERO, COLD, np.empty((0, 2)))
    held = held and best[TWIST] == best[TWIST + 1] == best[TWIST + 2] == 0.0
    v = best[WITNESS], best[WITNESS + 1], best[WITNESS + 2]
    return held, v, max(best[EPS], 0.0)


@compiled
def solve_one(
    cloud: Cloud,
    tables: tuple[Floats, Floats],
    p: Vector,
    C: Rows,
    tol: float,
    v: Vector,
    eps: float,
    bests: tuple[Floats, Floats],
    answer: Floats,
) -> None:
    """Fill the row of one answer; v, eps is where to start, about the centroid."""
    c, here = about_centroid(cloud, p, C)
    unit, none = unit_force(C), np.empty((0, 2))
    best, fewer = bests
    setting = new_setting(cloud.contacts.data.shape[1], cloud.moments, here, c, unit, tol)
    problem, held = Problem(cloud.contacts, tables[0], setting), False
    if eps < 0.0 and cloud.few.data.shape[1] > 0:
        held, v, eps = solve_few(cloud, tables[1], here, c, unit, tol, fewer)
    if held:
        best[:] = fewer
        best[PASSES], best[KINK] = 0.0, HELD_BY_FEW
    else:
        solve_contact_sum(problem, best, v, eps, none)
    write_answer(cloud, setting, tol, p, C, best, answer)


@compiled
def write_answer(
    cloud: Cloud, setting: Setting, tol: float, p: Vector, C: Rows, best: Floats, answer: Floats
) -> None:
    """Carry the best answer back to the reference point."""
    cx, cy = cloud.centroid
    load = best[LOAD], best[LOAD + 1], best[LOAD + 2]
    v = best[TWIST], best[TWIST + 1], best[TWIST + 2]
    inside = v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0
    x = (
        load[0] + cloud.center[0],
        load[1] + cloud.center[1],
        load[2] + cx * load[1] - cy * load[0] + cloud.center[2],
    )
    e = along(p, -1.0, x)
    z = times_rows(C, e)
    W_e = along(along(along(_ZERO, z[0], C[0]), z[1], C[1]), z[2], C[2])
    size = math.sqrt(dot(W_e, W_e))
    for k in range(3):
        answer[k] = p[k] if inside else x[k]
        answer[3 + k] = 0.0 if inside or size == 0.0 else W_e[k] / size
    answer[6], answer[7], answer[8] = -(v[0] + v[2] * cy), -(v[1] - v[2] * cx), -v[2]
    for k in range(7):
        answer[9 + k] = best[WITNESS + k]
    total = best[BOUND] + setting.rounding if setting.reach > 0.0 else 0.0
    if setting.reach > 0.0:  # the center is taken off and added again, and may be large
        square, a = 0.0, cloud.center
        for b in C:
            square += (abs(b[0] * a[0]) + abs(b[1] * a[1]) + abs(b[2] * a[2])) ** 2
        total += 2.0 * _EPS * math.sqrt(square)
    answer[16] = 0.0 if inside else math.sqrt(dot(z, z))
    answer[17], answer[18] = total, best[PASSES]
    answer[19] = _INSIDE if inside else _OUTSIDE
    if not (total <= max(_WRONG, tol) * setting.scale and total < np.inf):
        answer[19] = FAILED
    elif total > tol * setting.scale:
        answer[19] = _LOOSE


@compiled
def project_loads(
    data: Floats,
    few: Floats,
    numbers: Floats,
    points: Floats,
    C: Floats,
    starts: Floats,
    tol: float,
    threads: int,
) -> tuple[Floats, int]:
    """Return a row of answers (k, COLUMNS) for each load, and how many failed.

    Parameters
    ----------
    data, few : (3, N) or (6, N) float
        Rows x, y, m about the centroid, and for ellipses ``xx, xy, yy`` of their stretch; and
        the few that stand for them, (3, 0) if there are none.
    numbers : (17,) float
        From `contact_numbers`, then centroid (2) and center (3).
    points : (k, 3) float
        Loads about the reference point.
    C : (3, 3) float
        A factor of the metric about the reference point, ``W = C'C``.
    starts : (k, 4) or (0, 4) float
        Twist about the centroid and width eps to start from; eps = -1 if none is known.
    tol : float
        Error bound asked for, relative to the sum of the radii and the load.
    threads : int
        Threads for one pass.
    """
    cloud = cloud_of(data, few, numbers, threads)
    rows = row(C, 0), row(C, 1), row(C, 2)
    answers = np.empty((points.shape[0], COLUMNS))
    tables, bests = (new_table(data.shape[1]), new_table(few.shape[1])), (new_best(), new_best())
    v, eps, failed = _ZERO, COLD, 0
    for k in range(points.shape[0]):
        if starts.shape[0] > 0:
            v, eps = row(starts, k), starts[k, 3]
        p = row(points, k)
        solve_one(cloud, tables, p, rows, tol, v, eps, bests, answers[k])
        failed += answers[k, STATUSES] == FAILED
    return answers, failed


@compiled
def contact_forces(
    data: Floats,
    few: Floats,
    numbers: Floats,
    point: Floats,
    C: Floats,
    witness: Floats,
    tol: float,
) -> Floats:
    """Return the forces (N, 2), along the axes of S, of an answer of `project_loads`.

    They follow from the witness, unless the few stood for all or `primal_dual` found the answer:
    then the problem is solved once more.
    """
    cloud = cloud_of(data, few, numbers, 1)
    contacts, best = cloud.contacts, new_best()
    forces = np.zeros((data.shape[1], 2))
    best[WITNESS:PASSES] = witness
    if witness[4] == HELD_BY_FEW or witness[3] < 0.0:
        rows = row(C, 0), row(C, 1), row(C, 2)
        c, here = about_centroid(cloud, (point[0], point[1], point[2]), rows)
        table = new_table(data.shape[1])
        setting = new_setting(data.shape[1], cloud.moments, here, c, unit_force(rows), tol)
        problem = Problem(contacts, table, setting)
        v = witness[0], witness[1], witness[2]
        solve_contact_sum(problem, best, v, witness[3], forces)
    if best[EPS] >= 0.0:
        witness_forces(contacts, best, forces)
    return forces
