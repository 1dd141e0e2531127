"""What ends a stretch on the border of cells: corners, shares used up, contacts that slip."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from limitsurf.motion.array_events.border import BorderTip, border_at
from limitsurf.motion.array_events.event_state import Carriers, Path, Stretch, View
from limitsurf.motion.array_events.tip_scene import Scene

__all__ = ["BorderCut", "first_border_cut", "snapped"]

Array = NDArray[np.float64]
Kind = Literal["corner", "share", "slip", "start", "loose"]

_LOOKS = 4  # along a path
_SHARE = 1e-10  # beyond its bounds
_MOMENT = 1e-12  # of a path, after which a part that starts is seen to move
_LOOSE = 1e-9  # rates of tips that stay by themselves, relative to their size


class BorderCut(NamedTuple):
    """What happens at tau, to which of the tips on the outline."""

    tau: float
    kind: Kind
    which: int = -1


def snapped(scene: Scene, pose: Array, tips: list[BorderTip], crossing: tuple[int, int]) -> Array:
    """Return the pose nearby at which tips lie on their edges, and one on the edge it crosses."""
    extra = [BorderTip(crossing[0], (crossing[1], crossing[1]))] if crossing[0] >= 0 else []
    metric = np.array([1.0, 1.0, 1.0 / scene.radius])
    for _ in range(3):
        border = border_at(scene, pose, np.zeros(3), tips + extra)
        gaps, rows = border.gaps[:, 0], border.rows[:, 0] * metric
        pose = pose + metric * np.linalg.lstsq(rows, gaps, rcond=1e-9)[0]
    return pose


def first_border_cut(
    scene: Scene, stretch: Stretch, path: Path, carriers: Carriers, view: View, until: float
) -> BorderCut | None:
    """Return the first event of border tips, the pivot or a part that sticks, before `until`."""
    if not carriers.border and carriers.pivot < 0 and not view.answer.sticks:
        return None
    margins = _Margins(scene, stretch, path, carriers, view.answer.sticks)
    before, low = margins.at(0.0), 0.0
    for high in np.linspace(0.0, until, _LOOKS + 1)[1:]:
        after = margins.at(high)
        cuts = [
            BorderCut(margins.root(j, low, high, before[j]), *margins.meaning(j))
            for j in np.flatnonzero(after < -margins.slack).tolist()
        ]
        if cuts:
            first = min(cuts, key=lambda cut: cut.tau)
            return first if first.tau < until else None
        before, low = after, float(high)
    return None


class _Margins:
    """Numbers that are positive while a stretch goes on."""

    def __init__(
        self, scene: Scene, stretch: Stretch, path: Path, carriers: Carriers, stuck: bool
    ) -> None:
        self._scene, self._stretch, self._path = scene, stretch, path
        self._carriers, self._stuck = carriers, stuck
        k, f = len(carriers.border), len(carriers.free)
        frozen = k - f
        self._frozen = np.setdiff1d(np.arange(k), carriers.free)
        self._lengths = scene.lengths[[tip.edges[0] for tip in carriers.border]]
        near, share = np.full(2 * k, scene.near), np.full(2 * f, _SHARE)
        self.slack = np.concatenate([near, share, np.zeros(frozen + 2)])

    def at(self, tau: float) -> Array:
        """Return the margins at tau."""
        path, carriers = self._path, self._carriers
        pose, twist, _ = self._stretch.split(path.at(tau))
        view = self._stretch.look(path.begin + tau * path.length, pose, twist)
        along, shares = view.border.along[:, 0], view.shares[carriers.free]
        rates = view.border.rates(view.answer.rate)[self._frozen]
        loose = _LOOSE - np.abs(rates) / max(self._scene.rate_size, 1e-300)
        still = -1.0 if self._stuck and not view.answer.sticks else 1.0
        slip = 1.0 - view.answer.needed
        ends = np.array([slip, still])
        return np.concatenate([along, self._lengths - along, shares, 1.0 - shares, loose, ends])

    def meaning(self, j: int) -> tuple[Kind, int]:
        """Return what margin j is about, and which tip on the outline."""
        k, f = len(self._carriers.border), len(self._carriers.free)
        if j < 2 * k:
            return "corner", j % k
        if j < 2 * (k + f):
            return "share", int(self._carriers.free[(j - 2 * k) % f])
        if j < len(self.slack) - 2:
            return "loose", int(self._frozen[j - 2 * (k + f)])
        return ("slip" if j == len(self.slack) - 2 else "start"), -1

    def root(self, j: int, low: float, high: float, before: float) -> float:
        """Return where margin j becomes negative."""
        if not before > 0.0:
            return low
        if self.meaning(j)[0] == "start":
            while high - low > _MOMENT:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if self.at(middle)[j] > 0.0 else (low, middle)
            return high
        return float(brentq(lambda tau: self.at(tau)[j], low, high, xtol=1e-15, rtol=1e-15))
