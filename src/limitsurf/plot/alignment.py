"""Draw how a plan brings a part from any orientation to one (paper, Figures 3 and 5)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.planning.alignment import AlignmentPlan
from limitsurf.planning.turn_function import TurnFunction, turn_function
from limitsurf.plot.length_unit import length_unit
from limitsurf.plot.part import outline_path
from limitsurf.plot.style import COLORS, FILLED, lay_out
from limitsurf.sets.arguments import as_array

__all__ = ["draw_alignment"]

Array = NDArray[np.float64]

_CELL = 2.6  # width of a picture, circumradii
_WIDTH = 900.0  # of the whole, pixels
_HEIGHTS = (100.0, 220.0)  # of a row, pixels


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

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> figure = draw_alignment(plan_alignment(Part.from_file("paper_t")), [0.3, 2.0])
    >>> figure.layout.yaxis.ticktext
    ('17 deg', '115 deg')
    """
    import plotly.graph_objects as go

    rows = as_array("starts", starts, None)
    turn = turn_function(plan.part)
    figure = go.Figure()
    for row, start in enumerate(rows):
        for column, (line, pose) in enumerate(_stages(plan, turn, float(start))):
            _draw_stage(figure, plan, line, pose, _CELL * np.array([column, -row]))
    names = ["start"] + [
        f"line {k + 1}<br>{angle:.1f} deg" for k, angle in enumerate(np.degrees(plan.lines))
    ]
    labels = [f"{angle:.0f} deg" for angle in np.degrees(rows)]
    _label(figure, names, labels)
    unit = length_unit(plan.part.circumradius)
    radius = unit.scale * plan.part.circumradius
    x = f"step of the plan (circumradius of the part {radius:.3g} {unit.name})"
    lay_out(figure, x=x, y="orientation at the start")
    height = np.clip(_WIDTH / len(names), *_HEIGHTS)
    return figure.update_layout(height=130 + height * len(labels))


def _label(figure: Any, columns: list[str], rows: list[str]) -> None:
    """Write what columns and rows are beside them, and leave no more room than they take."""
    half = 0.5 * _CELL
    for axes, names, sign in (("x", columns, 1.0), ("y", rows, -1.0)):
        places = sign * _CELL * np.arange(len(names))
        figure.update_layout(
            {
                f"{axes}axis": {
                    "tickvals": places,
                    "ticktext": names,
                    "range": [places.min() - half, places.max() + half],
                    "constrain": "domain",
                    "showgrid": False,
                    "zeroline": False,
                }
            }
        )
    figure.update_yaxes(scaleanchor="x")


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
    figure: Any, plan: AlignmentPlan, line: float | None, pose: Array, corner: Array
) -> None:
    """Draw the part, and the line if there is one, about a corner; lengths in circumradii."""
    first = not figure.data
    x, y = (outline_path(plan.part.at(pose), 1.0 / plan.part.circumradius) + corner).T
    figure.add_scatter(
        x=x,
        y=y,
        **FILLED,
        name=plan.part.name,
        legendgroup="part",
        showlegend=first,
    )
    if line is None:
        return
    half = 0.45 * _CELL * np.array([np.cos(line), np.sin(line)])
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
