r"""One step of RODAS, a stiffly accurate Rosenbrock method of order 4(3), for sliding feet.

E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., section IV.7. Each of
six stages solves, with the Jacobian J at the beginning of the step,

.. math:: \left( \frac{1}{\gamma h} I - J \right) U_i = f(t + \alpha_i h, y + \sum_j a_{ij} U_j)
          + \frac1h \sum_j c_{ij} U_j + \gamma_i h f_t, \qquad y_1 = y + \sum_j a_{6j} U_j + U_6 ,

and :math:`U_6` estimates the error. The method is L-stable: directions of slow contacts, which
settle in no time, need no small steps. The state is (v, theta); theta is eliminated, so that one
matrix of size three is inverted.
"""

from __future__ import annotations

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_problem import Rows, inverse_rows, times_rows
from limitsurf.kernels.feet_rates import Feet, Freedom, Rate, curvature, rate, turning_about
from limitsurf.kernels.load_table import Load
from limitsurf.kernels.rodas import ALPHA, GAMMA, RATES, A, C
from limitsurf.kernels.symmetric3 import Symmetric, times
from limitsurf.kernels.vectors import Vector, along, scaled

__all__ = ["rosenbrock_step"]


@compiled
def _jacobian(feet: Feet, freedom: Freedom, v: Vector, H: Symmetric) -> Rows:
    """Return the rows of the derivative of the rate of v by v."""
    d, m = feet.drag, feet.mass
    K = H[0] + d[0], H[1], H[2] + d[1], H[3], H[4], H[5] + d[2]
    if freedom.pivot < 0:
        return (
            (-K[0] / m, -K[1] / m + v[2], -K[3] / m + v[1]),
            (-K[1] / m - v[2], -K[2] / m, -K[4] / m - v[0]),
            (-K[3] / feet.inertia, -K[4] / feet.inertia, -K[5] / feet.inertia),
        )
    p = turning_about(freedom)
    inertia = feet.inertia + feet.mass * (freedom.x * freedom.x + freedom.y * freedom.y)
    row = scaled(-1.0 / inertia, times(K, p))
    return scaled(p[0], row), scaled(p[1], row), row


@compiled
def _inverse(J: Rows, shift: float, turn: Vector) -> Rows:
    """Return the inverse of ``shift I - J - turn e3'``."""
    a = shift - J[0][0], -J[0][1], -J[0][2] - turn[0]
    b = -J[1][0], shift - J[1][1], -J[1][2] - turn[1]
    c = -J[2][0], -J[2][1], shift - J[2][2] - turn[2]
    T = inverse_rows((a, b, c))  # transposed
    return (
        (T[0][0], T[1][0], T[2][0]),
        (T[0][1], T[1][1], T[2][1]),
        (T[0][2], T[1][2], T[2][2]),
    )


@compiled
def _by_mass(feet: Feet, freedom: Freedom, F: Vector) -> Vector:
    """Return ``B F``."""
    if freedom.pivot < 0:
        return F[0] / feet.mass, F[1] / feet.mass, F[2] / feet.inertia
    p = turning_about(freedom)
    inertia = feet.inertia + feet.mass * (freedom.x * freedom.x + freedom.y * freedom.y)
    return scaled((p[0] * F[0] + p[1] * F[1] + F[2]) / inertia, p)


@compiled
def rosenbrock_step(
    feet: Feet,
    freedom: Freedom,
    load: Load,
    t: float,
    v: Vector,
    theta: float,
    now: Rate,
    h: float,
    U: Floats,
) -> tuple[Vector, float, Vector]:
    """Return twist and angle after a step h, and the estimated error of the twist.

    `now` is the rate at the beginning; `U` is room for (6, 4) numbers.
    """
    H = curvature(feet.data, v)
    by_angle = _by_mass(feet, freedom, now.by_angle)
    by_time = _by_mass(feet, freedom, now.by_time)
    step = GAMMA * h
    inverse = _inverse(_jacobian(feet, freedom, v, H), 1.0 / step, scaled(step, by_angle))
    w, angle, change, turn = v, theta, now.v, v[2]
    for i in range(6):
        if i > 0:
            w, angle = v, theta
            for j in range(i):
                w = along(w, A[i, j], (U[j, 0], U[j, 1], U[j, 2]))
                angle += A[i, j] * U[j, 3]
            there = rate(feet, freedom, load, t + ALPHA[i] * h, w, angle)
            change, turn = there.v, w[2]
        change = along(change, RATES[i] * h, by_time)
        for j in range(i):
            change = along(change, C[i, j] / h, (U[j, 0], U[j, 1], U[j, 2]))
            turn += C[i, j] / h * U[j, 3]
        u = times_rows(inverse, along(change, step * turn, by_angle))
        U[i, 0], U[i, 1], U[i, 2], U[i, 3] = u[0], u[1], u[2], step * (turn + u[2])
    error = U[5, 0], U[5, 1], U[5, 2]
    return along(w, 1.0, error), angle + U[5, 3], error
