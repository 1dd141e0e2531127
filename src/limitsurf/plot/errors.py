"""Draw the orientation errors of a verification."""

from __future__ import annotations

from typing import Any

import numpy as np

from limitsurf.planning.verification import Verification
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_errors"]


def draw_errors(verification: Verification) -> Any:
    """Return a plotly histogram of the errors of the final orientation, with the tolerance.

    Parameters
    ----------
    verification : Verification
        From `verify_alignment`.
    """
    import plotly.graph_objects as go

    errors, tolerance = np.degrees(verification.errors), float(np.degrees(verification.tolerance))
    reach = 1.1 * max(tolerance, float(np.abs(errors).max()))
    figure = go.Figure()
    figure.add_histogram(
        x=errors, xbins={"size": max(tolerance / 12, reach / 90)}, marker={"color": COLORS[0]}
    )
    for side in (-1.0, 1.0):
        figure.add_vline(
            x=side * tolerance,
            line={"dash": "dash", "color": COLORS[1]},
            annotation={"text": "tolerance" if side > 0 else "", "font": {"color": COLORS[1]}},
            annotation_position="top right",
        )
    figure.update_xaxes(range=[-reach, reach])
    return lay_out(figure, x="error of the final orientation [deg]", y="runs")
