"""Draw how a plan brings a part from any orientation to one (paper, Figures 3 and 5)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.planning.turn_function import TurnFunction, turn_function
from limitsurf.plot.part import outline_path
from limitsurf.plot.style import COLORS, lay_out
from limitsurf.sets.arguments import as_array

__all__ = ["draw_alignment"]

Array = NDArray[np.float64]

_CELL = 2.6  # width of a picture in circumradii


def draw_alignment(plan: AlignmentPlan, starts: ArrayLike) -> Any:
    """Return a plotly figure of the part after each line of a plan, a row for each start.

    The part is drawn as the plan predicts it, its median on the line; the first column shows it
    before.

    Parameters
    ----------
    plan : AlignmentPlan
        The plan.
    starts : (n,) float
        Orientations at the start [rad].
    """
    import plotly.graph_objects as go

    rows = as_array("starts", starts, None)
    turn = turn_function(plan.part)
    size = 1e3 * _CELL * plan.part.circumradius
    figure = go.Figure()
    for row, start in enumerate(rows):
        for column, (line, pose) in enumerate(_stages(plan, turn, float(start))):
            corner = size * np.array([column, -row])
            _draw_stage(figure, plan, line, pose, corner, size)
    columns = range(len(plan.lines) + 1)
    names = ["start"] + [f"line {k}" for k in columns[1:]]
    figure.update_xaxes(tickvals=[size * k for k in columns], ticktext=names, showgrid=False)
    figure.update_yaxes(
        tickvals=[-size * row for row in range(len(rows))],
        ticktext=[f"{angle:.0f} deg" for angle in np.degrees(rows)],
        showgrid=False,
        scaleanchor="x",
    )
    millimetres = 1e3 * plan.part.circumradius
    x = f"step of the plan (circumradius of the part {millimetres:.3g} mm)"
    return lay_out(figure, x=x, y="orientation at the start")


def _stages(
    plan: AlignmentPlan, turn: TurnFunction, start: float
) -> list[tuple[float | None, Array]]:
    """Return the line and the pose of the centroid relative to it, before and after each step."""
    stages: list[tuple[float | None, Array]] = [(None, np.array([0.0, 0.0, start]))]
    phi = start
    for line in plan.lines:
        phi = float(plan.squeeze.follow(phi - line)) + float(line)
        offset, _ = turn.median(phi - float(line))
        normal = np.array([-np.sin(line), np.cos(line)])
        stages.append((float(line), np.append(-offset * normal, phi)))
    return stages


def _draw_stage(
    figure: Any, plan: AlignmentPlan, line: float | None, pose: Array, corner: Array, size: float
) -> None:
    first = not figure.data
    x, y = (outline_path(plan.part.at(pose)) + corner).T
    figure.add_scatter(
        x=x,
        y=y,
        fill="toself",
        fillcolor="rgba(31,95,168,0.15)",
        mode="lines",
        line={"color": COLORS[0]},
        name=plan.part.name,
        legendgroup="part",
        showlegend=first,
    )
    if line is None:
        return
    half = 0.45 * size * np.array([np.cos(line), np.sin(line)])
    x, y = np.array([corner - half, corner + half]).T
    figure.add_scatter(
        x=x,
        y=y,
        mode="lines",
        line={"color": COLORS[1]},
        name="line",
        legendgroup="line",
        showlegend=len(figure.data) == 2,
    )
