"""Which tips carry a part after an event: those inside, those kept on the outline."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import SolveFailed
from limitsurf.motion.border import Border, BorderTip, Rates, border_at, free_tips, settle
from limitsurf.motion.border_events import BorderCut, snapped
from limitsurf.motion.bounces import active_edges, settle_bounces
from limitsurf.motion.event_record import Record
from limitsurf.motion.event_state import Carriers, State, scaled_rates
from limitsurf.motion.tip_balance import Balance, contact_velocities
from limitsurf.motion.tip_scene import Scene
from limitsurf.motion.trajectory import EventKind
from limitsurf.tolerances import REST_SPEED

__all__ = ["Regrouping"]

Array = NDArray[np.float64]

#: Slower than this, relative to the speed of the drive, a contact may stick.
_STICK = 1e-6

#: So much of its friction disk a contact may need to stick.
_SURE = 0.99

#: Slower than that, the part is stopped if friction can hold it.
_STOP = REST_SPEED


class Regrouping:
    """Regroups the tips at events, and writes these to a record."""

    def __init__(self, scene: Scene, record: Record) -> None:
        self._scene, self._record = scene, record

    def first(self, state: State, inside: NDArray[np.bool_], tips: list[BorderTip]) -> Carriers:
        """Return the carriers at the start; tips on the outline begin with half a share."""
        inside[[tip.tip for tip in tips]] = False
        carriers = Carriers(inside, [], np.zeros(0), np.zeros(0, dtype=np.int64))
        return self._regroup(state, carriers, tips, np.full(len(tips), 0.5), quiet=True)

    def crossing(
        self, state: State, carriers: Carriers, touching: list[BorderTip], close: list[BorderTip]
    ) -> Carriers:
        """Return the carriers after tips have come to the outline.

        Those that are as `close` as the last bounces are high stay there if all of them do.
        """
        held = {tip.tip for tip in carriers.border}
        extra = [tip for tip in close if tip not in touching]
        if extra:
            kept = self._together(state, carriers, carriers.border + touching + extra)
            if kept is not None:
                return kept
        start = carriers.inside[[tip.tip for tip in touching]].astype(np.float64)
        shares = np.concatenate([carriers.shares, start])
        return self._regroup(state, carriers, carriers.border + touching, shares)

    def _together(self, state: State, carriers: Carriers, tips: list[BorderTip]) -> Carriers | None:
        """Return the carriers if tips near the outline stay on it once they are put there."""
        arrived = tips[len(carriers.border) :]
        start = carriers.inside[[tip.tip for tip in arrived]].astype(np.float64)
        shares = np.concatenate([carriers.shares, start])
        pose = snapped(self._scene, state.pose, tips, (-1, -1))
        trial = State(state.time, pose, state.twist, state.energy, state.numerical)
        self._keep(trial, tips, -1)
        try:
            settled = self._settled(trial, carriers, tips, shares, {tip.tip for tip in tips})
        except SolveFailed:
            return None
        if not settled[2].all():
            return None
        state.pose, state.twist, state.numerical = trial.pose, trial.twist, trial.numerical
        return self._adopted(state, carriers, *settled[:2])

    def border_event(self, state: State, carriers: Carriers, cut: BorderCut) -> Carriers:
        """Return the carriers after an event of those on the outline."""
        tips, shares = list(carriers.border), np.clip(carriers.shares, 0.0, 1.0)
        if cut.kind == "slip":
            self._record.event(state.time, EventKind.SLIP, carriers.pivot)
            carriers.pivot = -1
            return carriers
        if cut.kind == "start":
            self._record.event(state.time, EventKind.SLIP)
            return carriers
        if cut.kind == "corner":
            tips[cut.index] = self._at_corner(state, tips[cut.index])
        return self._regroup(state, carriers, tips, shares)

    def turned(self, state: State, carriers: Carriers, corners: list[BorderTip]) -> Carriers:
        """Return the carriers after tips on corners have gone to the other side.

        Unless a part with mass keeps them on the outline, they do what they were seen to do.
        """
        if self._scene.inertial:
            start = carriers.inside[[tip.tip for tip in corners]].astype(np.float64)
            shares, held = (
                np.concatenate([carriers.shares, start]),
                {t.tip for t in carriers.border},
            )
            settled = self._settled(state, carriers, carriers.border + corners, shares, held)
            if settled[2][len(carriers.border) :].any():
                return self._adopted(state, carriers, *settled[:2])
        inside = carriers.inside.copy()
        for tip in corners:
            inside[tip.tip] = not inside[tip.tip]
            kind = EventKind.ENTER if inside[tip.tip] else EventKind.LEAVE
            self._record.event(state.time, kind, tip.tip)
        now = Carriers(inside, carriers.border, carriers.shares, carriers.free, carriers.pivot)
        return self._regroup(state, now, carriers.border, carriers.shares)

    def step(self, state: State, carriers: Carriers) -> Carriers:
        """Return the carriers after a step without event: contacts may have come to rest."""
        scene = self._scene
        self._project(state, carriers)
        if not scene.inertial or scene.grip == 0.0 or not state.twist.any():
            return carriers
        if scene.rim_speed(state.twist) <= _STOP * scene.speed:
            return self._stop(state, carriers)
        return self._pivot(state, carriers)

    def _at_corner(self, state: State, tip: BorderTip) -> BorderTip:
        scene, edge = self._scene, tip.edges[0]
        along = border_at(scene, state.pose, state.twist, [tip]).along[0, 0]
        if along > 0.5 * scene.lengths[edge]:
            return BorderTip(tip.tip, (edge, int(scene.following[edge])))
        return BorderTip(tip.tip, (int(np.flatnonzero(scene.following == edge)[0]), edge))

    def _regroup(
        self,
        state: State,
        old: Carriers,
        tips: list[BorderTip],
        start: Array,
        *,
        quiet: bool = False,
    ) -> Carriers:
        """Return the carriers with new shares of the tips on the outline."""
        held = {tip.tip for tip in old.border}
        tips, shares, _ = self._settled(state, old, tips, start, held)
        return self._adopted(state, old, tips, shares, quiet=quiet)

    def _settled(
        self, state: State, old: Carriers, tips: list[BorderTip], start: Array, held: set[int]
    ) -> tuple[list[BorderTip], Array, NDArray[np.bool_]]:
        """Return the tips, their shares, and which of them stay on the outline."""
        scene, inside = self._scene, old.inside.copy()
        inside[[tip.tip for tip in tips]] = False
        if not scene.inertial:
            shares = settle(self._rates(state, inside, tips)[0], start, scene.rate_size)
            return tips, shares, (shares > 0.0) & (shares < 1.0)
        new = np.array([tip.tip not in held or tip.corner for tip in tips], dtype=np.bool_)
        tips = active_edges(scene, state, tips)
        rated = partial(self._rates, state)
        return tips, *settle_bounces(scene, state, inside, tips, start, new, rated)

    def _adopted(
        self,
        state: State,
        old: Carriers,
        tips: list[BorderTip],
        shares: Array,
        *,
        quiet: bool = False,
    ) -> Carriers:
        """Return the carriers with these shares, and tell what changes."""
        scene, inside = self._scene, old.inside.copy()
        held = {tip.tip for tip in old.border}
        for tip, share in zip(tips, shares, strict=True):
            inside[tip.tip] = share >= 1.0
            self._tell(state.time, tip.tip, share, old, held, quiet)
        kept = np.flatnonzero((shares > 0.0) & (shares < 1.0))
        border = [tips[k] for k in kept]
        rates, geometry, balance = self._rates(state, inside, border)
        edges = self._edges(border, geometry, balance, shares[kept])
        free = free_tips(rates, shares[kept], np.arange(len(kept)), scene.rate_size)
        new = Carriers(inside, edges, shares[kept], free, old.pivot)
        if len(free):
            state.pose = snapped(scene, state.pose, [edges[k] for k in free], (-1, -1))
        self._project(state, new)
        return new

    def _rates(
        self, state: State, inside: NDArray[np.bool_], tips: list[BorderTip]
    ) -> tuple[Rates, Border, Balance]:
        where = np.array([tip.tip for tip in tips], dtype=np.int64)
        inner = np.flatnonzero(inside & ~np.isin(np.arange(len(inside)), where))
        at = Balance(self._scene, state.pose, state.twist, state.time, inner, where)
        border = border_at(self._scene, state.pose, state.twist, tips)
        return scaled_rates(at, border), border, at

    def _tell(
        self, time: float, tip: int, share: float, old: Carriers, held: set[int], quiet: bool
    ) -> None:
        """Record what became of a tip on the outline."""
        kept = 0.0 < share < 1.0
        if kept != (tip in held):
            self._record.event(time, EventKind.CAPTURE if kept else EventKind.RELEASE, tip)
        elif not kept and not quiet and old.inside[tip] != (share >= 1.0):
            self._record.event(time, EventKind.ENTER if share >= 1.0 else EventKind.LEAVE, tip)

    def _edges(
        self, tips: list[BorderTip], border: Border, at: Balance, shares: Array
    ) -> list[BorderTip]:
        """Return the tips with the edge of two at a corner that they move along."""
        both = border.bias - border.rows @ at.answer(shares).rate
        which = np.where(border.convex, both.argmin(axis=1), both.argmax(axis=1))
        edges = [tip.edges[k] for tip, k in zip(tips, which, strict=True)]
        return [BorderTip(tip.tip, (e, e)) for tip, e in zip(tips, edges, strict=True)]

    def _project(self, state: State, carriers: Carriers) -> None:
        """Take away the velocity with which a part with mass would leave tips that it keeps."""
        tips = [carriers.border[k] for k in carriers.free]
        self._keep(state, tips, carriers.pivot)

    def _keep(self, state: State, tips: list[BorderTip], pivot: int) -> None:
        """Take away the velocity with which tips would leave the outline, and a pivot its place."""
        scene = self._scene
        if not state.twist.any() or (not tips and pivot < 0):
            return
        rows = border_at(scene, state.pose, state.twist, tips).rows[:, 0]
        if pivot >= 0:
            x, y = scene.points[pivot] - state.pose[:2]
            rows = np.vstack([rows, [1.0, 0.0, -y], [0.0, 1.0, x]])
        root = np.sqrt(scene.mass)
        scaled, units = root * state.twist, rows / root
        units = units / np.linalg.norm(units, axis=1)[:, None]
        change, _, rank, _ = np.linalg.lstsq(units, units @ scaled, rcond=1e-9)
        self._slow_down(state, (scaled - change) / root if rank < 3 else np.zeros(3))

    def _slow_down(self, state: State, twist: Array) -> None:
        mass = self._scene.mass
        state.numerical += 0.5 * float(state.twist @ (mass * state.twist) - twist @ (mass * twist))
        state.twist = twist

    def _stop(self, state: State, carriers: Carriers) -> Carriers:
        """Stop the part if friction, and shares on the outline, hold it."""
        still = State(state.time, state.pose, np.zeros(3))
        rates, _, at = self._rates(still, carriers.inside, carriers.border)
        shares = settle(rates, carriers.shares, self._scene.rate_size)
        if not at.answer(shares).sticks:
            return carriers
        self._slow_down(state, still.twist)
        self._record.event(state.time, EventKind.STICK)
        carriers.pivot = -1
        return self._regroup(state, carriers, carriers.border, shares)

    def _pivot(self, state: State, carriers: Carriers) -> Carriers:
        """Let the slowest contact stick if its friction suffices to turn the part about it."""
        scene, inner = self._scene, np.flatnonzero(carriers.inside)
        border = np.array([tip.tip for tip in carriers.border], dtype=np.int64)
        tips = np.concatenate([inner, border])
        u = contact_velocities(scene.points[tips] - state.pose[:2], state.twist)
        speeds = np.hypot(u[:, 0], u[:, 1])
        order = np.argsort(speeds)
        slow = min(_STICK * scene.speed, 1e-2 * speeds[order[min(1, len(order) - 1)]])
        if carriers.pivot >= 0 or not speeds[order[0]] < slow:
            return carriers
        trial = State(state.time, state.pose, state.twist, numerical=state.numerical)
        pivot = carriers.pivot = int(tips[order[0]])
        self._project(trial, carriers)
        at = Balance(scene, state.pose, trial.twist, state.time, inner, border, pivot)
        if trial.twist.any() and at.answer(carriers.shares).needed <= _SURE:
            self._record.event(state.time, EventKind.STICK, pivot)
            state.twist, state.numerical = trial.twist, trial.numerical
        else:
            carriers.pivot = -1
        return carriers
