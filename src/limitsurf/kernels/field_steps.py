r"""A part in a force density, step by implicit step, with uniform friction and viscous drag.

Each step solves, for the twist v at its end,

.. math::
    v = \arg\min_v\; \tfrac12 (v-v_0)^T M (v-v_0)
        + \Delta t \left( h_L(-v) + \tfrac12 v^T D v - F \cdot v \right),

F the load at its begin: the closest point of the limit surface L to :math:`-(F + M v_0/\Delta t)`
in the metric :math:`(M/\Delta t + D)^{-1}`, found in the axes of the part, to which L is fixed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.density import Pieces, density_states, new_state
from limitsurf.kernels.project_uniform import ANSWER, BOUND, TWIST, project_uniform
from limitsurf.kernels.uniform_friction import Room, UniformPatch, new_room
from limitsurf.kernels.vectors import Vector, along, scaled

__all__ = ["ENERGIES", "FRAME", "FieldBody", "field_steps", "uniform_step"]

#: Columns ``time, pose, twist, load, error bound, energies`` of a frame.
FRAME = 16
ENERGIES = 11  # kinetic, work, friction, drag, numerical


class FieldBody(NamedTuple):
    """A part: edges (E, 4) about its centre of mass, circumradius, mass and drag (3,).

    `patch` and `unit`, (3, 3), are its friction: the polygon, and the map of its loads in the
    kernels to loads in its own axes; (0, 0) without friction. L is about the centre of mass.
    """

    edges: Floats
    reach: float
    mass: Floats
    drag: Floats
    patch: UniformPatch
    unit: Floats


@compiled
def uniform_step(
    body: FieldBody, theta: float, pull: Floats, Q: Floats, tol: float, room: Room, out: Floats
) -> bool:
    """Solve ``Q v = pull + F``, F the friction of v; return whether the part is held.

    Parameters
    ----------
    body, theta : FieldBody, float
        The part, and its angle.
    pull, Q : (3,) float
        Load and diagonal of the quadratic term, world axes.
    tol : float
        Tolerance of the certificate.
    room, out : Room, (16,) float
        Where to work; receives v (3), F (3) and the certified error in the norm of Q, then more.
    """
    if body.unit.shape[0] == 0:
        for k in range(3):
            out[k], out[3 + k] = pull[k] / Q[k], 0.0
        out[6] = 0.0
        return False
    c, s, B, answer = math.cos(theta), math.sin(theta), body.unit, out[7:]
    first, second = (B[0, 0], 0.0, 0.0), (0.0, B[1, 1], 0.0)
    third = (B[2, 0], B[2, 1], B[2, 2])
    rows = (
        along(scaled(c, first), -s, second),
        along(scaled(s, first), c, second),
        third,
    )
    C = (
        scaled(1.0 / math.sqrt(Q[0]), rows[0]),
        scaled(1.0 / math.sqrt(Q[1]), rows[1]),
        scaled(1.0 / math.sqrt(Q[2]), rows[2]),
    )
    px = -(c * pull[0] + s * pull[1]) / B[0, 0]
    py = -(c * pull[1] - s * pull[0]) / B[1, 1]
    p = px, py, (-pull[2] - B[2, 0] * px - B[2, 1] * py) / B[2, 2]
    project_uniform(body.patch, p, C, tol, room, answer)
    w = -answer[TWIST + 2] / B[2, 2]
    vx = (-answer[TWIST] - B[2, 0] * w) / B[0, 0]
    vy = (-answer[TWIST + 1] - B[2, 1] * w) / B[1, 1]
    out[0], out[1], out[2] = c * vx - s * vy, s * vx + c * vy, w
    for k in range(3):
        out[3 + k] = rows[k][0] * answer[0] + rows[k][1] * answer[1] + rows[k][2] * answer[2]
    out[6] = answer[BOUND]
    held = answer[TWIST] == 0.0 and answer[TWIST + 1] == 0.0 and answer[TWIST + 2] == 0.0
    return bool(held)


@compiled
def _add_energies(
    body: FieldBody, old: Floats, new: Floats, F: Floats, dt: float, e: Floats
) -> None:
    """Add what a step with end twist `new` did; F is the load without friction, then friction."""
    e[0] = 0.0
    for k in range(3):
        change = new[k] - old[k]
        e[0] += 0.5 * body.mass[k] * new[k] * new[k]
        e[1] += dt * F[k] * new[k]
        e[2] -= dt * F[3 + k] * new[k]
        e[3] += dt * body.drag[k] * new[k] * new[k]
        e[4] += 0.5 * body.mass[k] * change * change


@compiled
def field_steps(
    body: FieldBody,
    pieces: Pieces,
    loads: Floats,
    start: tuple[Vector, Vector],
    times: tuple[float, int, int],
    tol: float,
    rest: tuple[float, float],
    frames: Floats,
) -> tuple[bool, int, float]:
    """Move a part until it rests or the steps are used up.

    Parameters
    ----------
    body, pieces : FieldBody, Pieces
        What moves, and what pushes.
    loads : (1, 3) or (steps, 3) float
        External load, the same always or for each step; only the former lets a part rest.
    start : pair of vectors
        Pose and twist.
    times : float, int, int
        Time step [s], their largest number, and every how many a frame is written.
    tol : float
        Tolerance of the certificates.
    rest : float, float
        The part rests when friction holds it without momentum; or when its speed and what that
        changes in the second time [s] stay below the first number [m/s].
    frames : (K, 16) float
        Frames; K > steps // stride + 2.

    Returns
    -------
    rests, written, worst : bool, int, float
        Whether it rests; frames written; the largest certified error in the norm of Q.
    """
    pose, old = np.array(start[0]), np.array(start[1])
    dt, steps, stride = times
    Q = body.mass / dt + body.drag
    state, out, room, F = new_state(), np.zeros(7 + ANSWER), new_room(), np.zeros(6)
    new, energies, placed = old.copy(), np.zeros(5), pose.copy().reshape(1, 3)
    for k in range(3):
        energies[0] += 0.5 * body.mass[k] * old[k] * old[k]
    worst, written, rests = 0.0, 0, False
    for step in range(steps + 1):
        over = rests or step == steps
        placed[0] = pose
        density_states(body.edges, placed, pieces, state)
        load = loads[min(step, loads.shape[0] - 1)]
        momentum, size = body.mass * old / dt, 0.0
        for k in range(3):
            F[k] = state[0, k] + load[k]
            size += momentum[k] * momentum[k]
        held = uniform_step(body, pose[2], F[:3] + momentum, Q, tol, room, out)
        if loads.shape[0] == 1 and held and size == 0.0:
            rests, over = True, True
        if over or step % stride == 0:
            frame = frames[written]
            frame[0] = step * dt
            frame[1:4] = pose
            frame[4:7] = old if body.mass[0] > 0.0 else out[:3]
            frame[7:10] = state[0, :3] + out[3:6]
            frame[10] = out[6] * math.sqrt(Q[0])
            frame[ENERGIES:] = energies
            written += 1
        if over:
            break
        new[:], F[3:] = out[:3], out[3:6]
        worst = max(worst, out[6])
        _add_energies(body, old, new, F, dt, energies)
        pose += dt * new
        speed = math.hypot(new[0], new[1]) + body.reach * abs(new[2])
        change = math.hypot(new[0] - old[0], new[1] - old[1]) + body.reach * abs(new[2] - old[2])
        rests = loads.shape[0] == 1 and max(speed, change * rest[1] / dt) <= rest[0]
        old[:] = new
    return rests, written, worst
