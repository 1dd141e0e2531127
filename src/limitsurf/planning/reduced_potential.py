r"""The potential of a part in a convex field, at rest in position for every orientation.

.. math:: w(\theta) = \min_{x, y} W(x, y, \theta), \qquad w'(\theta) = -M

at the minimum, M the moment there: the orientations at rest are the sign changes of w'. Where W is
convex in position they are all the equilibria of the part. By Schur's complement
:math:`w'' \le W_{\theta\theta}`, and the same holds for turns about any fixed point: this bounds
how fast w' may climb.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from limitsurf.actuators.potential_field import ConvexField
from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.density import JACOBIAN, POTENTIAL

__all__ = ["ReducedPotential", "force_scale"]

Array = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)
_STEPS = 200
_ARMIJO = 1e-4
_LOST = 1e4  # circumradii: a part that gets that far from the centres has no position of rest
_COARSE, _FINE = 64, 512


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
    across : (d, 2) float
        Directions in which the field changes.
    force : float
        Scale of forces [N].
    places : (k, 2) float
        Positions at rest at k orientations, evenly over a turn [m].
    """

    part: Part
    field: ConvexField
    across: Array
    force: float
    places: Array

    @classmethod
    def of(cls, part: Part, field: ConvexField) -> ReducedPotential | None:
        """Return it, or None where no position near the centres is at rest.

        Nearer than ten thousand circumradii and twice their spread.

        Raises
        ------
        InputError
            The field does not push.
        SolveFailed
            The positions did not settle.
        """
        origin = np.vstack([field.centers, np.zeros((1, 2))])[0]
        flat = field.flat
        across = np.linalg.svd(np.eye(2) - flat.T @ flat)[2][: 2 - len(flat)]
        scale = force_scale(part, field, origin)
        if not scale > 0.0:
            raise InputError("field", "does not push the part", remedy="give a density")
        places = np.tile(origin, (_COARSE, 1))
        for count in (_COARSE, _FINE):
            rough = cls(part, field, across, scale, places)
            theta = 2 * np.pi * np.arange(count) / count
            poses, states = rough._descend(np.column_stack([rough._start(theta), theta]))
            drift = np.abs(states[:, :2] @ flat.T).max(initial=0.0) > 1e4 * rough._quiet
            if drift or not (rough._distance(poses, origin) < rough._lost).all():
                return None
            if not (np.hypot(*states[:, :2].T) <= 1e4 * rough._quiet).all():
                raise SolveFailed("equilibria: positions of rest were not found", rough)
            places = poses[:, :2]
        return cls(part, field, across, scale, places)

    @property
    def noise(self) -> float:
        """Bound on the rounding errors of moments, as far as poses have digits [N m]."""
        return 4.0 * self._quiet * self.part.circumradius

    @property
    def rise(self) -> float:
        """Bound on the second derivative of w: the least one for turns about some point [J].

        For positions at most twice as far from a centre as any on the grid.
        """
        bounds = [self.field.turning_bound(self.part, None, 0.0)]
        for center in self.field.centers:
            reach = 2.0 * float(np.hypot(*(self.places - center).T).max())
            bounds.append(self.field.turning_bound(self.part, center, reach))
        return min(bounds)

    def position(self, theta: Array) -> Array:
        """Return positions of rest (k, 2) at orientations (k,) [m]."""
        return self._descend(np.column_stack([self._start(theta), theta]))[0][:, :2]

    def slope(self, theta: Array) -> Array:
        """Return w' (k,) at orientations (k,) [J]; corrected for what the position lacks."""
        _, states = self._descend(np.column_stack([self._start(theta), theta]))
        step = self._newton(states, np.full(len(theta), np.inf))
        correction = np.einsum("kd,kd->k", states[:, -3:-1] @ self.across.T, step)
        return np.asarray(-states[:, 2] - correction)

    @cached_property
    def _curve(self) -> CubicSpline:
        closed = np.vstack([self.places, self.places[:1]])
        return CubicSpline(np.linspace(0.0, 2 * np.pi, len(closed)), closed, bc_type="periodic")

    def _start(self, theta: Array) -> Array:
        """Return positions between those of the grid."""
        return np.asarray(self._curve(np.mod(theta, 2 * np.pi)))

    @property
    def _quiet(self) -> float:
        """Rounding of forces, as far as poses have digits [N]."""
        far = float(np.abs(self.places).max()) / self.part.circumradius
        return 4.0 * _EPS * self.force * (1.0 + far)

    @cached_property
    def _lost(self) -> float:
        """How far a part may go from a centre, in circumradii."""
        spread = np.ptp(self.field.centers, axis=0) if len(self.field.centers) else np.zeros(2)
        return _LOST + 2.0 * float(np.hypot(*spread)) / self.part.circumradius

    def _distance(self, poses: Array, place: Array) -> Array:
        """Return distances from a place in circumradii."""
        return np.asarray(np.hypot(*(poses[:, :2] - place).T) / self.part.circumradius)

    def _pull(self, states: Array) -> Array:
        """Return the size of the forces across."""
        return np.asarray(np.linalg.norm(states[:, :2] @ self.across.T, axis=1))

    def _newton(self, states: Array, cap: Array) -> Array:
        """Return regularised Newton steps (k, d) across, no longer than the cap (k,) [m]."""
        F, J = states[:, :2] @ self.across.T, states[:, JACOBIAN:].reshape(-1, 3, 3)
        H = -self.across @ J[:, :2, :2] @ self.across.T
        damping = np.linalg.norm(F, axis=1) / cap + 1e-15 * self.force / self.part.circumradius
        step = np.linalg.solve(H + damping[:, None, None] * np.eye(len(self.across)), F[:, :, None])
        return np.asarray(step[:, :, 0])

    def _descend(self, poses: Array) -> tuple[Array, Array]:
        """Return poses (k, 3) of least potential over the positions, and their states (k, 13).

        Newton's method on a convex function, regularised by the force over a radius of trust.
        """
        R, origin, states = self.part.circumradius, poses[:, :2].copy(), self._states(poses)
        cap, live = np.full(len(poses), R), np.arange(len(poses))
        for _ in range(_STEPS):
            live = live[self._pull(states[live]) > self._quiet]
            live = live[self._distance(poses[live], origin[live]) < self._lost]
            if len(live) == 0:
                break
            trial, here = poses[live], states[live]
            step = self._newton(here, cap[live]) @ self.across
            trial[:, :2] += step
            there = self._states(trial)
            better = self._improves(here, there, np.einsum("kd,kd->k", here[:, :2], step))
            good, bad = live[better], live[~better]
            poses[good], states[good] = trial[better], there[better]
            cap[good] *= 2.0
            cap[bad] *= 0.125
            live = live[better | (cap[live] > 1e-3 * _EPS * R)]
        return poses, states

    def _improves(self, here: Array, there: Array, gain: Array) -> NDArray[np.bool_]:
        """Return where a step lowers the potential as it should; where that is rounding, the force.

        `gain` is what the step would gain if the force stayed as it is.
        """
        rounding = 1e3 * _EPS * (np.abs(here[:, POTENTIAL]) + np.abs(there[:, POTENTIAL]))
        lower = there[:, POTENTIAL] <= here[:, POTENTIAL] - _ARMIJO * gain
        return np.where(gain > rounding, lower, self._pull(there) < self._pull(here))

    def _states(self, poses: Array) -> Array:
        return np.asarray(self.field.states(self.part, poses))
