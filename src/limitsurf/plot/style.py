"""What all pictures share: colours, fonts and margins."""

from __future__ import annotations

from typing import Any

__all__ = ["COLORS", "DIRECTION_COLORS", "FILLED", "lay_out"]

COLORS = ("#1f5fa8", "#d1495b", "#3a7d44", "#8d5a97", "#c9822b", "#2a9d8f", "#6b705c", "#b5838d")

#: How the outline of a part is drawn.
FILLED = {
    "fill": "toself",
    "fillcolor": "rgba(31,95,168,0.15)",
    "mode": "lines",
    "line": {"color": COLORS[0]},
}

#: Push towards +x, -x, +y, -y.
DIRECTION_COLORS = ("#9ecae1", "#fdbf6f", "#b2df8a", "#cab2d6")


def lay_out(figure: Any, *, x: str, y: str, title: str = "") -> Any:
    """Give a plotly figure the common look, with axes labelled `x` and `y`."""
    figure.update_layout(
        template="plotly_white",
        font={"family": "system-ui, sans-serif", "size": 14},
        margin={"l": 70, "r": 20, "t": 64 if title else 30, "b": 60},
        height=430,
        legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0.0},
        title={"text": title, "font": {"size": 16}} if title else None,
        xaxis_title=x,
        yaxis_title=y,
    )
    return figure
