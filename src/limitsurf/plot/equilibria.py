"""Draw a part where a field leaves it at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.potential_field import LoadField
from limitsurf.geometry.part import Part
from limitsurf.planning.equilibria import Equilibria, equilibria
from limitsurf.plot.length_unit import length_unit
from limitsurf.plot.part import outline_path
from limitsurf.plot.style import COLORS, lay_out

__all__ = ["draw_equilibria"]

Array = NDArray[np.float64]

_ARROWS = 15  # along the longer side
_GAP = 2.2  # circumradii between poses along a line


def draw_equilibria(part: Part, field: LoadField, found: Equilibria | None = None) -> Any:
    """Return a plotly figure of a part in its poses of rest, with the field as arrows.

    Parameters
    ----------
    part, field : Part, LoadField
        What rests where; a field that can be called on points is drawn.
    found : Equilibria, optional
        The poses, if they are known already. Stable ones are filled, saddles dotted, others
        dashed; along a line, where all shifts are at rest, they are drawn side by side.

    Examples
    --------
    >>> from limitsurf.actuators.density_field import DensityField
    >>> part = Part.from_file("paper_t")
    >>> draw_equilibria(part, DensityField.squeeze(0.0, 1.0)).layout.xaxis.title.text
    'x [mm]'
    """
    import plotly.graph_objects as go

    found = equilibria(part, field) if found is None else found
    poses = _side_by_side(part, found)
    unit = length_unit(part.circumradius)
    figure = go.Figure()
    if callable(field):
        places = poses[:, :2] if len(poses) else np.zeros((1, 2))
        _add_arrows(figure, field, places, 1.6 * part.circumradius, unit.scale)
    kinds = ((0, "stable", "solid", 2), (1, "saddle", "dot", 1), (2, "unstable", "dash", 3))
    for descents, name, dash, color in kinds:
        for k, pose in enumerate(poses[np.minimum(found.index, 2) == descents]):
            x, y = outline_path(part.at(pose), unit.scale).T
            figure.add_scatter(
                x=x,
                y=y,
                mode="lines",
                fill="toself" if descents == 0 else None,
                fillcolor="rgba(58,125,68,0.2)",
                line={"dash": dash, "color": COLORS[color]},
                name=name,
                legendgroup=name,
                showlegend=k == 0,
            )
    x, y = unit.scale * poses[:, :2].T
    figure.add_scatter(
        x=x, y=y, mode="markers", marker={"color": "black", "size": 6}, name="centre of mass"
    )
    figure.update_xaxes(constrain="domain")
    figure.update_yaxes(scaleanchor="x", constrain="domain")
    return lay_out(figure, x=f"x [{unit.name}]", y=f"y [{unit.name}]", title=_title(found))


def _title(found: Equilibria) -> str:
    """Return what the poses alone do not tell."""
    if not len(found.poses):
        return f"no equilibrium: {found.note}"
    if found.neutral:
        return "at rest in every orientation; one is drawn"
    return "at rest anywhere along the line; drawn side by side" if len(found.flat) == 1 else ""


def _side_by_side(part: Part, found: Equilibria) -> Array:
    """Return the poses, spread along a line in which the field does not change."""
    poses = found.poses.copy()
    if len(found.flat) == 1:
        place = _GAP * part.circumradius * (np.arange(len(poses)) - 0.5 * (len(poses) - 1))
        poses[:, :2] += place[:, None] * found.flat[0]
    return poses


def _add_arrows(figure: Any, field: Any, places: Array, margin: float, scale: float) -> None:
    """Add arrows of one length, in a box around the places, where the field is not zero."""
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    step = (high - low).max() / _ARROWS
    axes = [np.arange(a + 0.5 * step, b, step) for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    push = field(points)
    size = np.hypot(*push.T)
    points, push = points[size > 0.0], push[size > 0.0]
    figure.add_scatter(
        x=scale * points[:, 0],
        y=scale * points[:, 1],
        mode="markers",
        name="field",
        marker={
            "symbol": "arrow",
            "angle": 90.0 - np.degrees(np.arctan2(push[:, 1], push[:, 0])),
            "size": 9,
            "color": "#bbbbbb",
        },
    )
