"""Lines that bring all orientations to one, from any step function."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError, NoPlan
from limitsurf.planning.free_lines import plan_free_lines
from limitsurf.planning.given_lines import GivenLines, fewest_lines, plan_through, safest_lines
from limitsurf.planning.line_plan import LinePlan
from limitsurf.planning.no_plan import no_plan_on
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.planning.stuck_pairs import stuck_pairs
from limitsurf.sets.arguments import as_array, as_count, as_number
from limitsurf.tolerances import ANGLE, GOAL, LINE_MARGIN

__all__ = ["plan_lines"]

Array = NDArray[np.float64]

_MOST_STARTS = 2000  # lines times steps; a search looks at their pairs, some seconds


def plan_lines(
    squeeze: SqueezeFunction,
    *,
    lines: ArrayLike | int | None = None,
    min_margin: float = 0.0,
    goal: float | None = None,
) -> LinePlan:
    """Return the fewest lines that bring all orientations to one, with the largest least margin.

    Parameters
    ----------
    squeeze : SqueezeFunction
        What a squeeze towards a line does.
    lines : (L,) float or int, optional
        World angles that may be used [rad], or their number if they are evenly spaced over the
        modulus; any angles if not given.
    min_margin : float
        Least error of a line's angle [rad] that every step has to tolerate.
    goal : float, optional
        Orientation at the end [rad], modulo the period; to 1e-6 rad if `lines` are given.

    Raises
    ------
    NoPlan
        No plan meets the request: says why, what is reachable, and what would help.
    InputError
        Lines that are repeated, not finite or none; a margin below 0; a goal that is not finite.

    Examples
    --------
    The plan for Fig. 3 of the paper: a gripper aligns a rectangle in two squeezes.

    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.diameter_function import diameter_function
    >>> from limitsurf.planning.squeeze_function import squeeze_function
    >>> rectangle = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> squeeze = squeeze_function(diameter_function(rectangle))
    >>> plan_lines(squeeze)
    LinePlan(lines at 0.00, 135.00 deg, margin 18.43 deg)
    >>> plan_lines(squeeze, lines=4, goal=0.0)
    LinePlan(lines at 45.00, 0.00 deg, margin 18.43 deg)
    """
    margin = as_number("min_margin", min_margin)
    if not (np.isfinite(margin) and margin >= 0.0):
        raise InputError("min_margin", "must be at least 0 rad", value=min_margin)
    end = None if goal is None else as_number("goal", goal)
    if end is not None and not np.isfinite(end):
        raise InputError("goal", "must be a finite angle in radians", value=goal)
    given = None if lines is None else _given_lines(squeeze, lines)
    if squeeze.steps == 0:
        raise NoPlan("squeeze: it has no steps: nothing turns, so nothing is aligned", 0.0)
    if given is None:
        return plan_free_lines(squeeze, margin, end)
    return _plan_given_lines(given, margin, end)


def _given_lines(squeeze: SqueezeFunction, lines: ArrayLike | int) -> GivenLines:
    """Check a set of lines."""
    if np.ndim(lines) == 0:
        count = _not_too_many(squeeze, as_count("lines", lines))
        return GivenLines(squeeze, np.linspace(0.0, squeeze.modulus, count, endpoint=False))
    angles = np.mod(as_array("lines", lines, None), squeeze.modulus)
    _not_too_many(squeeze, len(angles))
    if len(angles) == 0:
        raise InputError("lines", "are none", remedy="give at least one angle")
    order = np.argsort(angles)
    gaps = np.diff(angles[order], append=angles[order[0]] + squeeze.modulus)
    if len(angles) > 1 and gaps.min() <= ANGLE:
        n = int(np.argmin(gaps))
        i, j = sorted((int(order[n]), int(order[(n + 1) % len(order)])))
        raise InputError(
            "lines",
            f"numbers {i} and {j} are one line, modulo {np.degrees(squeeze.modulus):g} deg",
            remedy="give each once",
        )
    return GivenLines(squeeze, angles)


def _not_too_many(squeeze: SqueezeFunction, count: int) -> int:
    most = max(1, _MOST_STARTS // max(1, squeeze.steps))
    if count > most:
        raise InputError(
            "lines",
            f"are {count}; at most {most} can be searched for {squeeze.steps} steps",
            remedy="leave `lines` out and round what is found: a grid finer than the least margin "
            "is safe",
        )
    return count


def _plan_given_lines(given: GivenLines, min_margin: float, goal: float | None) -> LinePlan:
    margin, targets = max(min_margin, LINE_MARGIN), given.targets(goal, GOAL)
    merging = not stuck_pairs(given, margin).any()  # else a search could take long to find nothing
    nodes = fewest_lines(given, margin, targets) if merging else None
    if nodes is None:
        raise no_plan_on(given, min_margin, goal)
    return plan_through(given, safest_lines(given, nodes, targets, len(nodes)))
