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


def draw_squeeze_function(squeeze: SqueezeFunction) -> Any:
    """Return a plotly figure of the steps of a squeeze function over one modulus of orientations.

    Where steps leave gaps, both images that may come are drawn, dotted.
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

    Bars about the orientations before a line are its margin: by so much may the line's angle be
    off.
    """
    import plotly.graph_objects as go

    modulus = plan.squeeze.modulus
    whole = float(np.degrees(modulus))
    starts = np.linspace(0.0, modulus, round(whole), endpoint=False)
    stages = [starts]
    for line in plan.lines:
        stages.append(np.mod(plan.squeeze(stages[-1] - line) + line, modulus))
    paths = np.degrees(np.array(stages))
    names = ["start"] + [
        f"line {k + 1}<br>{angle:.1f} deg" for k, angle in enumerate(np.degrees(plan.lines))
    ]
    x = np.tile([*range(len(names)), np.nan], len(starts))
    y = np.vstack([paths, np.full(len(starts), np.nan)]).T.ravel()
    figure = go.Figure()
    figure.add_scatter(
        x=x, y=y, mode="lines", line={"color": COLORS[0], "width": 0.7}, name="orientations"
    )
    if len(plan.lines) > 1:
        _add_margins(figure, paths, np.degrees(plan.margins))
    figure.update_xaxes(
        tickvals=list(range(len(names))), ticktext=names, range=[-0.2, len(names) - 0.8]
    )
    figure.update_yaxes(range=[-whole / 60, whole * 61 / 60], dtick=whole / 6)
    return lay_out(figure, x="", y="orientation in the array's frame [deg]")


def _add_margins(figure: Any, paths: Array, margins: Array) -> None:
    """Add the orientations before each line but the first, with the margin of the line."""
    places = [np.unique(np.round(stage, 9)) for stage in paths[1:-1]]
    counts = [len(place) for place in places]
    figure.add_scatter(
        x=np.repeat(np.arange(1, len(margins)), counts),
        y=np.concatenate(places),
        error_y={"array": np.repeat(margins[1:], counts), "color": COLORS[1], "thickness": 1.5},
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
                y += [float(np.degrees(np.mod(image, modulus)))] * 2 + [np.nan]
    return x, y
