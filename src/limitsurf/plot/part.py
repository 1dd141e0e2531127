"""Draw a part."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.geometry.part import Part
from limitsurf.planning.turn_function import TurnFunction
from limitsurf.plot.length_unit import LengthUnit, length_unit
from limitsurf.plot.style import COLORS, FILLED, lay_out

__all__ = ["draw_part", "outline_path"]

Array = NDArray[np.float64]

_RIM = 0.06  # of the part's size, so that its sides are not on the frame


def outline_path(shape: shapely.Geometry, scale: float = 1e3) -> Array:
    """Return the rings of a polygon as one path, (n, 2), with NaN rows between the rings.

    Lengths are multiplied by `scale`; millimetres if not given.
    """
    gap = np.full((1, 2), np.nan)
    rings = [ring for polygon in shapely.get_parts(shape) for ring in shapely.get_rings(polygon)]
    pieces = [np.vstack([scale * shapely.get_coordinates(ring), gap]) for ring in rings]
    path: Array = np.vstack(pieces)[:-1]
    return path


def draw_part(part: Part, turn: TurnFunction | None = None) -> Any:
    """Return a plotly figure of a part, with the medians along which it comes to rest.

    Parameters
    ----------
    part : Part
        The part, drawn in the coordinates of its outline.
    turn : TurnFunction, optional
        Draws stable medians thick, unstable ones thin and dotted.

    Examples
    --------
    >>> from limitsurf.planning.turn_function import turn_function
    >>> square = Part([(0, 0), (1e-3, 0), (1e-3, 1e-3), (0, 1e-3)], name="square")
    >>> figure = draw_part(square, turn_function(square))
    >>> [trace.name for trace in figure.data][:3]
    ['square', 'centre of mass', 'stable median']
    """
    import plotly.graph_objects as go

    unit = length_unit(part.circumradius)
    figure = go.Figure()
    x, y = outline_path(part.polygon, unit.scale).T
    figure.add_scatter(
        x=x,
        y=y,
        **FILLED,
        name=part.name,
    )
    center = unit.scale * np.asarray(part.centroid)
    figure.add_scatter(
        x=center[:1], y=center[1:], mode="markers", marker={"color": "black"}, name="centre of mass"
    )
    if turn is not None:
        for kind, angles, dash, width, color in (
            ("stable", turn.stable, "solid", 4.0, COLORS[2]),
            ("unstable", turn.unstable, "dot", 1.5, COLORS[1]),
        ):
            for k, phi in enumerate(angles):
                x, y = _chords(turn, float(phi), unit)
                figure.add_scatter(
                    x=x,
                    y=y,
                    mode="lines",
                    line={"dash": dash, "width": width, "color": color},
                    name=f"{kind} median",
                    legendgroup=kind,
                    showlegend=k == 0,
                )
    left, bottom, right, top = unit.scale * np.array(part.polygon.bounds)
    rim = _RIM * max(right - left, top - bottom)
    figure.update_xaxes(range=[left - rim, right + rim], constrain="domain")
    figure.update_yaxes(range=[bottom - rim, top + rim], constrain="domain", scaleanchor="x")
    return lay_out(figure, x=f"x [{unit.name}]", y=f"y [{unit.name}]")


def _chords(turn: TurnFunction, phi: float, unit: LengthUnit) -> Array:
    _, chords = turn.median(phi)
    gap = np.full((1, 2), np.nan)
    pieces = [
        np.vstack([unit.scale * shapely.get_coordinates(chord), gap])
        for chord in shapely.get_parts(chords)
        if chord.geom_type == "LineString"
    ]
    return np.vstack(pieces).T
