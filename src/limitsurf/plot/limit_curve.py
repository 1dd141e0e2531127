"""Draw limit curves, and other flat outlines, in the plane of forces."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.plot.style import COLORS, lay_out
from limitsurf.sets.sections import Section

__all__ = ["draw_limit_curve"]


def draw_limit_curve(
    *curves: Section | shapely.Geometry,
    names: tuple[str, ...] = (),
    x: str = "F<sub>x</sub> [N]",
    y: str = "F<sub>y</sub> [N]",
    title: str = "",
) -> Any:
    """Return a plotly figure of limit curves, such as the paper's Figures 6 and 7.

    Parameters
    ----------
    *curves : Section or shapely geometry
        Polygons are drawn by their borders, segments as lines, points as points; the origin, the
        load of a part left alone, as a cross. Both axes have one scale.
    names : tuple of str, optional
        Names for the legend.
    x, y, title : str
        Labels of the axes, for sections other than that at M = 0, and a heading.
    """
    import plotly.graph_objects as go

    if not curves:
        raise InputError("curves", "are missing", remedy="give at least one")
    figure = go.Figure()
    for k, curve in enumerate(curves):
        outline = curve.outline if isinstance(curve, Section) else curve
        points = _border(outline)
        color = COLORS[k % len(COLORS)]
        figure.add_scatter(
            x=points[:, 0],
            y=points[:, 1],
            mode="markers" if len(points) == 1 else "lines",
            name=names[k] if k < len(names) else f"curve {k + 1}",
            line={"color": color},
            marker={"color": color, "size": 8},
            showlegend=len(curves) > 1,
        )
    cross = {"symbol": "cross-thin", "size": 11, "line": {"width": 2, "color": "#333333"}}
    figure.add_scatter(x=[0.0], y=[0.0], mode="markers", name="origin", marker=cross)
    figure.update_traces(selector={"name": "origin"}, showlegend=False)
    figure.update_xaxes(exponentformat="SI", zeroline=False)
    figure.update_yaxes(exponentformat="SI", zeroline=False, scaleanchor="x")
    return lay_out(figure, x=x, y=y, title=title)


def _border(outline: shapely.Geometry) -> NDArray[np.float64]:
    """Return the corners of an outline in order, rows of NaN between pieces and holes."""
    rings: list[NDArray[np.float64]] = []
    for piece in shapely.get_parts(outline):
        parts = shapely.get_rings(piece) if piece.geom_type == "Polygon" else [piece]
        for part in parts:
            rings += [shapely.get_coordinates(part), np.full((1, 2), np.nan)]
    return np.concatenate(rings[:-1]) if rings else np.empty((0, 2))
