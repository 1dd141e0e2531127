"""Draw what the errors of an array leave of a plan."""

from __future__ import annotations

from typing import Any

import numpy as np

from limitsurf.planning.propagation import Propagation
from limitsurf.planning.robustness import Robustness
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_robustness"]

_STATUS_COLORS = {"guaranteed": COLORS[2], "likely": COLORS[4], "lost": COLORS[1]}


def draw_robustness(robustness: Robustness) -> Any:
    """Return a plotly figure of the orientations after each line, coloured by its status.

    Wide, pale bars hold them with all errors at their worst, narrow ones likely; points mark where
    the plan without errors would be.

    Parameters
    ----------
    robustness : Robustness
        From `AlignmentPlan.robustness`.

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.alignment import plan_alignment
    >>> from limitsurf.planning.field_errors import FieldErrors
    >>> plan = plan_alignment(Part.from_file("paper_t"))
    >>> figure = draw_robustness(plan.robustness(FieldErrors(direction=0.01)))
    >>> figure.layout.yaxis.title.text
    "orientation in the array's frame [deg]"
    """
    import plotly.graph_objects as go

    figure, plan = go.Figure(), robustness.plan
    modulus = plan.squeeze.modulus
    for status, color in _STATUS_COLORS.items():
        for width, opacity, what in (
            (0.5, 0.35, robustness.worst),
            (0.25, 0.9, robustness.likely),
        ):
            x, low, high = _bars(robustness, what, status)
            figure.add_bar(
                x=x,
                y=high - low,
                base=low,
                width=width,
                marker={"color": color, "opacity": opacity, "line": {"color": color, "width": 2}},
                name=status if what is robustness.worst else f"{status}, likely width",
                showlegend=what is robustness.worst and len(x) > 0,
            )
    x, y = _points(robustness)
    figure.add_scatter(
        x=x, y=y, mode="markers", marker={"color": "black", "size": 6}, name="without errors"
    )
    names = [f"line {k + 1}<br>{angle:.1f} deg" for k, angle in enumerate(np.degrees(plan.lines))]
    figure.update_layout(barmode="overlay")
    figure.update_xaxes(
        tickvals=list(range(len(names))), ticktext=names, range=[-0.6, len(names) - 0.4]
    )
    whole = float(np.degrees(modulus))
    figure.update_yaxes(range=[-whole / 60, whole * 61 / 60], dtick=whole / 6)
    note = "wide bars: all errors at their worst; narrow bars: likely errors"
    return lay_out(figure, x=note, y="orientation in the array's frame [deg]")


def _bars(robustness: Robustness, what: Propagation, status: str) -> Any:
    """Return line numbers and ends in degrees of the intervals after lines of a status."""
    modulus = robustness.plan.squeeze.modulus
    rows = []
    for k, intervals in enumerate(what.sets):
        if robustness.steps[k] != status:
            continue
        for low, high in intervals:
            rows.append((k, low, min(high, modulus)))
            if high > modulus:
                rows.append((k, 0.0, high - modulus))
    x, low, high = np.array(rows).reshape(-1, 3).T
    return x, np.degrees(low), np.degrees(high)


def _points(robustness: Robustness) -> Any:
    """Return line numbers and orientations in degrees of the plan without errors."""
    plan = robustness.plan
    phi, x, y = plan.squeeze.images + plan.lines[0], [], []
    for k, line in enumerate(plan.lines):
        phi = plan.squeeze(phi - line) + line
        x += [k] * len(phi)
        y += np.degrees(np.mod(phi, plan.squeeze.modulus)).tolist()
    return x, y
