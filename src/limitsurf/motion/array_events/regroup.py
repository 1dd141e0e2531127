"""Which tips carry a part after an event: those inside, those kept on the outline."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import SolveFailed
from limitsurf.motion.array_events.border import Border, BorderTip, free_tips, settle
from limitsurf.motion.array_events.border_events import BorderCut, snapped
from limitsurf.motion.array_events.bounces import active_edges, settle_bounces
from limitsurf.motion.array_events.event_record import Record
from limitsurf.motion.array_events.event_state import Carriers, State, rates_at
from limitsurf.motion.array_events.sticking import keep_still, pivot_of, stopping_shares
from limitsurf.motion.array_events.tip_balance import Balance
from limitsurf.motion.array_events.tip_scene import Scene
from limitsurf.motion.array_events.touching import next_edge
from limitsurf.motion.trajectory import EventKind

__all__ = ["Regrouping"]

Array = NDArray[np.float64]


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
        keep_still(self._scene, trial, tips, -1)
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
            tips[cut.which] = next_edge(self._scene, state, tips[cut.which])
        return self._regroup(state, carriers, tips, shares)

    def turned(self, state: State, carriers: Carriers, corners: list[BorderTip]) -> Carriers:
        """Return the carriers after tips on corners have gone to the other side.

        Unless a part with mass keeps them on the outline, they do what they were seen to do.
        """
        if self._scene.inertial:
            start = carriers.inside[[tip.tip for tip in corners]].astype(np.float64)
            shares, held = np.append(carriers.shares, start), {t.tip for t in carriers.border}
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
        keep_still(scene, state, [carriers.border[k] for k in carriers.free], carriers.pivot)
        if not scene.inertial or scene.grip == 0.0 or not state.twist.any():
            return carriers
        shares = stopping_shares(scene, state, carriers)
        if shares is not None:
            kinetic = 0.5 * float(scene.mass @ state.twist**2)
            state.twist, state.numerical = np.zeros(3), state.numerical + kinetic
            self._record.event(state.time, EventKind.STICK)
            carriers.pivot = -1
            return self._regroup(state, carriers, carriers.border, shares)
        pivot = pivot_of(scene, state, carriers)
        if pivot >= 0:
            carriers.pivot = pivot
            self._record.event(state.time, EventKind.STICK, pivot)
            keep_still(scene, state, [carriers.border[k] for k in carriers.free], pivot)
        return carriers

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
            shares = settle(rates_at(scene, state, inside, tips)[0], start, scene.rate_size)
            return tips, shares, (shares > 0.0) & (shares < 1.0)
        new = np.array([tip.tip not in held or tip.corner for tip in tips], dtype=np.bool_)
        tips = active_edges(scene, state, tips)
        rated = partial(rates_at, scene, state)
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
        rates, geometry, balance = rates_at(scene, state, inside, border)
        edges = self._edges(border, geometry, balance, shares[kept])
        free = free_tips(rates, shares[kept], np.arange(len(kept)), scene.rate_size)
        new = Carriers(inside, edges, shares[kept], free, old.pivot)
        if len(free):
            state.pose = snapped(scene, state.pose, [edges[k] for k in free], (-1, -1))
        keep_still(scene, state, [edges[k] for k in free], new.pivot)
        return new

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
