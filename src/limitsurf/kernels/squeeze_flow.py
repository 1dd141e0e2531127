r"""Motion of a polygon of area 1 in an ideal squeeze field: gradient flow of its energy.

.. math:: z' = -U_z, \qquad \theta' = -\kappa\, U_\theta

With :math:`q = \theta / \sqrt\kappa` the flow descends the gradient of :math:`U(z, \sqrt\kappa q)`,
so its Jacobian is the symmetric matrix of second derivatives. `root` stands for
:math:`\sqrt\kappa`; root = 0 for the limit in which the line stays on the median,
:math:`\theta' = -dU/d\theta` and q = theta. A `sign` of -1 runs the flow backwards.

Steps are those of RODAS (`rodas`): slow drift along the median costs no more than motion onto it.
At rest means: Newton's step towards a strict minimum of U is below `_NEAR`; or no force is left.
"""

from __future__ import annotations

import numpy as np

from limitsurf.kernels.compile import Floats, Ints, compiled
from limitsurf.kernels.median import squeeze_states
from limitsurf.kernels.rodas import GAMMA, A, C
from limitsurf.kernels.squeeze_energy import squeeze_energy

__all__ = ["FLAT", "MOVING", "STABLE", "flow_rate", "flow_step", "flow_to", "flow_trace", "settle"]

#: How a motion ended: still moving, at rest without a strict minimum, in a strict minimum.
MOVING, FLAT, STABLE = 0, 1, 2

_MAX_STEPS = 20000
_NEAR = 1e-8  # Newton's next step is below its square
_FLAT_FORCE = 2e-15  # rounding of the sums, area 1
_FLAT_CURVATURE = 1e-9

State = tuple[float, float]
#: z, q, then the gradient (U_z, U_q) and the second derivatives (zz, zq, qq).
Rate = tuple[float, float, float, float, float, float, float]


@compiled
def flow_rate(edges: Floats, root: float, z: float, q: float) -> Rate:
    """Return the state, on the median if root = 0, with gradient and Hessian there."""
    if root == 0.0:
        states = squeeze_states(edges, np.array([q]), 0.5)
        z, U, slope, J = states[0, 0], states[0, 1], states[0, 2], states[0, 3]
        return z, q, 0.0, slope, 1.0, 0.0, 2 * J - U
    U, force, moment, c0, c1, c2 = squeeze_energy(edges, 1.0, z, root * q)
    bend = 2 * c2 - U + z * force
    return z, q, force, root * moment, 2 * c0, 2 * root * c1, root * root * bend


@compiled
def flow_step(
    edges: Floats, root: float, sign: float, at: Rate, h: float, stages: Floats
) -> tuple[float, float, float, float]:
    """Return the state after a step of length h, and the estimated error in both numbers."""
    shift = 1.0 / (GAMMA * h)
    a, b, d = shift + sign * at[4], sign * at[5], shift + sign * at[6]
    det = a * d - b * b
    z, q = at[0], at[1]
    gz, gq = at[2], at[3]
    for i in range(6):
        if i > 0:
            z, q = at[0], at[1]
            for j in range(i):
                z += A[i, j] * stages[j, 0]
                q += A[i, j] * stages[j, 1]
            _, _, gz, gq, _, _, _ = flow_rate(edges, root, z, q)
        right_z, right_q = -sign * gz, -sign * gq
        for j in range(i):
            right_z += C[i, j] / h * stages[j, 0]
            right_q += C[i, j] / h * stages[j, 1]
        stages[i, 0] = (d * right_z - b * right_q) / det
        stages[i, 1] = (a * right_q - b * right_z) / det
    return z + stages[5, 0], q + stages[5, 1], stages[5, 0], stages[5, 1]


@compiled
def _growth(at: Rate, sign: float) -> float:
    """Return the rate at which the fastest growing deviation grows; 0 if none does."""
    middle, half = -0.5 * sign * (at[4] + at[6]), 0.5 * (at[4] - at[6])
    return max(0.0, middle + float(np.hypot(half, at[5])))


@compiled
def _advance(
    edges: Floats, root: float, sign: float, at: Rate, h: float, tol: float, stages: Floats
) -> tuple[Rate, float, float]:
    """Return the rate after one accepted step of at most h, its length, and the next one's."""
    growth = _growth(at, sign)
    if h * growth > 1.0:
        h = 1.0 / growth
    scale = root if root > 0.0 else 1.0
    while True:
        z, q, error_z, error_q = flow_step(edges, root, sign, at, h, stages)
        error = max(abs(error_z), scale * abs(error_q)) / tol
        factor = 5.0 if error < 1e-4 else min(5.0, max(0.2, 0.9 * error**-0.25))
        if error <= 1.0:
            return flow_rate(edges, root, z, q), h, h * factor
        if not error < np.inf:
            factor = 0.1
        h *= factor


@compiled
def _first_step(at: Rate, root: float) -> float:
    scale = root if root > 0.0 else 1.0
    return 1e-2 / (1e-3 + max(abs(at[2]), scale * abs(at[3])))


@compiled
def _newton(at: Rate) -> tuple[float, float, bool]:
    """Return Newton's step to the minimum nearby, and whether there is a strict one."""
    lean = at[5] / at[4] if at[4] > 0.0 else 0.0
    bend = at[6] - lean * at[5]
    if bend <= _FLAT_CURVATURE * (1.0 + abs(at[6])) or (at[4] <= 0.0 and at[2] != 0.0):
        return 0.0, 0.0, False
    dq = -(at[3] - lean * at[2]) / bend
    dz = -at[2] / at[4] - lean * dq if at[4] > 0.0 else 0.0
    return dz, dq, True


@compiled
def _how_it_rests(at: Rate, scale: float) -> int:
    dz, dq, strict = _newton(at)
    if strict and abs(dz) <= _NEAR and scale * abs(dq) <= _NEAR:
        return STABLE
    if abs(at[2]) <= _FLAT_FORCE and abs(at[3]) <= _FLAT_FORCE * scale:
        return FLAT
    return MOVING


@compiled
def _rest(
    edges: Floats, root: float, z: float, q: float, tol: float, stages: Floats
) -> tuple[float, float, int]:
    """Follow the flow to rest; return where and how it ended."""
    at = flow_rate(edges, root, z, q)
    h = _first_step(at, root)
    scale = root if root > 0.0 else 1.0
    for _ in range(_MAX_STEPS):
        status = _how_it_rests(at, scale)
        if status != MOVING:
            dz, dq, _ = _newton(at) if status == STABLE else (0.0, 0.0, False)
            end = flow_rate(edges, root, at[0] + dz, at[1] + dq)
            return end[0], end[1], status
        at, _, h = _advance(edges, root, 1.0, at, h, tol, stages)
    return at[0], at[1], MOVING


@compiled
def settle(edges: Floats, kappa: float, starts: Floats, tol: float) -> tuple[Floats, Ints]:
    """Return where motions from rows ``(z, theta)`` come to rest, and how they ended.

    `tol` is the error of a step, in units of the side of a square of area 1 and in radians.
    """
    root = np.sqrt(kappa)
    scale = root if root > 0.0 else 1.0
    ends = np.empty_like(starts)
    status = np.empty(starts.shape[0], np.int32)
    stages = np.empty((6, 2))
    for k in range(starts.shape[0]):
        z, q, status[k] = _rest(edges, root, starts[k, 0], starts[k, 1] / scale, tol, stages)
        ends[k, 0], ends[k, 1] = z, scale * q
    return ends, status


@compiled
def flow_trace(
    edges: Floats, kappa: float, sign: float, start: Floats, tol: float
) -> tuple[Floats, int]:
    """Return rows ``(time, z, theta, z', theta')`` of one motion, and how it ended.

    It ends at rest or, backwards, with the line clear of the polygon: `STABLE`.
    """
    root = np.sqrt(kappa)
    scale = root if root > 0.0 else 1.0
    rows = np.empty((256, 5))
    stages = np.empty((6, 2))
    at = flow_rate(edges, root, start[0], start[1] / scale)
    h = _first_step(at, root) if sign > 0.0 else 1e-3
    time, count, status = 0.0, 0, MOVING
    while True:
        if count == rows.shape[0]:
            rows = np.concatenate((rows, np.empty_like(rows)))
        rows[count] = time, at[0], scale * at[1], -sign * at[2], -sign * scale * at[3]
        count += 1
        if sign > 0.0:
            status = _how_it_rests(at, scale)
        elif abs(at[2]) == 1.0 and at[3] == 0.0:
            status = STABLE
        if status != MOVING or count > _MAX_STEPS:
            return rows[:count].copy(), status
        at, step, h = _advance(edges, root, sign, at, h, tol, stages)
        time += step


@compiled
def flow_to(
    edges: Floats, kappa: float, sign: float, start: Floats, h: float
) -> tuple[float, float, float, float]:
    """Return ``(z, theta, z', theta')`` after one step of length h from ``(z, theta)``."""
    root = np.sqrt(kappa)
    at = flow_rate(edges, root, start[0], start[1] / root)
    z, q, _, _ = flow_step(edges, root, sign, at, h, np.empty((6, 2)))
    now = flow_rate(edges, root, z, q)
    return now[0], root * now[1], -sign * now[2], -sign * root * now[3]
