r"""The potential of a part in a convex field, at rest in position for every orientation.

.. math:: w(\theta) = \min_{x, y} W(x, y, \theta), \qquad w'(\theta) = -M

at the minimum, M the moment there: the orientations at rest are the sign changes of w'. Where W is
convex in position they are all the equilibria of the part. By Schur's complement
:math:`w'' \le W_{\theta\theta}`, and the same holds for turns about any fixed point: this bounds
how fast w' may climb.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.potential_field import ConvexField
from limitsurf.geometry.part import Part

__all__ = ["ReducedPotential", "force_scale"]

Array = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)
_STEPS = 80
_LOST = 1e6  # circumradii: a part that gets that far has no position of rest
_GRID = 64


def force_scale(part: Part, field: ConvexField, origin: Array) -> float:
    """Return the largest force on a part at sample poses around a point [N]."""
    angle = 2 * np.pi * np.arange(8) / 8
    ring = 2.0 * part.circumradius * np.column_stack([np.cos(angle), np.sin(angle)])
    places = np.column_stack(
        [np.vstack([ring, ring, np.zeros((8, 2))]) + origin, np.tile(angle, 3)]
    )
    return float(np.hypot(*field.load(part, places)[:, :2].T).max())


@dataclass(frozen=True, eq=False)
class ReducedPotential:
    """A part in a convex field, and where it rests on a grid of orientations.

    Attributes
    ----------
    part, field : Part, ConvexField
        What rests where.
    origin : (2,) float
        Where to look first [m]; along flat directions the part stays there.
    across : (d, 2) float
        Directions in which the field changes.
    force : float
        Scale of forces [N].
    grid, places : (k,) and (k, 2) float
        Orientations over a turn, and positions at rest there [m].
    """

    part: Part
    field: ConvexField
    origin: Array
    across: Array
    force: float
    grid: Array
    places: Array

    @classmethod
    def of(cls, part: Part, field: ConvexField, origin: Array) -> ReducedPotential | None:
        """Return it, or None where the field has no position of rest for some orientation."""
        flat = field.flat
        across = np.linalg.svd(np.eye(2) - flat.T @ flat)[2][: 2 - len(flat)]
        grid = np.linspace(0.0, 2 * np.pi, _GRID + 1)
        start = np.broadcast_to(origin, (len(grid), 2))
        scale = force_scale(part, field, origin)
        reduced = cls(part, field, origin, across, scale, grid, np.array(start))
        places, rests = reduced._descend(grid, reduced.places)
        if not rests.all():
            return None
        return cls(part, field, origin, across, scale, grid, places)

    @property
    def noise(self) -> float:
        """Bound on the rounding errors of moments, as far as poses have digits [N m]."""
        far = float(np.abs(self.places).max())
        return 16.0 * _EPS * self.force * (self.part.circumradius + far)

    @property
    def rise(self) -> float:
        """Bound on the second derivative of w: the least one for turns about some point [J].

        For positions at most twice as far from a centre as any on the grid.
        """
        bounds = [self.field.turning_bound(self.part, None, 0.0)]
        for center in [self.origin, *self.field.centers]:
            reach = 2.0 * float(np.hypot(*(self.places - center).T).max())
            bounds.append(self.field.turning_bound(self.part, center, reach))
        return min(bounds)

    def position(self, theta: Array) -> Array:
        """Return positions of rest (k, 2) at orientations (k,) [m]."""
        return self._descend(theta, self._start(theta))[0]

    def slope(self, theta: Array) -> Array:
        """Return w' (k,) at orientations (k,) [J]; corrected for what the position lacks."""
        poses = np.column_stack([self.position(theta), theta])
        load, J = self.field.load(self.part, poses), self.field.jacobian(self.part, poses)
        step = self._newton(load, J, np.full(len(theta), np.inf))
        return np.asarray(-load[:, 2] - np.einsum("kd,kd->k", J[:, 2, :2] @ self.across.T, step))

    def _start(self, theta: Array) -> Array:
        """Return positions between those of the grid."""
        turn = np.mod(theta, 2 * np.pi)
        return np.column_stack([np.interp(turn, self.grid, x) for x in self.places.T])

    def _newton(self, load: Array, J: Array, cap: Array) -> Array:
        """Return regularised Newton steps (k, d) across, no longer than the cap (k,) [m]."""
        F = load[:, :2] @ self.across.T
        H = -self.across @ J[:, :2, :2] @ self.across.T
        size = np.linalg.norm(F, axis=1)
        damping = size / cap + 1e-15 * self.force / self.part.circumradius
        d = len(self.across)
        step = np.linalg.solve(H + damping[:, None, None] * np.eye(d), F[:, :, None])[:, :, 0]
        return np.asarray(step)

    def _descend(self, theta: Array, start: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return positions of least potential (k, 2), and which are at rest.

        Newton's method on a convex function, regularised by the force over a radius of trust.
        """
        R, poses = self.part.circumradius, np.column_stack([start, theta])
        cap, live = np.full(len(theta), R), np.arange(len(theta))
        load, W = self.field.load(self.part, poses), self.field.potential(self.part, poses)
        quiet = 4.0 * _EPS * self.force * (1.0 + np.abs(start).max() / R)
        for _ in range(_STEPS):
            live = live[self._pull(load[live]) > quiet]
            live = live[np.hypot(*(poses[live, :2] - start[live]).T) < _LOST * R]
            if len(live) == 0:
                break
            J, trial = self.field.jacobian(self.part, poses[live]), poses[live]
            trial[:, :2] += self._newton(load[live], J, cap[live]) @ self.across
            there, level = self.field.load(self.part, trial), self.field.potential(self.part, trial)
            better = (level < W[live]) | (self._pull(there) < self._pull(load[live]))
            good, bad = live[better], live[~better]
            poses[good], load[good], W[good] = trial[better], there[better], level[better]
            cap[good] *= 2.0
            cap[bad] *= 0.125
            live = live[better | (cap[live] > 1e-3 * _EPS * R)]
        near = np.hypot(*(poses[:, :2] - start).T) < _LOST * R
        return poses[:, :2], near & (np.hypot(*load[:, :2].T) <= 1e4 * quiet)

    def _pull(self, load: Array) -> Array:
        """Return the size of the forces across."""
        return np.asarray(np.linalg.norm(load[:, :2] @ self.across.T, axis=1))
