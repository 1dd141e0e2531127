"""Tips on the outline of a part with mass: the velocity decides, but for bounces that are over."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from limitsurf.motion.array_events.border import Border, BorderTip, Rates, border_at, settle
from limitsurf.motion.array_events.event_state import State
from limitsurf.motion.array_events.tip_balance import Balance
from limitsurf.motion.array_events.tip_scene import Scene

__all__ = ["BOUNCE", "active_edges", "settle_bounces"]

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Rated = Callable[[Bools, list[BorderTip]], tuple[Rates, Border, Balance]]

#: Bounces about a border that are lower than this, relative to the pitch, are over: less than an
#: atom for the pitches of micro-machined arrays.
BOUNCE = 1e-6

_STAYS = 1e-9  # what rates of tips that stay may be


def active_edges(scene: Scene, state: State, tips: list[BorderTip]) -> list[BorderTip]:
    """Return the tips on corners with the edge that their velocity makes them cross first."""
    border = border_at(scene, state.pose, state.twist, tips)
    both = -border.rows @ state.twist
    which = np.where(border.convex, both.argmin(axis=1), both.argmax(axis=1))
    clear = np.abs(both[:, 0] - both[:, 1]) > 1e-9 * scene.speed
    return [
        BorderTip(tip.tip, (tip.edges[k],) * 2) if known else tip
        for tip, k, known in zip(tips, which, clear, strict=True)
    ]


def settle_bounces(
    scene: Scene,
    state: State,
    inside: Bools,
    tips: list[BorderTip],
    start: Array,
    new: Bools,
    rated: Rated,
) -> tuple[Array, Bools]:
    """Return shares of tips, and which of them stay on the outline.

    A tip that comes with g' = w comes back after a height ``w^2 / (2 |g''|)``; below `BOUNCE` it
    stays. `new` are tips that were not kept on the outline before, which start at `start`.
    """
    border = border_at(scene, state.pose, state.twist, tips)
    still = Border(border.gaps, border.along, border.rows, 0 * border.bias, border.convex)
    w = still.rates(state.twist)
    slowest = 2.0 * np.sqrt(2.0 * BOUNCE * scene.pitch * scene.rate_size)
    moves = new & (np.abs(w) > 1e-12 * scene.speed)
    goes = np.where(w > 0.0, 1.0, 0.0)
    slow = ~new | (np.abs(w) <= slowest)
    start = np.where(moves, goes, start)
    while True:
        shares, among, which = np.where(slow, start, goes), inside.copy(), np.flatnonzero(slow)
        among[[tips[k].tip for k in np.flatnonzero(~slow & (goes > 0.0))]] = True
        rates, _, at = rated(among, [tips[k] for k in which])
        shares[which] = settle(rates, start[which], scene.rate_size)
        stays, fits = _bounce(scene, rates, at, shares[which], new[which], w[which])
        wrong = which[moves[which] & ~fits]
        if not len(wrong):
            kept = np.zeros(len(tips), dtype=np.bool_)
            kept[which] = stays
            return shares, kept
        slow[wrong] = False


def _bounce(
    scene: Scene, rates: Rates, at: Balance, shares: Array, new: Bools, w: Array
) -> tuple[Bools, Bools]:
    """Return which tips stay on the outline, and for which that agrees with their velocity."""
    back, g = np.full(len(w), np.inf), rates(shares)
    for end, sign in ((0.0, 1.0), (1.0, -1.0)):
        s = np.where(new, end, shares)
        if at.carried(s) > 0.0:
            back = np.minimum(back, sign * rates(s) / at.carried(s))
    low = (back > 0.0) & (w * w <= 2.0 * back * BOUNCE * scene.pitch)
    stays = (shares > 0.0) & (shares < 1.0) | (np.abs(g) <= _STAYS * scene.rate_size)
    return stays, np.where(stays, low, (w > 0.0) == (shares >= 1.0))
