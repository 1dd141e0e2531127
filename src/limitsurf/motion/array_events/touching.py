"""Which tips are on the outline of a part, or so close that it makes no difference."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.kernels.outline_crossings import points_on_outline
from limitsurf.motion.array_events.border import BorderTip, border_at
from limitsurf.motion.array_events.bounces import BOUNCE
from limitsurf.motion.array_events.event_state import Carriers, State
from limitsurf.motion.array_events.tip_scene import Scene

__all__ = ["close_tips", "gone_round", "next_edge", "tips_under", "touching_tips"]

Array = NDArray[np.float64]


def tips_under(scene: Scene, pose: Array) -> NDArray[np.bool_]:
    """Return which tips are under the part."""
    x, y = scene.points.T
    return np.asarray(shapely.contains_xy(scene.part.at(pose), x, y))


def touching_tips(
    scene: Scene, pose: Array, border: list[BorderTip], near: float
) -> list[BorderTip]:
    """Return the tips up to `near` from the outline, but those that are kept on it anyway."""
    held, edges = {tip.tip for tip in border}, dict[int, list[int]]()
    found = np.empty((4 * len(scene.points) + 4, 2), dtype=np.int32)
    count = points_on_outline(pose, scene.edges, scene.points, near, found)
    for tip, edge in found[:count].tolist():
        if tip not in held:
            edges.setdefault(tip, []).append(edge)
    return [BorderTip(tip, (on[0], on[min(1, len(on) - 1)])) for tip, on in edges.items()]


def close_tips(scene: Scene, state: State, border: list[BorderTip]) -> list[BorderTip]:
    """Return the tips about which a part with mass bounces so little that it counts as over."""
    if not scene.inertial:
        return []
    slow = 2.0 * np.sqrt(2.0 * BOUNCE * scene.pitch * scene.rate_size)
    found = touching_tips(scene, state.pose, border, BOUNCE * scene.pitch)
    rows = border_at(scene, state.pose, state.twist, found).rows
    w = np.abs(rows @ state.twist).max(axis=1)
    return [tip for tip, speed in zip(found, w, strict=True) if speed <= slow]


def gone_round(
    scene: Scene, corners: list[BorderTip], carriers: Carriers, after: Array
) -> list[BorderTip]:
    """Return those of the tips on corners that are on their other side at the pose `after`.

    On a corner neither rates nor the sides of the two edges need tell where a tip goes.
    """
    if not corners:
        return []
    tips, outline = [tip.tip for tip in corners], scene.part.at(after)
    places = shapely.points(scene.points[tips])
    changed = shapely.contains(outline, places) != carriers.inside[tips]
    away = shapely.distance(shapely.boundary(outline), places) > scene.near
    return [tip for tip, wrong in zip(corners, changed & away, strict=True) if wrong]


def next_edge(scene: Scene, state: State, tip: BorderTip) -> BorderTip:
    """Return a tip at an end of its edge, with both edges there."""
    edge = tip.edges[0]
    along = border_at(scene, state.pose, state.twist, [tip]).along[0, 0]
    if along > 0.5 * scene.lengths[edge]:
        return BorderTip(tip.tip, (edge, int(scene.following[edge])))
    return BorderTip(tip.tip, (int(np.flatnonzero(scene.following == edge)[0]), edge))
