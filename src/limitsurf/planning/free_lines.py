r"""Plans whose lines may take any angle: Goldberg's planner, with bands and margins.

A plan that works takes every orientation to one, c. Seen backwards, the orientations that the last
m lines surely take to c form an arc of whole steps, since a step function is monotone: the arc
before an arc I is the run of all steps whose images, turned by the next line, lie in I with a
margin on both sides. How wide it can be depends on the width of I alone, as the line may be turned
at will, and is never less for a wider I. So the widest run for each arc, from the widest single
step on, gives the fewest lines (K. Goldberg, Algorithmica 10, 1993). Margins only make an arc
narrower for the images it receives, and starts between two steps of a run come to one of the two
images: the argument stays as it is. Among the plans of least length, the one whose least
margin is largest is returned. For steps whose images are not in order the plans stay right, but
there may be shorter ones.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import NoPlan
from limitsurf.kernels.step_runs import widest_run
from limitsurf.planning.largest_margin import with_largest_gap
from limitsurf.planning.line_plan import LinePlan
from limitsurf.planning.squeeze_function import SqueezeFunction, smallest_period
from limitsurf.tolerances import LINE_MARGIN

__all__ = ["plan_free_lines"]

Array = NDArray[np.float64]

_ROUNDING = 1e-12  # for this much of the largest margin no plan is made longer
_NEARLY = 1e-8  # rad; steps that repeat to within this leave hardly a margin


@dataclass(frozen=True)
class _Arc:
    """A run of whole steps, `width` wide from `left` on; its images span `span` from `image` on."""

    left: float
    width: float
    image: float
    span: float


@dataclass(frozen=True)
class _Steps:
    """The steps of one period and of the next, for runs that begin in the first."""

    breaks: Array
    ends: Array
    images: Array
    period: float
    in_order: bool

    @classmethod
    def of(cls, squeeze: SqueezeFunction) -> _Steps:
        k = squeeze.steps
        turn = np.repeat([0.0, squeeze.period], k)
        breaks, ends, images = (
            np.tile(x[:k], 2) + turn for x in (squeeze.breaks, squeeze.ends, squeeze.images)
        )
        in_order = bool(np.all(np.diff(images) >= 0.0))
        return cls(breaks, ends, images, squeeze.period, in_order)

    def widest_arc(self, room: float) -> tuple[_Arc | None, float]:
        """Return the widest arc whose images span at most `room`, and the next larger span."""
        i, n, image, span, more = widest_run(
            self.breaks, self.ends, self.images, self.period, room, self.in_order
        )
        if n == 0:
            return None, more
        whole = 2 * n == len(self.breaks)
        width = self.period if whole else float(self.ends[i + n - 1] - self.breaks[i])
        return _Arc(float(self.breaks[i]), width, image, span), more


Chain = list[_Arc]


def plan_free_lines(squeeze: SqueezeFunction, min_margin: float, goal: float | None) -> LinePlan:
    """Return the plan of fewest lines, of any angles, with the largest margin.

    Raises
    ------
    NoPlan
        No plan has the margin.
    """
    steps = _Steps.of(squeeze)
    chain, _ = _shortest_chain(steps, 2.0 * max(min_margin, LINE_MARGIN))
    if chain is None:
        raise _no_plan(steps, squeeze, min_margin, goal)
    return _forward(_widen(chain, steps, len(chain)), squeeze, goal)


def _widen(chain: Chain, steps: _Steps, most: float = np.inf) -> Chain:
    """Return the chain of at most `most` arcs with the largest gap."""
    return with_largest_gap(
        chain, _gap, lambda gap: _shortest_chain(steps, gap, most), steps.period
    )


def _shortest_chain(steps: _Steps, gap: float, most: float = np.inf) -> tuple[Chain | None, float]:
    """Return the fewest arcs, the last one first, each `gap` wider than the images it receives.

    And the largest smaller gap for which another run would fit anywhere.
    """
    chain, next_gap = _backwards(steps, gap, most)
    return chain if chain[-1].width == steps.period else None, next_gap


def _backwards(steps: _Steps, gap: float, most: float = np.inf) -> tuple[Chain, float]:
    """Return arcs from the last backwards, as far as they grow and at most `most` of them."""
    next_gap = 0.0
    arc, _ = steps.widest_arc(0.0)
    chain: Chain = []
    while arc is not None and (not chain or arc.width > chain[-1].width):
        chain.append(arc)
        if arc.width == steps.period or len(chain) >= most:
            break
        arc, more = steps.widest_arc(_room(arc.width, gap))
        next_gap = max(next_gap, chain[-1].width - more)
    return chain, next_gap


def _room(width: float, gap: float) -> float:
    """Return the largest float that subtracted from `width` leaves at least `gap`.

    Differences from half an ulp below the gap on are rounded to it. Where the gap is nearly the
    width, many floats lie within that half ulp.
    """
    room = width - gap + 0.5 * (gap - math.nextafter(gap, -math.inf))
    while width - room < gap:
        room = math.nextafter(room, -math.inf)
    while width - math.nextafter(room, math.inf) >= gap:
        room = math.nextafter(room, math.inf)
    return room


def _gap(chain: Chain) -> float:
    gaps = [late.width - early.span for late, early in itertools.pairwise(chain)]
    return min(gaps, default=np.inf)


def _forward(chain: Chain, squeeze: SqueezeFunction, goal: float | None) -> LinePlan:
    """Turn each line so that the images of one arc fall into the middle of the next."""
    lines, margins = [0.0], [np.inf]
    for early, late in zip(chain[::-1], chain[-2::-1], strict=False):
        margin = 0.5 * (late.width - early.span)
        lines.append(lines[-1] + early.image - late.left - margin)
        margins.append(margin)
    final = lines[-1] + chain[0].image
    turn = 0.0 if goal is None else goal - final
    return LinePlan(
        lines=np.mod(np.array(lines) + turn, squeeze.modulus),
        margins=np.array(margins),
        final=float(np.mod(final + turn, squeeze.period)),
        period=squeeze.period,
        squeeze=squeeze,
    )


def _no_plan(
    steps: _Steps, squeeze: SqueezeFunction, min_margin: float, goal: float | None
) -> NoPlan:
    """Return the error that says which margin is reachable, with the plan that attains it."""
    any_margin, _ = _shortest_chain(steps, 2.0 * LINE_MARGIN)
    if any_margin is None:
        return NoPlan(_why_none(steps, squeeze), 0.0)
    widest = _widen(any_margin, steps)
    shorter, _ = _shortest_chain(steps, _gap(widest) * (1.0 - _ROUNDING))
    plan = _forward(min(widest, shorter or widest, key=len), squeeze, goal)
    return NoPlan(
        f"min_margin: no plan has a margin of {np.degrees(min_margin):.6g} deg; at most "
        f"{np.degrees(plan.least_margin):.6g} deg is reachable, by {len(plan.lines)} lines "
        "(the error's `plan`)",
        plan.least_margin,
        plan,
    )


def _why_none(steps: _Steps, squeeze: SqueezeFunction) -> str:
    reach = _backwards(steps, 2.0 * LINE_MARGIN)[0][-1].width
    reason = (
        "no plan: the widest arc of orientations that lines surely take to one has "
        f"{np.degrees(reach):.6g} of {np.degrees(steps.period):.6g} deg"
    )
    rows = squeeze.breaks, squeeze.ends, squeeze.images
    nearly = smallest_period(*rows, squeeze.modulus, _NEARLY)
    if nearly < steps.period:
        reason += (
            f"; every {np.degrees(nearly):.4g} deg the steps repeat, to within {_NEARLY:g} rad: no "
            "line can be as accurate as to tell such orientations apart"
        )
    if np.any(steps.breaks[1:] > steps.ends[:-1]):
        reason += (
            "; from the gaps between steps either of two images may come: centre the part "
            "first (model 'centred'), or push it from one side ('push-squeeze')"
        )
    return reason
