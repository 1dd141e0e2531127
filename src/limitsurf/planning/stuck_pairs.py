"""Why no plan exists on a finite set of lines: two orientations that never merge.

If there is a plan, it merges any two orientations, wherever they come from. So one pair that no
sequence of lines merges rules every plan out. Where each image falls into one step for
certain, the converse holds as well: pairs can be merged one after the other. (Both are known from
synchronizing automata: Eppstein, SIAM J. Comput. 19, 1990.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.planning.given_lines import GivenLines, fewest_lines
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.tolerances import ANGLE

__all__ = ["are_mirror_images", "helpful_line", "stuck_pairs"]

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

_MOST_CANDIDATES = 64


def stuck_pairs(given: GivenLines, margin: float) -> Bools:
    """Return (L, k, k): whether images i and j at line a never surely merge.

    A pair merges if some line takes it, with every error up to the margin, to pairs that merge.
    """
    lines, k = len(given.lines), given.squeeze.steps
    stuck = np.tile(~np.eye(k, dtype=np.bool_), (lines, 1, 1))
    may_come = [(given.distances(b) < margin).astype(np.float32) for b in range(lines)]
    while True:
        before = np.count_nonzero(stuck)
        for b, come in enumerate(may_come):
            astray = come @ stuck[b].astype(np.float32) @ come.transpose(0, 2, 1)
            stuck &= astray > 0.0
        if np.count_nonzero(stuck) == before:
            return stuck


def are_mirror_images(given: GivenLines, a: int, i: int, j: int) -> bool:
    """Return whether a reflection that changes neither steps nor lines swaps images i and j.

    Reflection at line a takes an image s to ``c - s``, where c belongs to an axis of the steps. It
    keeps the lines along and across line a, and no others.
    """
    turns = 2.0 * (given.lines - given.lines[a])
    if np.any(_apart(turns, 0.0, given.squeeze.modulus) > ANGLE):
        return False
    sums = given.images[i] + given.images[j]
    return any(_apart(sums, c, given.squeeze.period) <= ANGLE for c in _axes(given.squeeze))


def _axes(squeeze: SqueezeFunction) -> list[float]:
    """Return every c for which ``phi -> c - phi`` maps the steps of a period onto themselves."""
    k, period = squeeze.steps, squeeze.period
    breaks, ends, images = (x[:k] for x in (squeeze.breaks, squeeze.ends, squeeze.images))
    axes = []
    for j in range(k):
        c = float(images[0] + images[j])
        partner = (j - np.arange(k)) % k
        kept = [
            _apart(c - x, y[partner], period) <= ANGLE
            for x, y in ((images, images), (breaks, ends), (ends, breaks))
        ]
        if np.all(kept):
            axes.append(c)
    return axes


def helpful_line(given: GivenLines, margin: float) -> tuple[float, int] | None:
    """Return a line [rad] with which there is a plan, and the length of that plan.

    Looked for halfway between neighbouring lines first, then in the middles of the widest intervals
    in which a new line sees each image of the lines in the same step. None if none of 64 helps.
    """
    for angle in _candidates(given)[:_MOST_CANDIDATES]:
        more = GivenLines(given.squeeze, np.append(given.lines, angle))
        nodes = fewest_lines(more, margin, more.targets(None, 0.0))
        if nodes is not None:
            return float(angle), len(nodes)
    return None


def _candidates(given: GivenLines) -> Array:
    squeeze, modulus = given.squeeze, given.squeeze.modulus
    lines = np.sort(given.lines)
    halfway = lines + 0.5 * np.diff(lines, append=lines[0] + modulus)
    seen = given.lines[:, None, None] + given.images[:, None] - squeeze.breaks
    critical = np.unique(np.mod(seen, modulus))
    widths = np.diff(critical, append=critical[0] + modulus)
    middles = (critical + 0.5 * widths)[np.argsort(-widths, kind="stable")]
    hundredths = np.round(np.degrees(np.mod(np.concatenate([halfway, middles]), modulus)), 2)
    rounded: Array = np.radians(hundredths)  # what a message can say in full
    return rounded


def _apart(x: Array | float, y: Array | float, period: float) -> Array:
    """Return the distance of angles modulo a period."""
    off = np.subtract(x, y)
    apart: Array = np.abs(off - period * np.round(off / period))
    return apart
