"""Draw a part."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.geometry.part import Part
from limitsurf.planning.turn_function import TurnFunction
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_part", "outline_path"]

Array = NDArray[np.float64]


def outline_path(shape: shapely.Geometry) -> Array:
    """Return the rings of a polygon [mm] as one path, (n, 2), with NaN rows between the rings."""
    gap = np.full((1, 2), np.nan)
    rings = [ring for polygon in shapely.get_parts(shape) for ring in shapely.get_rings(polygon)]
    pieces = [np.vstack([1e3 * shapely.get_coordinates(ring), gap]) for ring in rings]
    path: Array = np.vstack(pieces)[:-1]
    return path


def draw_part(part: Part, turn: TurnFunction | None = None) -> Any:
    """Return a plotly figure of a part, with the medians along which it comes to rest.

    Parameters
    ----------
    part : Part
        The part, drawn in the coordinates of its outline.
    turn : TurnFunction, optional
        Draws stable medians full, unstable ones dotted.
    """
    import plotly.graph_objects as go

    figure = go.Figure()
    x, y = outline_path(part.polygon).T
    figure.add_scatter(
        x=x,
        y=y,
        fill="toself",
        fillcolor="rgba(31,95,168,0.15)",
        mode="lines",
        line={"color": COLORS[0]},
        name=part.name,
    )
    center = 1e3 * np.asarray(part.centroid)
    figure.add_scatter(
        x=center[:1], y=center[1:], mode="markers", marker={"color": "black"}, name="centre of mass"
    )
    if turn is not None:
        for kind, angles, dash, color in (
            ("stable", turn.stable, "solid", COLORS[2]),
            ("unstable", turn.unstable, "dot", COLORS[1]),
        ):
            for k, phi in enumerate(angles):
                x, y = _chords(turn, float(phi))
                figure.add_scatter(
                    x=x,
                    y=y,
                    mode="lines",
                    line={"dash": dash, "color": color},
                    name=f"{kind} median",
                    legendgroup=kind,
                    showlegend=k == 0,
                )
    figure.update_xaxes(constrain="domain")
    figure.update_yaxes(scaleanchor="x")
    return lay_out(figure, x="x [mm]", y="y [mm]")


def _chords(turn: TurnFunction, phi: float) -> Array:
    _, chords = turn.median(phi)
    gap = np.full((1, 2), np.nan)
    pieces = [
        np.vstack([1e3 * shapely.get_coordinates(chord), gap])
        for chord in shapely.get_parts(chords)
        if chord.geom_type == "LineString"
    ]
    return np.vstack(pieces).T
