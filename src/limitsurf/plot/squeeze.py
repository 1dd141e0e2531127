"""Draw a squeeze function, and what a plan does with all orientations."""

from __future__ import annotations

from typing import Any

import numpy as np

from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_plan", "draw_squeeze_function"]


def draw_squeeze_function(squeeze: SqueezeFunction) -> Any:
    """Return a plotly figure of the steps of a squeeze function over [0, 180) degrees."""
    import plotly.graph_objects as go

    figure = go.Figure()
    x: list[float] = []
    y: list[float] = []
    for left, right, image in zip(squeeze.breaks, squeeze.ends, squeeze.images, strict=True):
        for a, b in _reduced(left, right):
            x += [a, b, np.nan]
            y += [float(np.degrees(np.mod(image, np.pi)))] * 2 + [np.nan]
    figure.add_scatter(
        x=x, y=y, mode="lines", line={"color": COLORS[0], "width": 3}, name="squeeze function s"
    )
    figure.add_scatter(
        x=[0, 180],
        y=[0, 180],
        mode="lines",
        line={"color": "#bbbbbb", "dash": "dot"},
        name="unchanged",
    )
    figure.update_xaxes(range=[0, 180], dtick=30)
    figure.update_yaxes(range=[-3, 183], dtick=30)
    return lay_out(figure, x="orientation before [deg]", y="orientation after [deg]")


def draw_plan(plan: AlignmentPlan) -> Any:
    """Return a plotly figure of where each line takes orientations from all of [0, 180) degrees."""
    import plotly.graph_objects as go

    starts = np.linspace(0.0, np.pi, 180, endpoint=False)
    stages = [starts]
    for line in plan.lines:
        stages.append(np.mod(plan.squeeze(stages[-1] - line) + line, np.pi))
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
    figure.update_xaxes(
        tickvals=list(range(len(names))), ticktext=names, range=[-0.2, len(names) - 0.8]
    )
    figure.update_yaxes(range=[-3, 183], dtick=30)
    return lay_out(figure, x="", y="orientation in the array's frame [deg]")


def _reduced(left: float, right: float) -> list[tuple[float, float]]:
    """Return an interval that starts in [0, pi) as intervals within [0, 180] degrees."""
    if right <= np.pi:
        return [(float(np.degrees(left)), float(np.degrees(right)))]
    return [(float(np.degrees(left)), 180.0), (0.0, float(np.degrees(right - np.pi)))]
