"""Why a finite set of lines has no plan for a request, what is reachable, what would help."""

from __future__ import annotations

import numpy as np

from limitsurf.errors import NoPlan
from limitsurf.planning.given_lines import (
    GivenLines,
    Target,
    fewest_lines,
    plan_through,
    safest_lines,
)
from limitsurf.planning.line_plan import LinePlan
from limitsurf.planning.stuck_pairs import are_mirror_images, helpful_line, stuck_pairs
from limitsurf.tolerances import GOAL, LINE_MARGIN

__all__ = ["no_plan_on"]


def no_plan_on(given: GivenLines, min_margin: float, goal: float | None) -> NoPlan:
    """Return the error for a set of lines on which no plan meets the request."""
    if stuck_pairs(given, LINE_MARGIN).any():
        return NoPlan(f"lines: {_why(given)}; {_remedy(given)}", 0.0)
    best = _safest_plan(given, given.targets(goal, GOAL))
    if best is not None:
        wish = f"{np.degrees(min_margin):.4g} deg" + (
            "" if goal is None else " and ends at the goal"
        )
        return NoPlan(
            f"min_margin: no plan on these lines has a margin of {wish}; at most "
            f"{np.degrees(best.least_margin):.4g} deg is reachable, by {len(best.lines)} lines "
            "(the error's `plan`)",
            best.least_margin,
            best,
        )
    plans = _plans_for_all_ends(given)
    if goal is None or not plans:
        return NoPlan(f"lines: {_why(given)}; {_remedy(given)}", 0.0)
    return _wrong_goal(given, goal, plans)


def _safest_plan(given: GivenLines, targets: list[Target]) -> LinePlan | None:
    """Return the plan with the largest margin, of any length, if there is any plan."""
    nodes = fewest_lines(given, LINE_MARGIN, targets)
    if nodes is None:
        return None
    return plan_through(given, safest_lines(given, nodes, targets))


def _plans_for_all_ends(given: GivenLines) -> list[LinePlan]:
    """Return one plan for each final orientation that has any, ascending."""
    plans = [
        plan_through(given, nodes)
        for target in given.targets(None, 0.0)
        if (nodes := fewest_lines(given, LINE_MARGIN, [target])) is not None
    ]
    return sorted(plans, key=lambda plan: plan.final)


def _why(given: GivenLines) -> str:
    stuck = np.argwhere(stuck_pairs(given, LINE_MARGIN))
    if len(stuck) == 0:
        return (
            "no plan: every two orientations can be merged, but all of them only by chance, where "
            "starts lie between two steps"
        )
    mirrored = [pair for pair in stuck.tolist() if are_mirror_images(given, *pair)]
    a, i, j = mirrored[0] if mirrored else stuck[0].tolist()
    period = given.squeeze.period
    pair = np.degrees(np.mod(given.lines[a] + given.images[[i, j]], period))
    first, second = sorted(pair)
    why = (
        f"no plan: the orientations {first:.2f} and {second:.2f} deg (modulo "
        f"{np.degrees(period):.4g}) never merge, whatever the order of the lines"
    )
    if mirrored:
        why += (
            ", for they are mirror images: the steps have an axis of symmetry, and a line along or "
            "across the mirror treats both alike"
        )
    return why


def _remedy(given: GivenLines) -> str:
    found = helpful_line(given, LINE_MARGIN)
    if found is None:
        return "no single line was found that helps: give more lines, or leave `lines` out"
    angle, length = found
    return f"add a line, such as {np.degrees(angle):.4g} deg, with which {length} squeezes align it"


def _wrong_goal(given: GivenLines, goal: float, plans: list[LinePlan]) -> NoPlan:
    """Return the error that names the final orientations for which there are plans."""
    finals = list(dict.fromkeys(f"{np.degrees(plan.final):.5f}" for plan in plans))
    period = given.squeeze.period
    off = [abs((plan.final - goal + period / 2) % period - period / 2) for plan in plans]
    nearest = plans[int(np.argmin(off))]
    return NoPlan(
        f"goal: no plan on these lines ends at {np.degrees(goal):.6g} deg; reachable, modulo "
        f"{np.degrees(period):.4g} deg: {', '.join(finals)} deg (the error's `plan` ends nearest)",
        nearest.least_margin,
        nearest,
    )
