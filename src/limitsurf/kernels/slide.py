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

from limitsurf.kernels.compile import Bools, Floats, Ints, compiled
from limitsurf.kernels.contact_sum import solve_contact_sum
from limitsurf.kernels.lattice import covered_sites

__all__ = ["LEFT_ARRAY", "NOT_LIFTED", "REST", "TIME_LIMIT", "Body", "Ground", "slide"]

TIME_LIMIT, REST, LEFT_ARRAY, NOT_LIFTED = 0, 1, 2, 3


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
    """The array: a lattice of sites, which run, where they push, and what a tip does.

    `push` and `grip` are the mean push and the radius of the friction disk of a tip, per normal
    force; `lift` is the largest normal force a tip can carry.
    """

    origin_x: float
    origin_y: float
    pitch: float
    active: Bools
    directions: Floats
    tip_width: float
    push: float
    grip: float
    lift: float


@compiled
def _place(edges: Floats, pose: Floats, out: Floats) -> None:
    """Move the edges to a pose."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    for i in range(edges.shape[0]):
        for k in (0, 2):
            out[i, k] = pose[0] + cos * edges[i, k] - sin * edges[i, k + 1]
            out[i, k + 1] = pose[1] + sin * edges[i, k] + cos * edges[i, k + 1]


@compiled
def _on_array(edges: Floats, ground: Ground) -> bool:
    """Return whether all vertices lie over the cells of the sites."""
    half = 0.5 * ground.pitch
    rows, columns = ground.active.shape
    left, bottom = ground.origin_x - half, ground.origin_y - half
    right, top = left + columns * ground.pitch, bottom + rows * ground.pitch
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
    sites = ground.active.shape[0] * ground.active.shape[1]
    slot = np.full(ground.active.shape, -1, np.int32)
    rows, columns = np.empty(sites, np.int32), np.empty(sites, np.int32)
    share, x, y = np.empty(sites), np.empty(sites), np.empty(sites)
    edges = np.empty_like(body.edges)
    quadratic = body.mass / dt + body.drag
    rho = math.sqrt(quadratic[2] / quadratic[0])
    guess, load, scaled = np.zeros(3), np.zeros(3), np.empty(3)
    worst = heaviest = 0.0
    written = 0
    status = TIME_LIMIT
    step = 0
    count = 0
    bound = 0.0
    while True:
        _place(body.edges, pose, edges)
        if not _on_array(edges, ground):
            status = LEFT_ARRAY
        else:
            count = covered_sites(
                edges,
                ground.origin_x,
                ground.origin_y,
                ground.pitch,
                ground.active,
                ground.tip_width,
                slot,
                rows,
                columns,
                share,
            )
            normal = body.weight / share[:count].sum() if count > 0 else np.inf
            heaviest = max(heaviest, normal)
            if normal > ground.lift:
                status = NOT_LIFTED
        if status == TIME_LIMIT and step < steps:
            _sum_contacts(ground, pose, rho, normal, rows, columns, share, count, x, y, load)
            resting = True
            for k in range(3):
                inertial = body.mass[k] * twist[k] / dt
                resting = resting and inertial == 0.0
                scaled[k] = (load[k] + inertial) / (rho if k == 2 else 1.0)
            solution, friction, bound, sticks, _ = solve_contact_sum(
                x[:count], y[:count], share[:count], scaled, guess, tol
            )
            worst = max(worst, bound / body.weight)
            guess[:] = solution
            for k in range(3):
                twist[k] = solution[k] / (quadratic[0] * (rho if k == 2 else 1.0))
                load[k] += friction[k] * (rho if k == 2 else 1.0)
            if (sticks and resting) or _slow(body, twist, load, rest_speed):
                status = REST
        if status != TIME_LIMIT or step == steps or step % stride == 0:
            frames[written, 0] = step * dt
            frames[written, 1:4] = pose
            frames[written, 4:7] = twist
            frames[written, 7:10] = load
            frames[written, 10] = bound
            frames[written, 11] = count
            written += 1
        if status != TIME_LIMIT or step == steps:
            return status, step, written, worst, heaviest
        pose += dt * twist
        step += 1


@compiled
def _sum_contacts(
    ground: Ground,
    pose: Floats,
    rho: float,
    normal: float,
    rows: Ints,
    columns: Ints,
    share: Floats,
    count: int,
    x: Floats,
    y: Floats,
    load: Floats,
) -> None:
    """Set scaled positions, turn shares into friction radii, and sum the pushes to a load."""
    load[:] = 0.0
    for i in range(count):
        rx = ground.origin_x + ground.pitch * columns[i] - pose[0]
        ry = ground.origin_y + ground.pitch * rows[i] - pose[1]
        carried = normal * share[i]
        fx = ground.push * carried * ground.directions[rows[i], columns[i], 0]
        fy = ground.push * carried * ground.directions[rows[i], columns[i], 1]
        load[0] += fx
        load[1] += fy
        load[2] += rx * fy - ry * fx
        x[i], y[i] = rx / rho, ry / rho
        share[i] = ground.grip * carried
