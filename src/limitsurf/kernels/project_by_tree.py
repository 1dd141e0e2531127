"""Closest points of large contact sums in less than linear time: `slide` on sums by moments.

The few that stand for many say where to start; the sums of `moment_tree` come with a bound on their
error, which the certificate contains. What they cannot certify the direct sums do, from there.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Contacts, Tree
from limitsurf.kernels.contact_problem import (
    BOUND,
    CERTIFIED,
    EPS,
    HOLD,
    KINK,
    PASSES,
    Problem,
    new_best,
    new_setting,
)
from limitsurf.kernels.contact_slide import slide
from limitsurf.kernels.contact_sum import COLD, solve_contact_sum
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.moment_tree_build import MomentTree
from limitsurf.kernels.project_loads import (
    COLUMNS,
    FAILED,
    HELD_BY_FEW,
    STATUSES,
    Cloud,
    about_centroid,
    cloud_of,
    solve_few,
    unit_force,
    write_answer,
)
from limitsurf.kernels.vectors import Vector, row

__all__ = ["project_by_tree"]

_ZERO = (0.0, 0.0, 0.0)
_TAIL = 0.3  # share of the tolerance that the tails of the cells may take together


@compiled
def project_by_tree(
    data: Floats,
    few: Floats,
    numbers: Floats,
    moments: MomentTree,
    points: Floats,
    C: Floats,
    starts: Floats,
    tol: float,
    threads: int,
) -> tuple[Floats, int]:
    """Return answers as `project_loads` does; `data` is in the order of the tree.

    Their passes are evaluations of the tree, and direct passes where these were needed.
    """
    cloud, none = cloud_of(data, few, numbers, threads), np.empty((0, 2))
    n = data.shape[1]
    by_tree = Contacts(data, threads, Tree(moments, _TAIL * tol))
    rows = row(C, 0), row(C, 1), row(C, 2)
    answers, failed = np.empty((points.shape[0], COLUMNS)), 0
    table, small, few_table = new_table(n), new_table(0), new_table(few.shape[1])
    best, fewer = new_best(), new_best()
    v, eps = _ZERO, COLD
    for k in range(points.shape[0]):
        p = row(points, k)
        c, here = about_centroid(cloud, p, rows)
        unit = unit_force(rows)
        setting = new_setting(n, cloud.moments, here, c, unit, tol)
        if starts.shape[0] > 0:
            v, eps = row(starts, k), starts[k, 3]
        held = False
        if eps != 0.0:
            held, v, eps = solve_few(cloud, few_table, here, c, unit, tol, fewer)
        if held:
            best[:] = fewer
            best[PASSES], best[KINK] = 0.0, HELD_BY_FEW
        else:
            _solve(Problem(by_tree, small, setting), cloud, table, best, v, eps, none)
        write_answer(cloud, setting, tol, p, rows, best, answers[k])
        failed += answers[k, STATUSES] == FAILED
    return answers, failed


@compiled
def _solve(
    by_tree: Problem,
    cloud: Cloud,
    table: Floats,
    best: Floats,
    v: Vector,
    eps: float,
    none: Floats,
) -> None:
    """Slide by the tree; go on by direct sums if that does not certify the answer."""
    setting = by_tree.setting
    best[BOUND], best[PASSES], best[EPS] = np.inf, 0.0, COLD
    stage, width = HOLD, eps
    if eps == 0.0:
        stage, v, width = slide(by_tree, best, v)
    if stage == CERTIFIED:
        return
    evaluations = best[PASSES]
    direct = Problem(cloud.contacts, table, setting)
    solve_contact_sum(direct, best, v, width if stage == HOLD else 0.0, none)
    best[PASSES] += evaluations
