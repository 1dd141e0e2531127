"""Draw a squeeze function, and what a plan does with all orientations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.planning.line_plan import LinePlan
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_plan", "draw_squeeze_function"]

Array = NDArray[np.float64]

_SAME, _DIGITS = 1e-9, 9  # up to which orientations count as equal


def draw_squeeze_function(squeeze: SqueezeFunction) -> Any:
    """Return a plotly figure of the steps of a squeeze function over one modulus of orientations.

    Where steps leave gaps, both images that may come are drawn, dotted.

    Parameters
    ----------
    squeeze : SqueezeFunction
        The step function of any model.

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.basin_steps import unknown_offset_function
    >>> figure = draw_squeeze_function(unknown_offset_function(Part.from_file("paper_t")))
    >>> [trace.name for trace in figure.data]
    ['squeeze function s', 'either of two', 'unchanged']
    """
    import plotly.graph_objects as go

    modulus = squeeze.modulus
    figure = go.Figure()
    x, y = _segments(squeeze.breaks, squeeze.ends, squeeze.images, modulus)
    figure.add_scatter(
        x=x, y=y, mode="lines", line={"color": COLORS[0], "width": 3}, name="squeeze function s"
    )
    following = np.append(squeeze.breaks[1:], squeeze.breaks[:1] + modulus)
    gap = following > squeeze.ends
    if gap.any():
        either = np.concatenate([squeeze.images[gap], np.roll(squeeze.images, -1)[gap]])
        left, right = np.tile(squeeze.ends[gap], 2), np.tile(following[gap], 2)
        x, y = _segments(left, right, either, modulus)
        style = {"color": COLORS[1], "width": 2, "dash": "dot"}
        figure.add_scatter(x=x, y=y, mode="lines", line=style, name="either of two")
    whole = float(np.degrees(modulus))
    figure.add_scatter(
        x=[0, whole],
        y=[0, whole],
        mode="lines",
        line={"color": "#bbbbbb", "dash": "dot"},
        name="unchanged",
    )
    figure.update_xaxes(range=[0, whole], dtick=whole / 6)
    figure.update_yaxes(range=[-whole / 60, whole * 61 / 60], dtick=whole / 6)
    return lay_out(figure, x="orientation before [deg]", y="orientation after [deg]")


def draw_plan(plan: LinePlan) -> Any:
    """Return a plotly figure of where each line takes orientations from all of one modulus.

    What leaves the picture at the top comes back at the bottom. Bars about the orientations before
    a line are its margin: by so much may the line's angle be off.

    Parameters
    ----------
    plan : AlignmentPlan or LinePlan
        The plan.

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> figure = draw_plan(plan_alignment(Part.from_file("paper_t")))
    >>> figure.layout.xaxis.ticktext
    ('start', 'line 1<br>0.0 deg', 'line 2<br>45.0 deg')
    """
    import plotly.graph_objects as go

    modulus = plan.squeeze.modulus
    whole = float(np.degrees(modulus))
    stages, turns = _stages(plan)
    figure = go.Figure()
    x, y = _turns(stages, turns, modulus)
    figure.add_scatter(
        x=x, y=y, mode="lines", line={"color": COLORS[0], "width": 1.0}, name="orientations"
    )
    if len(plan.lines) > 1:
        _add_margins(figure, stages[1:-1], plan.margins[1:], modulus)
    names = ["start"] + [
        f"line {k + 1}<br>{angle:.1f} deg" for k, angle in enumerate(np.degrees(plan.lines))
    ]
    figure.update_xaxes(
        tickvals=list(range(len(names))), ticktext=names, range=[-0.2, len(names) - 0.8]
    )
    figure.update_yaxes(range=[-whole / 60, whole * 61 / 60], dtick=whole / 6)
    return lay_out(figure, x="", y="orientation in the array's frame [deg]")


def _stages(plan: LinePlan) -> tuple[list[Array], list[Array]]:
    """Return the different orientations before the first and after each line, and their turns."""
    modulus = plan.squeeze.modulus
    stages = [np.linspace(0.0, modulus, round(np.degrees(modulus)), endpoint=False)]
    turns = []
    for line in plan.lines:
        here = stages[-1] - line
        turns.append(plan.squeeze.follow(here) - here)
        after = np.mod(np.round(stages[-1] + turns[-1], _DIGITS), modulus)
        stages.append(np.unique(after))
    return stages, turns


def _turns(stages: list[Array], turns: list[Array], modulus: float) -> tuple[Array, Array]:
    """Return the way of each orientation over each line, again on the other side if it leaves."""
    x, y = [], []
    for k, (before, turn) in enumerate(zip(stages[:-1], turns, strict=True)):
        ways = np.column_stack([before, before + turn, np.full(len(turn), np.nan)])
        outside = np.floor(np.round(ways[:, 1] / modulus, _DIGITS))
        again = outside != 0.0
        ways = np.vstack([ways, ways[again] - modulus * outside[again, None]])
        x.append(np.tile([k, k + 1, np.nan], len(ways)))
        y.append(np.degrees(ways).ravel())
    return np.concatenate(x), np.concatenate(y)


def _add_margins(figure: Any, stages: list[Array], margins: Array, modulus: float) -> None:
    """Add the orientations before each line but the first, with the margin of the line."""
    places = [np.concatenate([s - modulus, s, s + modulus]) for s in stages]
    counts = [len(place) for place in places]
    error = {"array": np.repeat(np.degrees(margins), counts), "color": COLORS[1]}
    figure.add_scatter(
        x=np.repeat(np.arange(1, len(stages) + 1), counts),
        y=np.degrees(np.concatenate(places)),
        error_y={**error, "thickness": 1.5},
        mode="markers",
        marker={"color": COLORS[1], "size": 6},
        name="margin of the next line",
    )


def _segments(
    left: Array, right: Array, images: Array, modulus: float
) -> tuple[list[float], list[float]]:
    """Return level lines in degrees, cut where they leave [0, modulus)."""
    x: list[float] = []
    y: list[float] = []
    for a, b, image in zip(left, right, images, strict=True):
        start = np.mod(a, modulus)
        stop = start + b - a
        for low, high in ((start, min(stop, modulus)), (0.0, stop - modulus)):
            if high > low:
                x += [*np.degrees([low, high]).tolist(), np.nan]
                level = np.mod(image, modulus)
                level *= modulus - level > _SAME  # 0, not just below the modulus
                y += [float(np.degrees(level))] * 2 + [np.nan]
    return x, y
