"""Draw the orientation errors of a verification."""

from __future__ import annotations

from typing import Any

import numpy as np

from limitsurf.planning.verification import Verification
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_errors"]


def draw_errors(verification: Verification) -> Any:
    """Return a plotly histogram of the errors of the final orientation, with the tolerance."""
    import plotly.graph_objects as go

    figure = go.Figure()
    figure.add_histogram(
        x=np.degrees(verification.errors), xbins={"size": 0.5}, marker={"color": COLORS[0]}
    )
    for side in (-1.0, 1.0):
        figure.add_vline(
            x=side * float(np.degrees(verification.tolerance)),
            line={"dash": "dash", "color": COLORS[1]},
        )
    return lay_out(figure, x="error of the final orientation [deg]", y="runs")
