"""A part with mass that stops, or turns about a contact that sticks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.motion.array_events.border import BorderTip, border_at, settle
from limitsurf.motion.array_events.event_state import Carriers, State, rates_at
from limitsurf.motion.array_events.tip_balance import Balance, contact_velocities
from limitsurf.motion.array_events.tip_scene import Scene
from limitsurf.tolerances import REST_SPEED

__all__ = ["keep_still", "pivot_of", "stopping_shares"]

Array = NDArray[np.float64]

#: Slower than this, relative to the speed of the drive, a contact may stick.
_STICK = 1e-6

#: So much slower than all others it must be: the part turns about it.
_SLOWER = 1e-2

#: So much of its friction disk it may need.
_SURE = 0.99


def keep_still(scene: Scene, state: State, tips: list[BorderTip], pivot: int) -> None:
    """Take away the velocity of tips away from the outline, and of the part at a pivot.

    The least change in the metric of the mass; the energy is that of the last bounces.
    """
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
    twist = (scaled - change) / root if rank < 3 else np.zeros(3)
    state.numerical += 0.5 * float(scene.mass @ (state.twist**2 - twist**2))
    state.twist = twist


def stopping_shares(scene: Scene, state: State, carriers: Carriers) -> Array | None:
    """Return shares with which friction can stop a slow part, None if it cannot."""
    if scene.rim_speed(state.twist) > REST_SPEED * scene.speed:
        return None
    still = State(state.time, state.pose, np.zeros(3))
    rates, _, at = rates_at(scene, still, carriers.inside, carriers.border)
    shares = settle(rates, carriers.shares, scene.rate_size)
    return shares if at.answer(shares).sticks else None


def pivot_of(scene: Scene, state: State, carriers: Carriers) -> int:
    """Return the contact that begins to stick while the part turns about it, -1 if none does."""
    inner = np.flatnonzero(carriers.inside)
    border = np.array([tip.tip for tip in carriers.border], dtype=np.int64)
    tips = np.concatenate([inner, border])
    u = contact_velocities(scene.points[tips] - state.pose[:2], state.twist)
    speeds = np.hypot(u[:, 0], u[:, 1])
    order = np.argsort(speeds)
    slow = min(_STICK * scene.speed, _SLOWER * speeds[order[min(1, len(order) - 1)]])
    if carriers.pivot >= 0 or not speeds[order[0]] < slow:
        return -1
    pivot = int(tips[order[0]])
    trial = State(state.time, state.pose, state.twist)
    keep_still(scene, trial, [carriers.border[k] for k in carriers.free], pivot)
    at = Balance(scene, state.pose, trial.twist, state.time, inner, border, pivot)
    needed = at.answer(carriers.shares).needed
    return pivot if trial.twist.any() and needed <= _SURE else -1
