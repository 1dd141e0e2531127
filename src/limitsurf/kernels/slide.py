r"""A part on an activated array, step by step, contact by contact.

Each implicit step solves, for the twist v at its end,

.. math::
    v = \arg\min_v\; \tfrac12 (v-v_0)^T M (v-v_0)
        + \Delta t \left( h_L(-v) + \tfrac12 v^T D v \right),

the closest-point problem of ``contact_sum`` with metric :math:`(M/\Delta t + D)^{-1}` and load
:math:`\sum G_i a_i + M v_0/\Delta t`, where :math:`a_i` are the mean pushes of the tips. M = 0 is
quasi-static motion. The weight is shared equally by the active tips under the part; a tip at the
outline carries its share of that (``lattice``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

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
    new_best,
    new_setting,
    second_moments,
)
from limitsurf.kernels.contact_sum import solve_contact_sum
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.lattice import Cover, Lattice, covered_sites, new_cover

__all__ = ["LEFT_ARRAY", "NOT_LIFTED", "REST", "TIME_LIMIT", "Body", "Ground", "slide"]

TIME_LIMIT, REST, LEFT_ARRAY, NOT_LIFTED = 0, 1, 2, 3
_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Body(NamedTuple):
    """The part: edges (E, 4) about its centre of mass, weight, mass and drag for (x, y, theta).

    `reach` is its circumradius.
    """

    reach: float
    edges: Floats
    weight: float
    mass: Floats
    drag: Floats


class Ground(NamedTuple):
    """The array: its lattice of sites, where they push, and what a tip does.

    `push` and `grip` are the mean push and the radius of the friction disk of a tip, per normal
    force; `lift` is the largest normal force a tip can carry.
    """

    lattice: Lattice
    directions: Floats
    push: float
    grip: float
    lift: float


class Step(NamedTuple):
    """What a step computes: loads of the contacts, tips' scaled positions and friction radii."""

    edges: Floats
    data: Floats
    load: Floats
    best: Floats
    table: Floats
    none: Floats


@compiled
def _place(edges: Floats, pose: Floats, out: Floats) -> None:
    """Move the edges to a pose."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    for i in range(edges.shape[0]):
        for k in (0, 2):
            out[i, k] = pose[0] + cos * edges[i, k] - sin * edges[i, k + 1]
            out[i, k + 1] = pose[1] + sin * edges[i, k] + cos * edges[i, k + 1]


@compiled
def _on_array(edges: Floats, lattice: Lattice) -> bool:
    """Return whether all vertices lie over the cells of the sites."""
    half = 0.5 * lattice.pitch
    rows, columns = lattice.active.shape
    left, bottom = lattice.origin_x - half, lattice.origin_y - half
    right, top = left + columns * lattice.pitch, bottom + rows * lattice.pitch
    for i in range(edges.shape[0]):
        if not (left <= edges[i, 0] <= right and bottom <= edges[i, 1] <= top):
            return False
    return True


@compiled
def _slow(body: Body, twist: Floats, load: Floats, speed: float) -> bool:
    """Return whether the part, rim included, moves and will move slower than `speed`."""
    moving = math.hypot(twist[0], twist[1]) + body.reach * abs(twist[2])
    terminal = math.hypot(load[0], load[1]) / body.drag[0]
    terminal += body.reach * abs(load[2]) / body.drag[2]
    return bool(max(moving, terminal) < speed)


@compiled
def slide(
    body: Body,
    ground: Ground,
    pose: Floats,
    twist: Floats,
    dt: float,
    steps: int,
    stride: int,
    tol: float,
    rest_speed: float,
    frames: Floats,
) -> tuple[int, int, int, float, float]:
    """Move a part until it rests, leaves, sinks or the steps are used up.

    Parameters
    ----------
    body, ground : Body, Ground
        What moves on what.
    pose, twist : (3,) float
        Start; overwritten with the end.
    dt, steps : float, int
        Time step [s] and their largest number.
    stride : int
        Every how many steps a row of `frames` is written.
    tol : float
        Tolerance of the certificates.
    rest_speed : float
        The part rests when no load on it is certified, or when neither its speed nor the speed
        that the load would give it against drag alone reaches this [m/s].
    frames : (K, 12) float
        Output rows ``time, pose, twist, load, error bound, tips``; K > steps // stride + 1.

    Returns
    -------
    status, steps, rows : int
        One of TIME_LIMIT, REST, LEFT_ARRAY, NOT_LIFTED; steps taken; rows written.
    worst : float
        Largest certified error bound, relative to the weight.
    heaviest : float
        Largest normal force on a tip.
    """
    cover = new_cover(ground.lattice.active)
    sites = cover.share.size
    work = Step(
        np.empty_like(body.edges),
        np.empty(3 * sites),
        np.zeros(3),
        new_best(),
        new_table(sites),
        np.empty((0, 2)),
    )
    worst = heaviest = bound = 0.0
    step = written = 0
    while True:
        status, count, normal = _find_tips(body, ground, pose, work.edges, cover)
        heaviest = max(heaviest, normal)
        if status == TIME_LIMIT and step < steps:
            resting, bound = _solve(body, ground, pose, twist, dt, tol, normal, count, cover, work)
            worst = max(worst, bound / body.weight)
            if resting or _slow(body, twist, work.load, rest_speed):
                status = REST
        over = status != TIME_LIMIT or step == steps
        if over or step % stride == 0:
            frame = frames[written]
            frame[0] = step * dt
            frame[1:4] = pose
            frame[4:7] = twist
            frame[7:10] = work.load
            frame[10] = bound
            frame[11] = count
            written += 1
        if over:
            return status, step, written, worst, heaviest
        pose += dt * twist
        step += 1


@compiled
def _find_tips(
    body: Body, ground: Ground, pose: Floats, edges: Floats, cover: Cover
) -> tuple[int, int, float]:
    """Return status, number of tips under the part, and the weight on a tip of share 1."""
    _place(body.edges, pose, edges)
    if not _on_array(edges, ground.lattice):
        return LEFT_ARRAY, 0, 0.0
    count = covered_sites(edges, ground.lattice, cover)
    normal = body.weight / cover.share[:count].sum() if count > 0 else np.inf
    return NOT_LIFTED if normal > ground.lift else TIME_LIMIT, count, normal


@compiled
def _solve(
    body: Body,
    ground: Ground,
    pose: Floats,
    twist: Floats,
    dt: float,
    tol: float,
    normal: float,
    count: int,
    cover: Cover,
    work: Step,
) -> tuple[bool, float]:
    """Overwrite the twist by that of the implicit step; return whether it rests, and the bound.

    Scaled by rho, the metric's radius of gyration, and by the first entry of the quadratic term,
    the metric is the identity.
    """
    quadratic = body.mass / dt + body.drag
    rho = math.sqrt(quadratic[2] / quadratic[0])
    _sum_contacts(ground, pose, rho, normal, count, cover, work)
    momentum = body.mass * twist / dt
    scaled = work.load + momentum
    scaled[2] /= rho
    best = work.best
    contacts = Contacts(work.data[: 3 * count].reshape(3, count), 1, None)
    table = work.table[: -(-count // BLOCK) + 1]
    c = scaled[0], scaled[1], scaled[2]
    setting = new_setting(count, second_moments(contacts), _IDENTITY, c, 1.0, tol)
    v = best[WITNESS], best[WITNESS + 1], best[WITNESS + 2]
    solve_contact_sum(Problem(contacts, table, setting), best, v, best[EPS], work.none)
    twist[:] = 0.0
    sticks = True
    for k in range(3):
        sticks = sticks and best[TWIST + k] == 0.0
    if not sticks:
        twist[:] = (scaled - best[LOAD : LOAD + 3]) / quadratic[0]
    twist[2] /= rho
    friction = -best[LOAD : LOAD + 3]
    friction[2] *= rho
    work.load[:] += friction
    return sticks and not np.any(momentum), best[BOUND] + setting.rounding


@compiled
def _sum_contacts(
    ground: Ground,
    pose: Floats,
    rho: float,
    normal: float,
    count: int,
    cover: Cover,
    work: Step,
) -> None:
    """Set the tips' scaled positions and friction radii, and sum their pushes to a load."""
    lattice = ground.lattice
    work.load[:] = 0.0
    for i in range(count):
        r, c = cover.rows[i], cover.columns[i]
        rx = lattice.origin_x + lattice.pitch * c - pose[0]
        ry = lattice.origin_y + lattice.pitch * r - pose[1]
        carried = normal * cover.share[i]
        fx = ground.push * carried * ground.directions[r, c, 0]
        fy = ground.push * carried * ground.directions[r, c, 1]
        work.load[0] += fx
        work.load[1] += fy
        work.load[2] += rx * fy - ry * fx
        work.data[i], work.data[count + i] = rx / rho, ry / rho
        work.data[2 * count + i] = ground.grip * carried
