"""The state of an event-driven motion, and its smooth stretches between events."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853, Radau

from limitsurf.errors import SolveFailed
from limitsurf.motion.array_events.border import Border, BorderTip, Rates, border_at, solve_free
from limitsurf.motion.array_events.tip_balance import Answer, Balance
from limitsurf.motion.array_events.tip_scene import Scene

__all__ = ["Carriers", "Path", "State", "Steps", "Stretch", "View", "integrate", "rates_at"]

Array = NDArray[np.float64]

_NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, 8) / 7)  # the ends of Chebyshev's, without 0
_FIT = np.linalg.inv(_NODES[:, None] ** np.arange(1, 8))
_RELATIVE = 100 * float(np.finfo(np.float64).eps)  # errors are measured by the pitch instead


@dataclass
class State:
    """Time, pose, twist (of a part with mass), and the energies dissipated and put in."""

    time: float
    pose: Array
    twist: Array
    energy: Array = field(default_factory=lambda: np.zeros(3))  # work, friction, drag
    numerical: float = 0.0


@dataclass
class Carriers:
    """Which tips carry: those inside, those kept on the outline with their shares, a pivot.

    `free` are the ones on the outline whose shares follow from staying there; the others' do not
    change, because the part moves along with them anyway.
    """

    inside: NDArray[np.bool_]
    border: list[BorderTip]
    shares: Array
    free: NDArray[np.int64]
    pivot: int = -1


class View(NamedTuple):
    """A state seen in full: shares, geometry of the border, loads and rates.

    `fading` is the rate [1/s] at which friction on slow contacts changes velocities.
    """

    shares: Array
    border: Border
    answer: Answer
    normal: float
    fading: float


class Stretch:
    """Smooth motion with the same carriers, from a state on."""

    def __init__(self, scene: Scene, state: State, carriers: Carriers) -> None:
        self._scene, self._state = scene, state
        self._border, self._free = list(carriers.border), carriers.free
        self._all = np.arange(len(self._border))
        self._tips = np.array([tip.tip for tip in self._border], dtype=np.int64)
        self._inner, self._pivot = np.flatnonzero(carriers.inside), carriers.pivot
        self._shares = carriers.shares

    def look(self, time: float, pose: Array, twist: Array) -> View:
        """Return loads and rates, with the shares that keep the border tips where they are."""
        scene = self._scene
        at = Balance(scene, pose, twist, time, self._inner, self._tips, self._pivot)
        border = border_at(scene, pose, twist, self._border)
        if len(self._border):
            rates = _scaled_rates(at, border)
            self._shares = solve_free(rates, self._shares, self._all, self._free, scene.rate_size)
        answer = at.answer(self._shares)
        return View(self._shares, border, answer, at.normal(self._shares), at.fading)

    def split(self, y: Array) -> tuple[Array, Array, Array]:
        """Return pose, twist and energies of displacements y from the start."""
        state, n = self._state, 6 if self._scene.inertial else 3
        twist = state.twist + y[3:6] if n == 6 else state.twist
        return state.pose + y[:3], twist, state.energy + y[n:]

    def derivative(self, time: float, y: Array) -> Array:
        """Return the derivative of the displacements."""
        scene = self._scene
        pose, twist, _ = self.split(y)
        answer = self.look(time, pose, twist).answer
        v = twist if scene.inertial else answer.rate
        work = float((answer.load + scene.load(time)) @ v) + answer.friction
        powers = [work, answer.friction, float(v @ (scene.drag * v))]
        rate = answer.rate if scene.inertial else v[:0]
        return np.concatenate([v, rate, powers])


class Steps(NamedTuple):
    """The first step to try, the longest allowed, and whether the equations are stiff."""

    first: float
    longest: float
    stiff: bool


def _scaled_rates(at: Balance, border: Border) -> Rates:
    """Return the tips' rates times the shares' sum: for constant forces linear in the shares."""
    return lambda s: border.rates(at.answer(s).rate) * at.carried(s)


def rates_at(
    scene: Scene, state: State, inside: NDArray[np.bool_], tips: list[BorderTip]
) -> tuple[Rates, Border, Balance]:
    """Return rates as a function of the shares of tips on the outline, and what they stem from."""
    where = np.array([tip.tip for tip in tips], dtype=np.int64)
    inner = np.flatnonzero(inside & ~np.isin(np.arange(len(inside)), where))
    at = Balance(scene, state.pose, state.twist, state.time, inner, where)
    border = border_at(scene, state.pose, state.twist, tips)
    return _scaled_rates(at, border), border, at


class Path(NamedTuple):
    """Displacements ``sum powers[m] tau^(m + 1)`` from a time on, for a length of time."""

    begin: float
    length: float
    powers: Array

    def at(self, tau: float) -> Array:
        """Return the displacements at ``begin + tau length``."""
        return np.asarray(tau ** np.arange(1, 8) @ self.powers)


def integrate(stretch: Stretch, begin: float, end: float, steps: Steps, tolerance: Array) -> Path:
    """Return one step of a Runge-Kutta method with its polynomial.

    DOP853, or Radau's where friction on slow contacts makes the equations stiff (E. Hairer,
    G. Wanner, *Solving Ordinary Differential Equations* I and II, 1993 and 1996).
    """
    longest = min(steps.longest, end - begin)
    method = Radau if steps.stiff else DOP853
    solver = method(
        stretch.derivative,
        begin,
        np.zeros(len(tolerance)),
        end,
        first_step=min(steps.first, longest),
        max_step=longest,
        rtol=_RELATIVE,
        atol=tolerance,
    )
    message = solver.step()
    if solver.status == "failed":
        raise SolveFailed(f"event_motion: at {begin:g} s: {message}")
    dense, length = solver.dense_output(), solver.t - begin
    rows = np.vstack([dense(begin + _NODES[:-1] * length).T, solver.y])
    return Path(begin, length, _FIT @ rows)
