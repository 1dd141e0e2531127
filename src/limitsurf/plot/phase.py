"""Draw how a part moves towards a line: offset and orientation, with the borders of the basins."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.geometry.part import Part
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.separatrices import separatrices
from limitsurf.planning.turn_function import TurnFunction, turn_function
from limitsurf.plot.length_unit import length_unit
from limitsurf.plot.style import COLORS, lay_out
from limitsurf.sets.arguments import as_count

__all__ = ["draw_phase_portrait"]

Array = NDArray[np.float64]

_FRAMES = 181


def draw_phase_portrait(part: Part, mobility_ratio: float = 1.0, *, paths: int = 12) -> Any:
    """Return a plotly figure of the motion in a squeeze field, orientation against offset.

    Starts between two separatrices come to rest at the stable orientation between them. Half a
    turn is the same as the other side of the line, so that the left end of the picture continues
    at the right one upside down.

    Parameters
    ----------
    part : Part
        The part.
    mobility_ratio : float
        See `IdealSqueeze`.
    paths : int
        Starts on each side from which a path is drawn.

    Examples
    --------
    >>> figure = draw_phase_portrait(Part.from_file("paper_t"), paths=4)
    >>> [trace.name for trace in figure.data][-3:]
    ['separatrix', 'stable', 'unstable']
    """
    import plotly.graph_objects as go

    count = as_count("paths", paths, 0)
    turn = turn_function(part)
    unit = length_unit(part.circumradius)
    figure = go.Figure()
    phi = np.linspace(0.0, np.pi, _FRAMES)
    median = np.array([turn.median(float(angle))[0] for angle in phi])
    motions = _paths(part, IdealSqueeze(mobility_ratio), count)
    borders = [(c.orientations, c.offsets) for c in separatrices(part, mobility_ratio)]
    touching = [(phi, edge) for edge in _touching(part, phi)]
    for name, curves, style in (
        ("line touches the part", touching, {"color": "#999999", "dash": "dot"}),
        ("path", _copies(motions), {"color": "#999999", "width": 1}),
        ("median", [(phi, median)], {"color": COLORS[0], "dash": "dash"}),
        ("separatrix", _copies(borders), {"color": COLORS[1], "width": 2.5}),
    ):
        _add(figure, name, curves, style, unit.scale)
    _add_equilibria(figure, turn, unit.scale)
    reach = 1.1 * unit.scale * part.circumradius
    figure.update_xaxes(range=[0, 180], dtick=30)
    figure.update_yaxes(range=[-reach, reach])
    return lay_out(
        figure, x="orientation phi [deg]", y=f"offset of the line from the centroid [{unit.name}]"
    )


def _touching(part: Part, phi: Array) -> Array:
    """Return the least and the largest offset at which the line touches the part, (2, n)."""
    x, y = part.edges[:, 0], part.edges[:, 1]
    across = np.outer(np.sin(phi), x) + np.outer(np.cos(phi), y)
    return np.array([across.min(axis=1), across.max(axis=1)])


def _paths(part: Part, drive: IdealSqueeze, count: int) -> list[tuple[Array, Array]]:
    starts = np.linspace(0.0, np.pi, count, endpoint=False)
    motions = [
        drive.path(part, float(z), float(phi))
        for side in _touching(part, starts)
        for z, phi in zip(side, starts, strict=True)
    ]
    return [(motion.orientations, motion.offsets) for motion in motions]


def _copies(curves: list[tuple[Array, Array]]) -> list[tuple[Array, Array]]:
    """Return curves with those half a turn before and after, on the other side of the line."""
    return [
        (phi + k * np.pi, offset * (-1.0) ** k) for phi, offset in curves for k in (-2, -1, 0, 1, 2)
    ]


def _add(
    figure: Any, name: str, curves: list[tuple[Array, Array]], line: dict[str, Any], scale: float
) -> None:
    """Add curves, with gaps between them, as one trace; what lies outside [0, pi] is left out."""
    x: list[float] = []
    y: list[float] = []
    for phi, offset in curves:
        if phi.min() <= np.pi and phi.max() >= 0.0:
            x += [*np.degrees(phi).tolist(), np.nan]
            y += [*(scale * offset).tolist(), np.nan]
    figure.add_scatter(x=x, y=y, mode="lines", line=line, name=name)


def _add_equilibria(figure: Any, turn: TurnFunction, scale: float) -> None:
    for name, angles, color, symbol in (
        ("stable", turn.stable, COLORS[2], "circle"),
        ("unstable", turn.unstable, COLORS[1], "circle-open"),
    ):
        figure.add_scatter(
            x=np.degrees(angles),
            y=[scale * turn.median(float(angle))[0] for angle in angles],
            mode="markers",
            name=name,
            marker={"color": color, "symbol": symbol, "size": 11},
            cliponaxis=False,
        )
