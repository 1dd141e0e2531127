r"""Contact sum, stages *smooth* and *hold*: Newton's method on kinks rounded off to a width eps."""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Kink
from limitsurf.kernels.contact_problem import (
    BOUND,
    CERTIFIED,
    GAVE_UP,
    HOLD,
    PASSES,
    SLIDE,
    SMOOTH,
    Problem,
    Setting,
    Witness,
    keep,
    norm,
    residual,
    speed,
    times_metric,
)
from limitsurf.kernels.contact_totals import gradient, hessian, smoothed_sums
from limitsurf.kernels.kink_step import kink_columns, snapped, step_of_solved
from limitsurf.kernels.symmetric3 import form, plus, solved, times
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = ["hold", "smooth", "smooth_start"]

_EPS = float(np.finfo(np.float64).eps)
_ZERO = (0.0, 0.0, 0.0)

Next = tuple[int, Vector, float]


@compiled
def _look(problem: Problem, best: Floats, v: Vector, eps: float) -> tuple[float, Vector]:
    """Pass at eps; return ``h_eps`` and ``c - g``, and keep the better certificate."""
    setting = problem.setting
    smoothed_sums(problem.contacts, v, eps, problem.table)
    best[PASSES] += 1
    total = problem.table[problem.table.shape[0] - 1]
    g = gradient(problem.table)
    left = along(setting.c, -1.0, g)
    witness = Witness(v, eps, -1, 0.0, 0.0)
    # m (|u| - |u|^2/s) = m |u| eps^2 / (s (s + |u|)) <= m eps^2 / (2 s)
    gap = eps * eps * total[10]
    keep(best, math.sqrt(residual(setting, left, v) ** 2 + gap), g, v, witness)
    keep(best, norm(setting, left), g, _ZERO, witness)
    return total[0], left


@compiled
def _as_one(setting: Setting) -> Vector:
    """Return the twist if all friction were at its centroid."""
    m = setting.reach
    x, y = setting.moments[4] / m, -setting.moments[3] / m
    kink = Kink(0, m, x, y, (1.0, 0.0, 1.0))
    one, two = kink_columns(kink)
    v, _, still = step_of_solved(
        times_metric(setting, scaled(-1.0, setting.c)),
        times_metric(setting, one),
        times_metric(setting, two),
        kink,
        (0.0, 0.0),
    )
    return snapped(kink, v) if still else v


@compiled
def smooth_start(setting: Setting) -> tuple[Vector, float]:
    """Return the twist of all kinks smoothed to parabolas, and their width eps.

    eps is the least of three speeds: what all friction together could stop, that without friction,
    and that with all friction in one place.
    """
    eps = setting.reach * setting.unit * setting.unit
    for v in (times_metric(setting, setting.c), _as_one(setting)):
        moving = speed(setting, v)
        if moving > 0.0:
            eps = min(eps, moving)
    _, v = solved(plus(setting.Q, 1.0 / eps, setting.moments), setting.c)
    return v, eps


@compiled
def smooth(problem: Problem, best: Floats, v: Vector, eps: float, ratio: float) -> Next:
    r"""Newton's method on the smoothed dual while eps falls, until it is clear what happens.

    It slides if the contacts move much faster than eps, at least `ratio` times. It may be held if
    they do not and a step without the quadratic term is short: see `hold`.
    """
    setting = problem.setting
    value_old, slope, share = np.inf, 0.0, 1.0
    step = _ZERO
    for _ in range(60):
        trial = along(v, share, step)
        h, left = _look(problem, best, trial, eps)
        if best[BOUND] <= setting.target:
            return CERTIFIED, trial, eps
        value = h - dot(setting.c, trial) + 0.5 * form(setting.Q, trial)
        noise = 8.0 * _EPS * (abs(h) + abs(value))
        if value > value_old + 1e-4 * share * slope + noise and share > 1e-3:
            share *= 0.4
            continue
        v = trial
        moving, H = speed(setting, v), hessian(problem.table)
        ok, correction = solved(H, left)
        short = ok and speed(setting, correction) <= 0.7 * (eps + 0.3 * moving)
        if short and moving < 30.0 * eps:
            return HOLD, along(v, 1.0, correction), eps
        rest = along(left, -1.0, times(setting.Q, v))
        ok, step = solved(plus(H, 1.0, setting.Q), rest)
        if not ok:
            return GAVE_UP, v, eps
        slope, share, value_old = -dot(rest, step), 1.0, value
        far = speed(setting, step)
        if far <= 0.5 * max(moving, eps):
            v, step = along(v, 1.0, step), _ZERO
            if speed(setting, v) > ratio * eps:
                return SLIDE, v, eps
            eps *= 0.1 if far <= 0.1 * max(moving, eps) else 0.25
            value_old = np.inf
    return GAVE_UP, v, eps


@compiled
def hold(problem: Problem, best: Floats, v: Vector, eps: float) -> Next:
    r"""Balance the load by forces: minimise :math:`h_\epsilon(v) - c^T v` by Newton's method.

    A minimiser exists just where c lies inside the sum; there :math:`g = c`. It scales with eps, so
    that eps need not be small. Where v runs away the load lies outside, or nearly so.
    """
    setting = problem.setting
    value_old, slope, share, step = np.inf, 0.0, 1.0, _ZERO
    for iteration in range(25):
        trial = along(v, share, step)
        h, left = _look(problem, best, trial, eps)
        if best[BOUND] <= setting.target:
            return CERTIFIED, trial, eps
        value = h - dot(setting.c, trial)
        noise = 4.0 * _EPS * (abs(h) + abs(value))
        if value > value_old + 1e-4 * share * slope + noise and share > 1e-3:
            share *= 0.4
            continue
        v, value_old = trial, value
        moving = speed(setting, v)
        ok, step = solved(hessian(problem.table), left)
        if not ok or moving > 1e9 * eps:
            break
        slope, far = -dot(left, step), speed(setting, step)
        if iteration > 6 and moving > 50.0 * eps and far > 0.5 * moving:
            break
        share = min(1.0, 2.0 * (moving + eps) / max(far, 1e-300))
    return (SLIDE if speed(setting, v) > 3.0 * eps else SMOOTH), v, eps
