r"""What a step of a part on feet changes: place, twist, and where the energy went.

A quantity that does not act back on the motion, p with rate :math:`\dot p`, is integrated by the
corrected trapezoidal rule :math:`\tfrac h2 (p_0 + p_1) + \tfrac{h^2}{12} (\dot p_0 - \dot p_1)`.
"""

from __future__ import annotations

from limitsurf.kernels.compile import compiled
from limitsurf.kernels.feet_hold import size_of
from limitsurf.kernels.feet_rates import Feet, Freedom, Rate, rate
from limitsurf.kernels.feet_run import SCALE, TURN, WORK, Run, T, X, Y, set_twist, twist
from limitsurf.kernels.feet_stick import place_about_pivot
from limitsurf.kernels.load_table import turned
from limitsurf.kernels.vectors import Vector, along, dot

__all__ = ["accept"]


@compiled
def _shift(state_v: Vector, change: Vector, angle: float) -> tuple[Vector, Vector]:
    """Return velocity and acceleration of the centre of mass in world axes."""
    v, w = state_v, state_v[2]
    a = change[0] - w * v[1], change[1] + w * v[0], change[2]
    return turned(v, -angle), turned(a, -angle)


@compiled
def _rule(h: float, p0: float, p1: float, d0: float, d1: float) -> float:
    """Return the integral by the corrected trapezoidal rule."""
    return 0.5 * h * (p0 + p1) + h * h / 12.0 * (d0 - d1)


@compiled
def _powers(feet: Feet, now: Rate, v: Vector) -> tuple[Vector, Vector]:
    """Return the powers of loads, friction and drag, and their rates."""
    d = feet.drag
    dv = d[0] * v[0], d[1] * v[1], d[2] * v[2]
    rate_of_load = along(now.by_time, v[2], now.by_angle)
    return (
        (dot(now.load, v), dot(now.friction, v), dot(dv, v)),
        (
            dot(now.load, now.v) + dot(rate_of_load, v),
            dot(now.friction, now.v),
            2.0 * dot(dv, now.v),
        ),
    )


@compiled
def accept(run: Run, freedom: Freedom, now: Rate, h: float, v1: Vector, angle1: float) -> None:
    """Take a step: place, energies, twist, time."""
    state, feet = run.state, run.feet
    v0, angle0 = twist(state), state[TURN]
    end = rate(feet, freedom, run.load, state[T] + h, v1, angle1)
    p0, d0 = _powers(feet, now, v0)
    p1, d1 = _powers(feet, end, v1)
    for k in range(3):
        state[WORK + k] += _rule(h, p0[k], p1[k], d0[k], d1[k])
    u0, a0 = _shift(v0, now.v, angle0)
    u1, a1 = _shift(v1, end.v, angle1)
    state[X] += _rule(h, u0[0], u1[0], a0[0], a1[0])
    state[Y] += _rule(h, u0[1], u1[1], a0[1], a1[1])
    state[TURN] = angle1
    if freedom.pivot >= 0:
        place_about_pivot(run, freedom)
    set_twist(state, v1)
    state[T] += h
    state[SCALE] = max(state[SCALE], size_of(run.holder, v1))
