"""Draw limit surfaces in load space."""

from __future__ import annotations

from typing import Any

from limitsurf.errors import InputError
from limitsurf.plot.style import COLORS
from limitsurf.sets.convex_set import ConvexSet

__all__ = ["draw_limit_surface"]


def draw_limit_surface(*surfaces: ConvexSet, names: tuple[str, ...] = ()) -> Any:
    """Return a plotly figure of one or more sets of loads, such as the paper's Figures 8 and 9.

    Parameters
    ----------
    *surfaces : ConvexSet
        Sets in three dimensions: loads [N, N, N m]. Flat ones are drawn as sheets, segments as
        lines, points as points.
    names : tuple of str, optional
        Names for the legend.
    """
    import plotly.graph_objects as go

    if not surfaces:
        raise InputError("surfaces", "are missing", remedy="give at least one set")
    figure = go.Figure()
    for k, surface in enumerate(surfaces):
        vertices, triangles = surface.to_mesh()
        common = {
            **dict(zip("xyz", vertices.T, strict=True)),
            "name": names[k] if k < len(names) else f"surface {k + 1}",
            "showlegend": len(surfaces) > 1,
        }
        color = COLORS[k % len(COLORS)]
        if len(triangles) == 0:  # a segment or a point has no area to draw
            line, marker = {"color": color, "width": 6}, {"color": color, "size": 4}
            figure.add_scatter3d(mode="lines+markers", line=line, marker=marker, **common)
        else:
            figure.add_mesh3d(
                **dict(zip("ijk", triangles.T, strict=True)),
                color=color,
                opacity=0.6 if len(surfaces) > 1 else 1.0,
                flatshading=True,
                **common,
            )
    figure.update_layout(
        template="plotly_white",
        font={"family": "system-ui, sans-serif", "size": 14},
        margin={"l": 0, "r": 0, "t": 30, "b": 0},
        scene={
            "xaxis_title": "F<sub>x</sub> [N]",
            "yaxis_title": "F<sub>y</sub> [N]",
            "zaxis_title": "M [N m]",
            "aspectmode": "data",
        },
    )
    return figure
