r"""A part on an activated array whose tips do at any speed what their motion makes them do.

`array_steps` takes what a tip can exert on a part at rest for what it exerts on a moving one. Here
each tip has the potential :math:`\Phi_i` of its mean friction (`OscillatingContact`):

.. math:: v = \arg\min_v\; \tfrac12 (v-v_0)^T M (v-v_0)
          + \Delta t \left( \sum_i \Phi_i(G_i^T v) + \tfrac12 v^T D v - F \cdot v \right)

so that the push falls as the part gets faster, and vanishes at the drift velocity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.contacts.friction_load import FrictionLoad, friction_load
from limitsurf.contacts.lattice_contacts import LatticeContacts
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.contacts.tip_dissipation import TipDissipation
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.slide import FRAME
from limitsurf.kernels.slide_step import (
    ENERGIES,
    HEAVIEST,
    LEFT_ARRAY,
    NEXT_FRAME,
    NOT_LIFTED,
    POSE,
    REST,
    STEPS,
    TIME,
    TIME_LIMIT,
    TWIST_NOW,
    WORST,
    Body,
)
from limitsurf.motion.array_steps import ground_of
from limitsurf.motion.load_table import LoadTable

__all__ = ["TipSteps"]

Array = NDArray[np.float64]

_CALL_STEPS = 200


@dataclass(frozen=True, eq=False)
class TipSteps:
    """A `Stepper` for oscillating tips; tips at the outline are points.

    Attributes
    ----------
    part : Part
        The part.
    body : Body
        Its weight, mass and drag.
    load : LoadTable
        External load.
    tip : OscillatingContact
        One tip; only the proportions of its normal force count. Each tip under the part moves like
        this, turned so that it pushes in its own direction.
    step, every, rest_speed : float
        Time step, time between frames [s], and speed of rest [m/s].
    """

    part: Part
    body: Body
    load: LoadTable
    tip: OscillatingContact
    step: float
    every: float
    rest_speed: float

    def __post_init__(self) -> None:
        """Check the tip."""
        if not isinstance(self.tip, OscillatingContact):
            raise InputError("tip", "is no OscillatingContact", value=self.tip)
        if self.tip.shape != ():
            raise InputError("tip", f"has shape {self.tip.shape}", remedy="give one tip")

    def advance(
        self, activation: Activation, motion: Array, until: float, final: bool
    ) -> tuple[int, Array, bool]:
        """Move on an activation; see `Stepper`."""
        sites = LatticeContacts(
            self.part,
            activation.array.site_pitch,
            activation.array.first_site,
            activation.active.shape,
        )
        rows: list[Array] = []
        for _ in range(_CALL_STEPS):
            dt = min(self.step, until - motion[TIME])
            over = dt <= 1e-9 * self.step
            dt = 0.0 if over else dt
            status = self._step(activation, sites, motion, dt, rows, over and final)
            if over or status != TIME_LIMIT:
                return status, _table(rows), True
        return TIME_LIMIT, _table(rows), False

    def _step(
        self,
        activation: Activation,
        sites: LatticeContacts,
        motion: Array,
        dt: float,
        rows: list[Array],
        show: bool,
    ) -> int:
        """Take a step and return the status; without dt, only show where the part is."""
        if not _over_cells(self.part, activation, motion[POSE : POSE + 3]):
            rows.append(_frame(motion, motion, np.zeros(3), 0.0, 0, self.body))
            return LEFT_ARRAY
        tips = self._tips_under(activation, sites, motion)
        if tips is None:
            rows.append(_frame(motion, motion, np.zeros(3), 0.0, 0, self.body))
            return NOT_LIFTED
        before = motion.copy()
        rests, load, bound = False, np.zeros(3), 0.0
        if dt > 0.0:
            rests, load, bound = self._solve(tips, motion, dt)
        due = dt > 0.0 and before[TIME] >= motion[NEXT_FRAME] - 1e-9 * self.step
        if show or rests or due:
            count = len(tips.position)
            rows.append(_frame(before, motion, load, bound, count, self.body))
            motion[NEXT_FRAME] = self.every * (np.floor(before[TIME] / self.every + 1e-9) + 1.0)
        return REST if rests else TIME_LIMIT

    def _tips_under(
        self, activation: Activation, sites: LatticeContacts, motion: Array
    ) -> TipDissipation | None:
        """Return the tips that carry the part, None if they cannot."""
        sites.move(motion[POSE : POSE + 3])
        running = activation.running[tuple(sites.sites.T)]
        position = sites.positions[running]
        ground = ground_of(activation)
        normal = self.body.weight / len(position) if len(position) else np.inf
        motion[HEAVIEST] = max(motion[HEAVIEST], normal)
        if normal > ground.lift:
            return None
        push = ground.lattice.directions[tuple(sites.sites[running].T)]
        strength = np.hypot(*push.T)
        force = self.tip.normal_force * (normal / self.tip.normal_force.mean())
        along = -push if self.tip.offset @ self.tip.direction < 0.0 else push
        contacts = OscillatingContact(self.tip.mu * strength, along, self.tip.tip_velocity, force)
        return TipDissipation(position, contacts)

    def _solve(self, tips: TipDissipation, motion: Array, dt: float) -> tuple[bool, Array, float]:
        """Take a step; return whether the part rests instead, the tips' load, and its bound."""
        M, D = self.body.mass, self.body.drag
        external = self.load(motion[TIME] + dt)
        v0 = motion[TWIST_NOW : TWIST_NOW + 3].copy()
        Q = M / dt + D
        found: FrictionLoad = friction_load(
            tips.resting, external + M * v0 / dt, 1.0 / Q, dissipation=tips
        )
        assert found.rate is not None
        v = np.where(found.sticks, 0.0, found.net / Q)
        load = found.friction + found.rate
        bound = float(found.projection.error_bound) * float(np.sqrt(Q[0]))
        motion[TWIST_NOW : TWIST_NOW + 3] = v
        motion[WORST] = max(motion[WORST], bound / self.body.weight)
        if self.load.steady and self._rests(v, v0 * M, load + external):
            return True, load, bound
        motion[TIME] += dt
        motion[POSE : POSE + 3] += dt * v
        work = (external + found.rate) @ v, -found.friction @ v, v @ (D * v)
        motion[ENERGIES : ENERGIES + 3] += dt * np.array(work)
        motion[ENERGIES + 3] += 0.5 * M @ (v - v0) ** 2
        motion[STEPS] += 1
        return False, load, bound

    def _rests(self, v: Array, momentum: Array, load: Array) -> bool:
        """Return whether the part rests, or hardly moves and will not; as the kernel does."""
        if not v.any():
            return not momentum.any()
        reach, D = self.body.reach, self.body.drag
        if np.hypot(v[0], v[1]) + reach * abs(v[2]) >= self.rest_speed or not D.all():
            return False
        terminal = np.hypot(load[0], load[1]) / D[0] + reach * abs(load[2]) / D[2]
        return bool(terminal < self.rest_speed)


def _over_cells(part: Part, activation: Activation, pose: Array) -> bool:
    """Return whether all of the part lies over the array."""
    x, y = part.at(pose).bounds[::2], part.at(pose).bounds[1::2]
    width, height = 0.5 * activation.array.width, 0.5 * activation.array.height
    return bool(-width <= x[0] and x[1] <= width and -height <= y[0] and y[1] <= height)


def _frame(at: Array, after: Array, load: Array, bound: float, count: int, body: Body) -> Array:
    """Return a frame as the kernel writes it."""
    v = at[TWIST_NOW : TWIST_NOW + 3]
    kinetic = 0.5 * body.mass @ v**2
    shown = after[TWIST_NOW : TWIST_NOW + 3]
    energies = at[ENERGIES : ENERGIES + 4]
    return np.array([*at[TIME : POSE + 3], *shown, *load, bound, count, kinetic, *energies])


def _table(rows: list[Array]) -> Array:
    return np.array(rows).reshape(-1, FRAME)
