r"""Loads of the tips that carry a part, for given shares of those on its outline.

A tip with share :math:`s_i` carries :math:`W s_i / \sum_j s_j`; it is 1 inside. At rest, or without
mass, friction is the closest point of the sum of the tips' disks (``driven_twist``); on a moving
part with mass it opposes the velocity :math:`u_i` of each contact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.contact_problem import new_best
from limitsurf.kernels.driven_twist import driven_twist
from limitsurf.motion.array_events.tip_scene import Scene
from limitsurf.tolerances import CONTACT_SUM

__all__ = ["Answer", "Balance", "contact_velocities", "load_rows"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: Slower than this, relative to the speed of the drive, friction of a contact fades to zero.
_FADE = 1e-9


class Answer(NamedTuple):
    """Twist, or acceleration of a part with mass; loads of the tips; power of friction [W].

    `bound` is the certified error of the loads, `sticks` whether friction holds the part, and
    `needed` how much of its friction disk a sticking contact needs, as a share of it.
    """

    rate: Array
    load: Array
    friction: float
    bound: float
    sticks: bool
    needed: float


def load_rows(arms: Array, forces: Array) -> Array:
    """Return the loads (n, 3) of forces at points."""
    moments = arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]
    return np.column_stack([forces, moments])


def contact_velocities(arms: Array, twist: Array) -> Array:
    """Return the velocities (n, 2) of the part at points."""
    return np.column_stack([twist[0] - twist[2] * arms[:, 1], twist[1] + twist[2] * arms[:, 0]])


class Balance:
    """The tips under a part at a pose, and what they do as a function of the shares.

    Parameters
    ----------
    scene : Scene
        Part and tips.
    pose, twist : (3,) float
        Where the part is, and how it moves (not used without mass).
    time : float
        For the external load.
    inner, border : (n,), (k,) int
        Tips inside, and those on the outline that have shares.
    pivot : int
        A tip that sticks while the part turns about it, -1 if none does.
    """

    def __init__(
        self,
        scene: Scene,
        pose: Array,
        twist: Array,
        time: float,
        inner: Indices,
        border: Indices,
        pivot: int = -1,
    ) -> None:
        self._scene, self._inner = scene, len(inner)
        tips = np.concatenate([inner, border])
        arms, forces = scene.points[tips] - pose[:2], scene.forces[tips]
        self._arms, self._external = arms, scene.load(time)
        self._slides = scene.inertial and bool(twist.any())
        self._speeds = np.zeros(len(tips))
        self._base = self._external
        if self._slides:
            self._base = self._external - scene.drag * twist
        if self._slides and scene.grip > 0.0:
            u = contact_velocities(arms, twist)
            self._speeds = np.hypot(u[:, 0], u[:, 1])
            if pivot >= 0:
                u[tips == pivot] = self._speeds[tips == pivot] = 0.0
            fade = max(_FADE * scene.speed, 1e-100)
            forces = forces - scene.grip * u / np.hypot(self._speeds, fade)[:, None]
        rows = load_rows(arms, forces)
        self._own, self._rows = rows[: self._inner].sum(axis=0), rows[self._inner :]
        self._pivot = int(np.flatnonzero(tips == pivot)[0]) if pivot in tips else -1
        self._turning = twist[2] ** 2 if self._slides else 0.0
        self._best = new_best()

    def normal(self, shares: Array) -> float:
        """Return the normal force on a tip inside."""
        carried = self._inner + float(shares.sum())
        return self._scene.weight / carried if carried > 0.0 else np.inf

    @property
    def fading(self) -> float:
        """Rate [1/s] at which friction of a sliding part changes its velocity."""
        if not self._slides or self._scene.grip == 0.0 or not self._inner:
            return 0.0
        slowness = np.mean(1.0 / np.maximum(self._speeds, _FADE * self._scene.speed))
        return float(self._scene.grip * self._scene.weight / self._scene.mass[0] * slowness)

    def carried(self, shares: Array) -> float:
        """Return the sum of the shares over the number of tips."""
        return (self._inner + float(shares.sum())) / max(self._inner + len(shares), 1)

    def answer(self, shares: Array) -> Answer:
        """Return what happens for the shares (k,) of the tips on the outline."""
        scene, normal = self._scene, self.normal(shares)
        if not np.isfinite(normal):
            return Answer(self._base / scene.quadratic, np.zeros(3), 0.0, 0.0, False, 0.0)
        pushes = normal * (self._own + shares @ self._rows)
        if not self._slides and scene.grip > 0.0:
            return self._closest(pushes, normal, shares)
        friction = 0.0
        if self._slides and scene.grip > 0.0:
            speeds = self._speeds[: self._inner].sum() + shares @ self._speeds[self._inner :]
            friction = float(normal * scene.grip * speeds)
        rate, needed = (self._base + pushes) / scene.quadratic, 0.0
        if self._pivot >= 0:
            hold, limit = self._hold(rate), normal * scene.grip
            if self._pivot >= self._inner:
                limit *= shares[self._pivot - self._inner]
            held = load_rows(self._arms[[self._pivot]], hold[None])[0]
            rate, pushes = rate + held / scene.quadratic, pushes + held
            needed = float(np.hypot(*hold)) / max(limit, 1e-300)
        return Answer(rate, pushes, friction, 0.0, False, needed)

    def _hold(self, rate: Array) -> Array:
        """Return the force (2,) that keeps the pivot still: its acceleration is w^2 r there."""
        (x, y), (mass, _, inertia) = self._arms[self._pivot], self._scene.quadratic
        G = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
        mobility = (G / np.array([mass, mass, inertia])) @ G.T
        wanted = self._turning * np.array([x, y])
        return np.asarray(np.linalg.solve(mobility, wanted - G @ rate))

    def _closest(self, pushes: Array, normal: float, shares: Array) -> Answer:
        """Return the answer of the closest-point problem."""
        scene = self._scene
        radius = np.concatenate([np.ones(self._inner), np.maximum(shares, 0.0)])
        contacts = np.vstack([self._arms.T, scene.grip * normal * radius])
        out = np.empty(6)
        sticks, bound = driven_twist(
            contacts, self._base + pushes, scene.quadratic, CONTACT_SUM, self._best, out
        )
        friction = 0.0 if scene.inertial else -float(out[:3] @ out[3:])
        return Answer(out[:3], pushes + out[3:], friction, bound, sticks, 0.0)
