"""Draw a diameter function."""

from __future__ import annotations

from typing import Any

import numpy as np

from limitsurf.planning.diameter_function import DiameterFunction
from limitsurf.plot.length_unit import length_unit
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_diameter_function"]

_FLAT = 0.8  # where the least distance is above this share of the largest, 0 is left out


def draw_diameter_function(diameter: DiameterFunction) -> Any:
    """Return a plotly figure of the distance of the jaws, with its minima and maxima.

    Parameters
    ----------
    diameter : DiameterFunction
        From `diameter_function`.

    Examples
    --------
    >>> from limitsurf.geometry.part import Part
    >>> from limitsurf.planning.diameter_function import diameter_function
    >>> part = Part([(0, 0), (2e-3, 0), (2e-3, 1e-3), (0, 1e-3)])
    >>> draw_diameter_function(diameter_function(part)).layout.yaxis.title.text
    'distance of the jaws [mm]'
    """
    import plotly.graph_objects as go

    phi = np.unique(np.concatenate([np.linspace(0.0, np.pi, 721), diameter.breakpoints]))
    unit = length_unit(diameter.part.circumradius)
    width = unit.scale * diameter.potential(phi)
    figure = go.Figure()
    figure.add_scatter(
        x=np.degrees(phi),
        y=width,
        mode="lines",
        name="diameter function",
        line={"color": COLORS[0]},
    )
    for name, angles, color, symbol in (
        ("stable", diameter.stable, COLORS[2], "circle"),
        ("unstable", diameter.unstable, COLORS[1], "circle-open"),
    ):
        figure.add_scatter(
            x=np.degrees(angles),
            y=unit.scale * diameter.potential(angles),
            mode="markers",
            name=name,
            marker={"color": color, "symbol": symbol, "size": 11},
            cliponaxis=False,
        )
    figure.update_xaxes(range=[0, 180], dtick=30)
    figure.update_yaxes(rangemode="tozero" if width.min() < _FLAT * width.max() else "normal")
    return lay_out(figure, x="orientation phi [deg]", y=f"distance of the jaws [{unit.name}]")
