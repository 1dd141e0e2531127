r"""Contact sum, stages *slide* and *pin*: the twist of a part that moves, with its kinks."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_pass import Kink, contact_velocity, kink_of
from limitsurf.kernels.contact_problem import (
    CERTIFIED,
    GAVE_UP,
    HOLD,
    PASSES,
    SLIDE,
    Problem,
    Setting,
    Witness,
    keep,
    residual,
    speed,
    times_metric,
)
from limitsurf.kernels.contact_totals import (
    always_curved,
    exact_sums,
    gradient,
    hessian,
)
from limitsurf.kernels.kink_step import FLAT, Pair, axes_of, kink_columns, kink_step, snapped
from limitsurf.kernels.symmetric3 import form, plus, plus_outer, solved, times
from limitsurf.kernels.vectors import Vector, along, dot, length, scaled

__all__ = ["pin", "slide"]

_EPS = float(np.finfo(np.float64).eps)
_PINS = 8
_LAST = 1e-5  # residual, relative to the size, which the next step should square
_FIRST, _FINE = 1e-6, 1e-12  # errors allowed in sums that are not the last, per unit of friction

Next = tuple[int, Vector, float]


class Look(NamedTuple):
    """What a pass at the direction d shows: see `_look`."""

    kink: Kink
    one: Vector
    two: Vector
    u: Pair
    t: float
    Qd: Vector
    left: Vector
    rest: Vector
    noise: float
    bound: float


@compiled
def _force_at_rest(setting: Setting, kink: Kink, rest: Vector) -> Pair:
    """Return f in the unit disk with ``|rest - m P f|_W`` least, or nearly so at its rim."""
    one, two = kink_columns(kink)
    w1, w2 = times_metric(setting, one), times_metric(setting, two)
    high, low, cos, sin = axes_of(dot(one, w1), dot(one, w2), dot(two, w2))
    p, q = dot(w1, rest) / kink.mass, dot(w2, rest) / kink.mass
    a = (cos * p + sin * q) / high
    b = (cos * q - sin * p) / low if low > FLAT * high else 0.0
    size = max(length(a, b), 1.0)
    return (cos * a - sin * b) / size, (sin * a + cos * b) / size


@compiled
def _kink_force(
    setting: Setting, kink: Kink, u: Pair, left: Vector, v: Vector, f: Pair, same: bool
) -> tuple[float, Vector, Pair]:
    """Return the bound, what is left of the load, and the kink's force, for the better of two.

    One is the force of its velocity, or at rest that nearest to what is left; the other the
    multiplier f of the step that led here. `left` is c less the forces of the other contacts.
    """
    one, two = kink_columns(kink)
    m, size = kink.mass, length(u[0], u[1])
    if size > 0.0:
        e = u[0] / size, u[1] / size
    else:
        e = _force_at_rest(setting, kink, along(left, -1.0, times(setting.Q, v)))
    rest = along(along(left, -m * e[0], one), -m * e[1], two)
    bound = residual(setting, rest, v)
    if not same or size == 0.0:
        return bound, rest, e
    other = along(along(left, -m * f[0], one), -m * f[1], two)
    # 2 (|u| - f.u) without cancellation, f in the unit disk
    apart = (e[0] - f[0]) ** 2 + (e[1] - f[1]) ** 2 + max(1.0 - f[0] * f[0] - f[1] * f[1], 0.0)
    gap = m * length(dot(one, v), dot(two, v)) * apart
    second = math.sqrt(residual(setting, other, v) ** 2 + gap)
    return (second, other, f) if second < bound else (bound, rest, e)


@compiled
def _look(problem: Problem, best: Floats, d: Vector, f: Pair, before: int, blur: float) -> Look:
    r"""Pass at d, :math:`d^T Q d = 1`, and keep the certificate of the twist :math:`\psi(d)\, d`.

    `u` is the kink's velocity, zero if it is rounding; `t` is :math:`\psi(d)`; `left` is c less the
    forces of the other contacts, `rest` less the kink's too. f is the kink's force in the step that
    led here, if the kink is still contact `before`.
    """
    setting = problem.setting
    c = setting.c
    tau = abs(d[2]) * setting.spacing
    kink, slack, unsure = exact_sums(problem.contacts, d, tau, blur, problem.table)
    best[PASSES] += 1
    one, two = kink_columns(kink)
    u = dot(one, d), dot(two, d)
    size = length(u[0], u[1])
    arms = abs(d[0]) + abs(d[1]) + abs(d[2]) * (abs(kink.x) + abs(kink.y))
    if size <= 4.0 * _EPS * arms:
        u, size = (0.0, 0.0), 0.0
    h = problem.table[problem.table.shape[0] - 1, 0] + kink.mass * size
    t = dot(c, d) - h
    left = along(c, -1.0, gradient(problem.table))
    v, rest, force = scaled(max(t, 0.0), d), left, (0.0, 0.0)
    if kink.contact >= 0:
        bound, rest, force = _kink_force(setting, kink, u, left, v, f, kink.contact == before)
    else:
        bound = residual(setting, left, v)
    if slack > 0.0:  # |C e| for the error e of the sums, in the residual and in the point
        C = setting.C
        bound += 2.0 * slack * math.sqrt(dot(C[0], C[0]) + dot(C[1], C[1]) + dot(C[2], C[2]))
    witness = Witness(d, 0.0, kink.contact, kink.mass * force[0], kink.mass * force[1])
    keep(best, bound, along(c, -1.0, rest), v, witness)
    noise = 4.0 * _EPS * (h + abs(dot(c, d))) + unsure
    return Look(kink, one, two, u, t, times(setting.Q, d), left, rest, noise, bound)


@compiled
def _newton_on_sphere(problem: Problem, look: Look) -> tuple[bool, Vector, Pair, bool, float]:
    """Return whether it worked, the step, the kink's force, whether it stops, and the decrease.

    Where the kink's velocity hardly changes its force is linearised too: near the solution that
    is more precise than the exact step, which adds large terms of opposite sign.
    """
    kink, one, two, u, t = look.kink, look.one, look.two, look.u, look.t
    setting = problem.setting
    H = plus(hessian(problem.table), abs(t), setting.Q)
    B = plus_outer(H, setting.reach * setting.unit + abs(t), look.Qd)
    b = along(scaled(t, look.Qd), -1.0, look.left)
    ok, step, f, still = kink_step(B, b, kink, u)
    expected = dot(b, step)
    if kink.contact < 0 or not ok:
        return ok, step, f, False, expected
    p = u[0] + dot(one, step), u[1] + dot(two, step)
    size = length(u[0], u[1])
    if still or length(p[0] - u[0], p[1] - u[1]) >= 0.5 * size:
        return ok, step, f, still, expected + kink.mass * (length(p[0], p[1]) - size)
    e = u[0] / size, u[1] / size
    b = along(along(b, kink.mass * e[0], one), kink.mass * e[1], two)
    across = along(scaled(-e[1], one), e[0], two)
    ok, step = solved(plus_outer(B, kink.mass / size, across), scaled(-1.0, b))
    turn = dot(across, step) / size
    longer = length(1.0, turn)
    f = (e[0] - turn * e[1]) / longer, (e[1] + turn * e[0]) / longer
    return ok, step, f, False, dot(b, step)


@compiled
def _on_sphere(setting: Setting, v: Vector) -> Vector:
    return scaled(1.0 / math.sqrt(form(setting.Q, v)), v)


@compiled
def _width(problem: Problem, look: Look, d: Vector) -> float:
    """Return eps with which `hold` starts: at ``c - g ~ t`` it is sqrt(2 |t| / sum m/|u|)."""
    setting = problem.setting
    k = problem.table[problem.table.shape[0] - 1, 10]
    if look.kink.contact >= 0:
        k += look.kink.mass / max(length(look.u[0], look.u[1]), 1e-3 * speed(setting, d))
    return math.sqrt(2.0 * max(-look.t, setting.target / setting.unit) / k)


@compiled
def slide(problem: Problem, best: Floats, v: Vector) -> Next:
    r"""Maximise :math:`\psi(d) = c^T d - h(d)` over :math:`d^T Q d = 1` by Newton's method.

    h is homogeneous: the twist is :math:`\psi(d)\, d` and the distance :math:`\psi(d)`, however
    small. The contact nearest to the centre of rotation keeps its kink in every step (`kink_step`).
    """
    setting = problem.setting
    d = _on_sphere(setting, v)
    look = _look(problem, best, d, (0.0, 0.0), -1, _FIRST)
    stalled, least, curved = 0, np.inf, always_curved(problem.contacts.tree)
    for _ in range(40):
        if look.bound <= setting.target:
            return CERTIFIED, d, 0.0
        off = residual(setting, look.rest, scaled(look.t, d))
        stalled = 0 if off < 0.5 * least else stalled + 1
        least = min(least, off)
        if look.t < 0.0 and off <= -0.2 * look.t:
            return HOLD, d, _width(problem, look, d)
        ok, step, f, still, expected = _newton_on_sphere(problem, look)
        if not ok and look.t < 0.0:
            return HOLD, d, _width(problem, look, d)
        if not ok or stalled > 3:
            break
        share = min(1.0, 1.0 / math.sqrt(max(form(setting.Q, step), 1e-300)))
        kink, lowest = look.kink, look.t - look.noise
        blur = 0.0  # the next step should do
        if off > _LAST * setting.scale:
            blur = min(_FIRST, 1e-2 * (off / setting.scale) ** 2 + _FINE)
        for _ in range(6):
            trial = along(d, share, step)
            if still and share == 1.0 and kink.stretch == (1.0, 0.0, 1.0):
                trial = snapped(kink, trial)
            trial = _on_sphere(setting, trial)
            look = _look(problem, best, trial, f, kink.contact, blur)
            if blur == 0.0 and look.bound > setting.target and not curved:
                blur = _FINE
                look = _look(problem, best, trial, f, kink.contact, blur)
            if look.t >= lowest - look.noise - 1e-4 * share * expected:
                break
            share *= 0.35
        if look.t < lowest - look.noise - 1e-4 * share * expected:
            break
        d = trial
    return GAVE_UP, d, 0.0


@compiled
def pin(problem: Problem, best: Floats, v: Vector) -> Next:
    """Try rotations about each of the contacts near the centre of rotation, nearest first.

    Where two contacts nearly coincide Newton's steps do not tell which of them stands still. The
    best rotation is a start for `slide`: the centre may lie beside the contact.
    """
    contacts, setting = problem.contacts, problem.setting
    d = _on_sphere(setting, v)
    tau, slower = abs(d[2]) * setting.spacing, -1.0
    least, start = np.inf, d
    for _ in range(_PINS):
        nearest, found = np.inf, -1
        for i in range(contacts.data.shape[1]):
            ux, uy = contact_velocity(contacts, i, d)
            size = length(ux, uy)
            if contacts.data[2, i] > 0.0 and slower < size < nearest:
                nearest, found = size, i
        if found < 0 or nearest > tau:
            break
        slower = nearest
        about = _on_sphere(setting, snapped(kink_of(contacts, found, 0.0), d))
        bound = _look(problem, best, about, (0.0, 0.0), -1, _FIRST).bound
        if bound <= setting.target:
            return CERTIFIED, about, 0.0
        if bound < least:
            least, start = bound, about
    return (SLIDE if least < np.inf else GAVE_UP), start, 0.0
