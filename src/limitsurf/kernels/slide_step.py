r"""One implicit step of a part on an activated array.

It solves, for the twist v at its end,

.. math::
    v = \arg\min_v\; \tfrac12 (v-v_0)^T M (v-v_0)
        + \Delta t \left( h_L(-v) + \tfrac12 v^T D v - F \cdot v \right),

the closest-point problem of ``contact_sum`` with metric :math:`(M/\Delta t + D)^{-1}` and load
:math:`F + \sum G_i a_i + M v_0/\Delta t`, where F is the external load and :math:`a_i` are the mean
pushes of the tips. M = 0 is quasi-static motion. The weight is shared equally by the active tips
under the part (`tips`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled, inlined
from limitsurf.kernels.contact_pass import BLOCK, Contacts
from limitsurf.kernels.contact_problem import (
    BOUND,
    EPS,
    LOAD,
    TWIST,
    WITNESS,
    Problem,
    new_setting,
)
from limitsurf.kernels.contact_sum import COLD, solve_contact_sum
from limitsurf.kernels.lattice import Lattice, holds
from limitsurf.kernels.load_table import VARIES, Load, load_at
from limitsurf.kernels.row_spans import Spans
from limitsurf.kernels.tip_list import (
    COUNT,
    PUSH_M,
    PUSH_X,
    PUSH_Y,
    SHARE,
    Tips,
    moments_of,
    tip_data,
)
from limitsurf.kernels.tips import move_tips
from limitsurf.kernels.vectors import Vector, along, dot, scaled

__all__ = [
    "ENERGIES",
    "HEAVIEST",
    "LEFT_ARRAY",
    "LOAD_NOW",
    "NEXT_FRAME",
    "NOT_LIFTED",
    "POSE",
    "REST",
    "SLACK",
    "STEP",
    "STEPS",
    "TIME",
    "TIME_LIMIT",
    "TWIST_NOW",
    "WIDTH",
    "WORST",
    "Body",
    "Ground",
    "Pace",
    "Work",
    "find_tips",
    "is_over",
    "new_motion",
    "take_step",
]

TIME_LIMIT, REST, LEFT_ARRAY, NOT_LIFTED = 0, 1, 2, 3

# numbers of a motion: where it is, with what it warm-starts, and what it has summed up
TIME, POSE, TWIST_NOW, START, WIDTH, LOAD_NOW, SLACK, ENERGIES = 0, 1, 4, 7, 10, 11, 14, 15
WORST, HEAVIEST, STEP, STEPS, NEXT_FRAME, _MOTION = 19, 20, 21, 22, 23, 24


Pair = tuple[float, float]


class Body(NamedTuple):
    """The part: edges (E, 4) about its centre of mass, weight, mass and drag for (x, y, theta).

    `reach` is its circumradius, `load` the external load on it in the course of time.
    """

    reach: float
    edges: Floats
    weight: float
    mass: Floats
    drag: Floats
    load: Load


class Ground(NamedTuple):
    """The array: its lattice of sites, and what a tip does.

    `push` and `grip` are the mean push and the radius of the friction disk of a tip, per normal
    force; `lift` is the largest normal force a tip can carry.
    """

    lattice: Lattice
    push: float
    grip: float
    lift: float


class Pace(NamedTuple):
    """The longest step dt [s] and the local error that shortens it, over the reach; or 0: fixed.

    `tol` is the tolerance of the certificates. The part rests when no load on it is certified, or
    when neither its speed nor the speed that the load would give it against drag alone reaches
    `rest_speed` [m/s].
    """

    dt: float
    error: float
    tol: float
    rest_speed: float


class Work(NamedTuple):
    """What a step works with: edges in place, tips, an answer of the contact sum and its room."""

    edges: Floats
    tips: Tips
    best: Floats
    table: Floats
    none: Floats


@compiled
def new_motion(pose: Floats, twist: Floats) -> Floats:
    """Return the numbers of a motion that begins."""
    motion = np.zeros(_MOTION)
    motion[POSE : POSE + 3] = pose
    motion[TWIST_NOW : TWIST_NOW + 3] = twist
    motion[WIDTH] = COLD
    return motion


@inlined
def _place(edges: Floats, motion: Floats, out: Floats) -> None:
    """Move the edges to the pose."""
    x, y, theta = motion[POSE], motion[POSE + 1], motion[POSE + 2]
    cos, sin = math.cos(theta), math.sin(theta)
    for i in range(edges.shape[0]):
        for k in (0, 2):
            out[i, k] = x + cos * edges[i, k] - sin * edges[i, k + 1]
            out[i, k + 1] = y + sin * edges[i, k] + cos * edges[i, k + 1]


@compiled
def is_over(body: Body, ground: Ground, motion: Floats, work: Work) -> bool:
    """Place the edges; return whether all of the part is over the array."""
    _place(body.edges, motion, work.edges)
    return holds(ground.lattice, work.edges)


@inlined
def find_tips(
    body: Body, ground: Ground, motion: Floats, spans: Spans, work: Work
) -> tuple[int, Spans]:
    """Bring the tips up to date; return TIME_LIMIT, or why there is no step, and the spans."""
    if not is_over(body, ground, motion, work):
        return LEFT_ARRAY, spans
    x, y = motion[POSE], motion[POSE + 1]
    spans = move_tips(ground.lattice, work.edges, x, y, work.tips, spans)
    normal = _normal(body, work.tips)
    motion[HEAVIEST] = max(motion[HEAVIEST], normal)
    return NOT_LIFTED if normal > ground.lift else TIME_LIMIT, spans


@inlined
def _normal(body: Body, tips: Tips) -> float:
    """Return the weight on a tip of share 1."""
    carried = tips.numbers[COUNT] > 0 and tips.sums[SHARE] > 0.0
    return body.weight / tips.sums[SHARE] if carried else np.inf


@compiled
def _slow(body: Body, speed: float, v: Vector, load: Vector) -> bool:
    """Return whether the part, rim included, moves and will move slower than `speed`.

    `load` is what all loads but drag add up to.
    """
    if not math.hypot(v[0], v[1]) + body.reach * abs(v[2]) < speed:
        return False
    terminal = math.hypot(load[0], load[1]) / body.drag[0]
    return bool(terminal + body.reach * abs(load[2]) / body.drag[2] < speed)


@inlined
def _three(a: Floats, k: int) -> Vector:
    return a[k], a[k + 1], a[k + 2]


@inlined
def _keep(motion: Floats, k: int, v: Vector) -> None:
    motion[k], motion[k + 1], motion[k + 2] = v


@inlined
def _loss(d: Vector, v: Vector) -> float:
    """Return ``v' diag(d) v``."""
    return d[0] * v[0] * v[0] + d[1] * v[1] * v[1] + d[2] * v[2] * v[2]


@inlined
def _pushes(ground: Ground, tips: Tips, normal: float, dx: float, dy: float) -> Vector:
    """Return the load of the pushes about a point at (dx, dy) from the anchor."""
    push = ground.push * normal
    fx, fy = push * tips.sums[PUSH_X], push * tips.sums[PUSH_Y]
    return fx, fy, push * tips.sums[PUSH_M] - dx * fy + dy * fx


@inlined
def _slide_against_friction(
    pace: Pace, motion: Floats, work: Work, unit: float, q: Vector, c: Vector, at: Pair
) -> tuple[Vector, Vector, float]:
    """Return the twist of a load c, the frictional load that it overcomes, and the error bound.

    Contacts are about the anchor, from which the part is at (dx, dy); q is the diagonal of the
    quadratic term, `unit` the friction of a tip of share 1, by which loads are scaled.
    """
    best, (dx, dy) = work.best, at
    a, b, d = 1.0 / math.sqrt(q[0]), 1.0 / math.sqrt(q[1]), 1.0 / math.sqrt(q[2])
    C = (a, 0.0, 0.0), (0.0, b, 0.0), (d * dy, -d * dx, d)
    load = c[0] / unit, c[1] / unit, (c[2] + dx * c[1] - dy * c[0]) / unit
    contacts = Contacts(tip_data(work.tips), 1, None)
    n, size = contacts.data.shape[1], math.sqrt(0.5 * (a * a + b * b))
    setting = new_setting(n, moments_of(work.tips), C, load, size, pace.tol)
    problem = Problem(contacts, work.table[: -(-n // BLOCK) + 1], setting)
    vx, vy, w = _three(motion, START)
    start = vx + w * dy, vy - w * dx, w
    solve_contact_sum(problem, best, start, motion[WIDTH], work.none)
    vx, vy, w = _three(best, WITNESS)
    _keep(motion, START, (vx - w * dy, vy + w * dx, w))
    motion[WIDTH] = best[EPS]
    vx, vy, w = scaled(unit, _three(best, TWIST))
    fx, fy, m = scaled(unit, _three(best, LOAD))
    bound = unit * (best[BOUND] + setting.rounding) * math.sqrt(q[0])
    return (vx - w * dy, vy + w * dx, w), (fx, fy, m - dx * fy + dy * fx), bound


@compiled
def take_step(
    body: Body, ground: Ground, pace: Pace, motion: Floats, dt: float, work: Work
) -> bool:
    """Solve for a step, add to the energies, move on; return whether the part rests instead."""
    tips, v0 = work.tips, _three(motion, TWIST_NOW)
    normal = _normal(body, tips)
    at = motion[POSE] - tips.anchor[0], motion[POSE + 1] - tips.anchor[1]
    pushes = _pushes(ground, tips, normal, at[0], at[1])
    external, _ = load_at(body.load, motion[TIME] + dt)
    drive = along(pushes, 1.0, external)
    M, D = _three(body.mass, 0), _three(body.drag, 0)
    q = along(D, 1.0 / dt, M)
    momentum = M[0] * v0[0], M[1] * v0[1], M[2] * v0[2]
    c = along(drive, 1.0 / dt, momentum)
    v, friction, bound = (c[0] / q[0], c[1] / q[1], c[2] / q[2]), (0.0, 0.0, 0.0), 0.0
    if ground.grip > 0.0:
        unit = ground.grip * normal
        v, friction, bound = _slide_against_friction(pace, motion, work, unit, q, c, at)
    _keep(motion, TWIST_NOW, v)
    _keep(motion, LOAD_NOW, along(pushes, -1.0, friction))
    motion[SLACK] = bound
    motion[WORST] = max(motion[WORST], bound / body.weight)
    if body.load.kind != VARIES:
        held = v == (0.0, 0.0, 0.0) and momentum == (0.0, 0.0, 0.0)
        if held or _slow(body, pace.rest_speed, v, along(drive, -1.0, friction)):
            return True
    _keep(motion, POSE, along(_three(motion, POSE), dt, v))
    motion[TIME] += dt
    motion[ENERGIES] += dt * dot(drive, v)
    motion[ENERGIES + 1] += dt * dot(friction, v)
    motion[ENERGIES + 2] += dt * _loss(D, v)
    motion[ENERGIES + 3] += 0.5 * _loss(M, along(v, -1.0, v0))
    return False
