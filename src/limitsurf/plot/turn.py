"""Draw a turn function."""

from __future__ import annotations

from typing import Any

import numpy as np

from limitsurf.planning.turn_function import TurnFunction
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_turn_function"]


def draw_turn_function(turn: TurnFunction) -> Any:
    """Return a plotly figure of the moment that turns the part, its sign, and its zeros.

    Parameters
    ----------
    turn : TurnFunction
        From `turn_function`.

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.turn_function import turn_function
    >>> figure = draw_turn_function(turn_function(Part.from_file("paper_t")))
    >>> [trace.name for trace in figure.data]
    ['turn function t', 'moment / largest moment', 'stable', 'unstable']
    """
    import plotly.graph_objects as go

    phi = np.unique(np.concatenate([np.linspace(0.0, np.pi, 721), turn.breakpoints]))
    moment = turn.moment(phi)
    scale = float(np.abs(moment).max()) or 1.0
    degrees = np.degrees(phi)
    figure = go.Figure()
    figure.add_scatter(
        x=degrees,
        y=turn(phi),
        mode="lines",
        name="turn function t",
        line={"shape": "hv", "color": "#bbbbbb"},
    )
    figure.add_scatter(
        x=degrees,
        y=moment / scale,
        mode="lines",
        name="moment / largest moment",
        line={"color": COLORS[0]},
    )
    for name, angles, color, symbol in (
        ("stable", turn.stable, COLORS[2], "circle"),
        ("unstable", turn.unstable, COLORS[1], "circle-open"),
    ):
        figure.add_scatter(
            x=np.degrees(angles),
            y=np.zeros(len(angles)),
            mode="markers",
            name=name,
            marker={"color": color, "symbol": symbol, "size": 11},
            cliponaxis=False,
        )
    figure.update_xaxes(range=[0, 180], dtick=30)
    return lay_out(figure, x="orientation phi [deg]", y="turn function t [1]")
