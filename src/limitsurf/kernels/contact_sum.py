r"""Closest point of a sum of N contacts, with a certificate: the stages put together.

Three unknowns, whatever N; the mathematics is in `contact_problem`, the picture in
``docs/contact_sum.md``. `smooth` finds out what happens, `slide` and `hold` solve for the two
things that can; `pin` and `primal_dual` are for contacts that nearly coincide. Each stage names
the next.
"""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import (
    Contacts,
    contact_velocity,
    kink_of,
    stretch_of,
)
from limitsurf.kernels.contact_problem import (
    BOUND,
    CERTIFIED,
    EPS,
    GAVE_UP,
    HOLD,
    KINK,
    KINK_FORCE,
    PASSES,
    SLIDE,
    SMOOTH,
    WITNESS,
    Problem,
    Witness,
    keep,
    norm,
    residual,
    times_metric,
)
from limitsurf.kernels.contact_slide import pin, slide
from limitsurf.kernels.contact_smooth import hold, smooth, smooth_start
from limitsurf.kernels.kink_step import kink_columns, step_of_solved
from limitsurf.kernels.primal_dual import primal_dual
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = ["COLD", "solve_contact_sum", "witness_forces"]

#: The width eps that a start without a twist has.
COLD = -1.0
_PASSES = 40  # after that many the stages are stopped
_RATIO = 0.3  # contacts that much faster than eps are taken to slide
_ZERO = (0.0, 0.0, 0.0)
_EPS = float(np.finfo(np.float64).eps)


@compiled
def _at_one_place(contacts: Contacts) -> bool:
    """Return whether all contacts with friction are disks at one place, up to rounding."""
    data = contacts.data
    if data.shape[0] > 3:
        return bool(data.shape[1] == 1)
    first = 0
    while first < data.shape[1] - 1 and not data[2, first] > 0.0:
        first += 1
    x, y = data[0, first], data[1, first]
    near = 1e-14 * (abs(x) + abs(y))
    for i in range(first, data.shape[1]):
        if data[2, i] > 0.0 and max(abs(data[0, i] - x), abs(data[1, i] - y)) > near:
            return False
    return True


@compiled
def _alone(problem: Problem, best: Floats) -> None:
    """Solve for contacts that all lie at one place: a single kink, exactly."""
    contacts, setting = problem.contacts, problem.setting
    c, m = setting.c, contacts.data[2]
    first = int(np.argmax(m))
    kink = kink_of(contacts, first, m.sum())
    one, two = kink_columns(kink)
    v, f, still = step_of_solved(
        times_metric(setting, scaled(-1.0, c)),
        times_metric(setting, one),
        times_metric(setting, two),
        kink,
        (0.0, 0.0),
    )
    u = dot(one, v), dot(two, v)
    sliding = 0.0 if still else max(f[0] * u[0] + f[1] * u[1], 0.0)
    # the answer is exact for a load of which the twist has the velocity along f, or zero
    x = _least_twist(one, two, u[0] - sliding * f[0], u[1] - sliding * f[1])
    v = along(v, -1.0, x)
    fx, fy = kink.mass * f[0], kink.mass * f[1]
    load = along(along(_ZERO, fx, one), fy, two)
    left = along(c, -1.0, load)
    best[PASSES] += 1
    witness = Witness(v, 0.0, first, fx, fy)
    if norm(setting, left) <= setting.rounding:
        keep(best, norm(setting, left), load, _ZERO, witness)
    else:
        keep(best, residual(setting, left, v), load, v, witness)


@compiled
def _least_twist(one: Vector, two: Vector, ux: float, uy: float) -> Vector:
    """Return the least x with ``P'x = u``, P the columns one and two; rank one up to rounding."""
    a, b, d = dot(one, one), dot(one, two), dot(two, two)
    det = a * d - b * b
    if det > 16.0 * _EPS * _EPS * (a + d) ** 2:
        ux, uy = (d * ux - b * uy) / det, (a * uy - b * ux) / det
    elif a + d > 0.0:
        ux, uy = ux / (a + d), uy / (a + d)
    return along(scaled(ux, one), uy, two)


@compiled
def _free(problem: Problem, best: Floats) -> None:
    """Answer for contacts without friction: nothing holds the load."""
    v = times_metric(problem.setting, problem.setting.c)
    keep(best, 0.0, _ZERO, v, Witness(v, 0.0, -1, 0.0, 0.0))


@compiled
def solve_contact_sum(problem: Problem, best: Floats, v: Vector, eps: float, room: Floats) -> bool:
    """Fill the best answer; return whether it is certified to the target.

    Parameters
    ----------
    problem, best : Problem, (15,) float
        The problem, and room from `new_best`; what is in `best` is forgotten.
    v, eps : vector, float
        Where to start: `COLD`; or a twist with eps = 0 of a part that slides, or with eps > 0 the
        witness of one that is held.
    room : (N, 2) or (0, 2) float
        Receives the forces if `primal_dual` finds them (then the witness' eps is -1).
    """
    best[BOUND], best[PASSES] = np.inf, 0
    if problem.setting.reach == 0.0:
        _free(problem, best)
        return True
    if _at_one_place(problem.contacts):
        _alone(problem, best)
        return bool(best[BOUND] <= problem.setting.target)
    stage = HOLD if eps > 0.0 else SLIDE
    if eps < 0.0 or not (v[0] != 0.0 or v[1] != 0.0 or v[2] != 0.0):
        stage = SMOOTH
        v, eps = smooth_start(problem.setting)
    ratio = _RATIO
    while stage != CERTIFIED and stage != GAVE_UP and best[PASSES] <= _PASSES:
        if stage == SMOOTH:
            stage, v, eps = smooth(problem, best, v, eps, ratio)
            ratio *= 4.0
        elif stage == HOLD:
            stage, v, eps = hold(problem, best, v, eps)
        else:
            stage, v, eps = slide(problem, best, v)
            if stage == GAVE_UP:
                stage, v, eps = pin(problem, best, v)
            if stage == SLIDE:
                stage, v, eps = slide(problem, best, v)
    if stage != CERTIFIED:
        v, eps = smooth_start(problem.setting)
        primal_dual(problem, best, v, eps, room)
    return bool(best[BOUND] <= problem.setting.target)


@compiled
def witness_forces(contacts: Contacts, best: Floats, forces: Floats) -> None:
    """Fill the forces (N, 2) of the witness of an answer that `primal_dual` did not find."""
    v, eps = (best[WITNESS], best[WITNESS + 1], best[WITNESS + 2]), best[EPS]
    x, y, m, j = contacts.data[0], contacts.data[1], contacts.data[2], int(best[KINK])
    shared, at_kink = 0.0, stretch_of(contacts, max(j, 0))
    for i in range(x.shape[0]):
        ux, uy = contact_velocity(contacts, i, v)
        s = math.sqrt(ux * ux + uy * uy + eps * eps)
        k = m[i] / s if s > 0.0 else 0.0
        forces[i, 0], forces[i, 1] = k * ux, k * uy
        if j >= 0 and x[i] == x[j] and y[i] == y[j] and stretch_of(contacts, i) == at_kink:
            shared += m[i]
    if j < 0 or shared == 0.0:
        return
    for i in range(x.shape[0]):
        if x[i] == x[j] and y[i] == y[j] and stretch_of(contacts, i) == at_kink:
            forces[i, 0] = best[KINK_FORCE] * m[i] / shared
            forces[i, 1] = best[KINK_FORCE + 1] * m[i] / shared
