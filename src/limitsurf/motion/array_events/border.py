r"""Tips on the outline: how fast they go in or out, and which shares that leaves them.

With n the normal to the inside and r the tip's place from the centre of mass, its distance g
inside the outline changes by :math:`g' = -J v`, :math:`J = (n_x, n_y, r \times n)`; at a corner g
is the least of two distances where the part is convex, and the greatest where it is not. The
shares solve

.. math:: s_i = 0,\ g'_i \le 0 \quad\text{or}\quad s_i = 1,\ g'_i \ge 0
          \quad\text{or}\quad 0 < s_i < 1,\ g'_i = 0 ,

which makes the part cross the border, slide along it, or rest there (A. F. Filippov,
*Differential Equations with Discontinuous Righthand Sides*, 1988). Of several solutions it is the
one to which tips of small width lead: :math:`\dot s = g'`, kept in [0, 1].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.optimize import brentq, lsq_linear

from limitsurf.errors import SolveFailed
from limitsurf.motion.array_events.tip_scene import Scene

__all__ = ["Border", "BorderTip", "Rates", "border_at", "free_tips", "settle", "solve_free"]

Array = NDArray[np.float64]
Rates = Callable[[Array], Array]

_ROUNDING = 1e-11  # of rates, relative to their size
_EXACT = 1e-14  # the same where shares are solved for
_FLAT = 1e-8  # slopes of rates, relative to their size
_STEP = 1e-4  # of shares, for slopes
_CLOSE = 1e-12  # shares this close to 0 or 1 are that
_SWEEPS, _PATIENCE = 600, 60
_NEARBY = 0.1  # in shares: farther solutions are not those that the flow leads to
_FEW = 5


@dataclass(frozen=True)
class BorderTip:
    """A tip on an edge, or on a corner between two."""

    tip: int
    edges: tuple[int, int]

    @property
    def corner(self) -> bool:
        """Whether it is on a corner."""
        return self.edges[0] != self.edges[1]


@dataclass(frozen=True, eq=False)
class Border:
    """Distances of tips from their edges, rows J and what their rates have without J."""

    gaps: Array
    along: Array
    rows: Array
    bias: Array
    convex: NDArray[np.bool_]

    def rates(self, x: Array) -> Array:
        """Return g' (k,) of a twist, or g'' of an acceleration."""
        both = self.bias - self.rows @ x
        return np.asarray(np.where(self.convex, both.min(axis=1), both.max(axis=1)))


def border_at(scene: Scene, pose: Array, twist: Array, tips: list[BorderTip]) -> Border:
    """Return the border tips' geometry; `bias` belongs to g'' of a part with this twist."""
    edges = np.array([tip.edges for tip in tips], dtype=np.int64).reshape(-1, 2)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[cos, -sin], [sin, cos]])
    b = (scene.points[[tip.tip for tip in tips]] - pose[:2]) @ turn  # in the part's frame
    n, start = scene.normals[edges], scene.edges[edges, :2]
    off = b[:, None] - start
    moments = b[:, None, 0] * n[..., 1] - b[:, None, 1] * n[..., 0]
    rows = np.concatenate([n @ turn.T, moments[..., None]], axis=2)
    v, w = twist[:2] @ turn, twist[2]
    coriolis = 2 * w * np.array([-v[1], v[0]]) - w * w * b
    convex = [
        bool(scene.convex[first if scene.following[first] == second else second])
        for first, second in edges
    ]
    return Border(
        gaps=(off * n).sum(axis=2),
        along=off[..., 0] * n[..., 1] - off[..., 1] * n[..., 0],
        rows=rows,
        bias=(n * coriolis[:, None]).sum(axis=2),
        convex=np.array(convex, dtype=np.bool_),
    )


def settle(rates: Rates, start: Array, size: float) -> Array:
    """Return shares (k,) that meet the conditions, from where `start` leads.

    `size` is what rates are measured by: 1e-11 of it is zero.
    """
    if len(start) == 0:
        return start
    if len(start) == 1:
        return _settle_one(rates, start, size)
    s, g, before = start, rates(start), np.full(len(start), -1)
    if np.abs(g).max() <= _ROUNDING * size:
        return start
    pace, due = 0.1 / float(np.abs(g).max()), 2
    for sweep in range(_SWEEPS):
        pattern = np.where(s <= 0.0, 0, np.where(s >= 1.0, 1, 2))
        if np.array_equal(pattern, before) and sweep >= due:
            due = sweep + 3 + sweep // 4
            found = _polished(rates, s, pattern == 2, size)
            if found is not None and np.abs(found - s).max() <= _NEARBY:
                return found
        if sweep == _PATIENCE:
            found = _all_kept(rates, start, size)
            if found is not None:
                return found
        before = pattern
        s = np.clip(s + pace * g, 0.0, 1.0)
        g, last = rates(s), g
        turn = float(g @ last) / max(float(np.linalg.norm(g) * np.linalg.norm(last)), 1e-300)
        pace *= 1.3 if turn > 0.7 else (0.5 if turn < 0.0 else 0.9)
        pace = min(pace, 0.25 / max(float(np.abs(g).max()), 1e-300))
    return _by_cases(rates, start, size)


def _settle_one(rates: Rates, start: Array, size: float) -> Array:
    def rate(s: float) -> float:
        return float(rates(np.array([s]))[0])

    first, ends = rate(start[0]), (rate(0.0), rate(1.0))
    tol = _ROUNDING * size
    if abs(first) <= tol:
        return start
    bound, sign = (1, 1.0) if first > 0.0 else (0, -1.0)
    if sign * ends[bound] >= -tol:
        return np.array([float(bound)])
    root = brentq(rate, start[0], float(bound), xtol=1e-16, rtol=1e-15)
    return _snapped(np.array([root]))


def _all_kept(rates: Rates, start: Array, size: float) -> Array | None:
    """Return shares with which all tips stay on the outline, if the rates are linear in them."""
    A = _slopes(rates, start)
    found = lsq_linear(A / size, (A @ start - rates(start)) / size, bounds=(0.0, 1.0), tol=1e-15).x
    return _accepted(rates, found, size)


def _by_cases(rates: Rates, start: Array, size: float) -> Array:
    """Try all patterns, those nearest to the start first."""
    if len(start) <= _FEW:
        ends = np.where(start < 0.5, 0, 1)
        patterns = [np.array(p) for p in product((0, 1, 2), repeat=len(start))]
        patterns.sort(key=lambda p: int((p != ends).sum()))
        for pattern in patterns:
            s = np.where(pattern == 2, 0.5, pattern.astype(np.float64))
            found = _polished(rates, s, pattern == 2, size)
            if found is not None:
                return found
    raise SolveFailed(f"event_motion: no shares found for {len(start)} tips on the outline", start)


def _polished(rates: Rates, s: Array, captured: NDArray[np.bool_], size: float) -> Array | None:
    """Return shares near s with captured tips that stay, if they meet the conditions."""
    which = np.flatnonzero(captured)
    free = free_tips(rates, s, which, size)
    found = solve_free(rates, s, which, free, size)
    return _accepted(rates, found, size)


def _accepted(rates: Rates, found: Array, size: float) -> Array | None:
    """Return shares if they meet the conditions."""
    if found.min() < -_CLOSE or found.max() > 1.0 + _CLOSE:
        return None
    found = _snapped(found)
    g = rates(found)
    wrong = np.where(found <= 0.0, g, np.where(found >= 1.0, -g, np.abs(g)))
    return found if wrong.max() <= _ROUNDING * size else None


def _snapped(s: Array) -> Array:
    return np.where(s < _CLOSE, 0.0, np.where(s > 1.0 - _CLOSE, 1.0, s))


def _slopes(rates: Rates, s: Array, columns: NDArray[np.int64] | None = None) -> Array:
    """Return the derivatives of the rates with respect to some shares, exact up to the step."""
    base = rates(s)
    which = np.arange(len(s)) if columns is None else columns
    A = np.empty((len(s), len(which)))
    for c, j in enumerate(which):
        moved = s.copy()
        moved[j] += _STEP if s[j] < 0.5 else -_STEP
        A[:, c] = (rates(moved) - base) / (moved[j] - s[j])
    return A


def free_tips(rates: Rates, s: Array, which: NDArray[np.int64], size: float) -> NDArray[np.int64]:
    """Return captured tips whose shares decide on the rates of all; others keep theirs.

    Those others move along with the former, or the part turns about them and their share is what
    it was when that began.
    """
    if len(which) == 0:
        return which
    A = _slopes(rates, s, which)[which]
    _, R, order = scipy.linalg.qr(A, pivoting=True, mode="economic")
    rank = int((np.abs(np.diag(R)) > _FLAT * size).sum())
    return np.sort(which[order[:rank]])


def solve_free(
    rates: Rates, s: Array, which: NDArray[np.int64], free: NDArray[np.int64], size: float
) -> Array:
    """Return shares with the free ones changed by Newton's method until captured tips stay put."""
    if len(free) == 0:
        return s
    g = rates(s)[which]
    for _ in range(12):
        most = float(np.abs(g).max())
        if most <= _EXACT * size:
            break
        step = np.linalg.lstsq(_slopes(rates, s, free)[which], -g, rcond=1e-13)[0]
        trial = s.copy()
        trial[free] += step
        after = rates(trial)[which]
        if not np.abs(after).max() < 0.5 * most:
            break
        s, g = trial, after
    return s
