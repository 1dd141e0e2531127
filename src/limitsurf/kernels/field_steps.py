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
from limitsurf.kernels.contact_problem import Rows
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
    rows = _world_rows(B, c, s)
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
    return bool(vx == 0.0 and vy == 0.0 and w == 0.0)


@compiled
def _world_rows(B: Floats, c: float, s: float) -> Rows:
    """Return the rows of the map from loads of the kernels to loads in world axes."""
    first, second = (B[0, 0], 0.0, 0.0), (0.0, B[1, 1], 0.0)
    third = (B[2, 0], B[2, 1], B[2, 2])
    return (
        along(scaled(c, first), -s, second),
        along(scaled(s, first), c, second),
        third,
    )


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
    Q, F = body.mass / dt + body.drag, np.zeros(6)
    state, out, room, placed = new_state(), np.zeros(7 + ANSWER), new_room(), np.zeros((1, 3))
    energies, constant = np.zeros(5), loads.shape[0] == 1
    energies[0] = 0.5 * (body.mass * old * old).sum()
    worst, written, rests = 0.0, 0, False
    for step in range(steps + 1):
        placed[0] = pose
        density_states(body.edges, placed, pieces, state)
        momentum = body.mass * old / dt
        F[:3] = state[0, :3] + loads[min(step, loads.shape[0] - 1)]
        held = uniform_step(body, pose[2], F[:3] + momentum, Q, tol, room, out)
        new, F[3:] = out[:3].copy(), out[3:6]
        rests = rests or (constant and held and not momentum.any())
        over = rests or step == steps
        if over or step % stride == 0:
            frame = frames[written]
            frame[0], frame[1:4] = step * dt, pose
            frame[4:7] = old if body.mass[0] > 0.0 else new
            frame[7:10] = state[0, :3] + F[3:]
            frame[10], frame[ENERGIES:] = out[6] * math.sqrt(Q[0]), energies
            written += 1
        if over:
            break
        worst = max(worst, out[6])
        _add_energies(body, old, new, F, dt, energies)
        pose += dt * new
        change = _rim_speed(new - old, body.reach) * rest[1] / dt
        rests = constant and max(_rim_speed(new, body.reach), change) <= rest[0]
        old = new
    return rests, written, worst


@compiled
def _rim_speed(twist: Floats, reach: float) -> float:
    """Return the largest speed of a point within reach."""
    return float(math.hypot(twist[0], twist[1]) + reach * abs(twist[2]))
