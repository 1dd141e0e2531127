"""Animate runs of a verification on the array."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.motion.trajectory import Trajectory
from limitsurf.planning.array_verification import ArrayVerification
from limitsurf.plot.part import outline_path
from limitsurf.plot.style import COLORS, DIRECTION_COLORS, lay_out

__all__ = ["animate_runs"]

Array = NDArray[np.float64]


def animate_runs(verification: ArrayVerification, *, runs: int = 6, frames: int = 60) -> Any:
    """Return a plotly figure that plays the first runs side by side, with slider and buttons.

    Parameters
    ----------
    verification : ArrayVerification
        From `verify_alignment`; the runs are simulated again.
    runs : int
        How many; runs that failed come first.
    frames : int
        Frames for each line. Parts that rest wait for the slowest.
    """
    import plotly.graph_objects as go

    order = np.concatenate([verification.failures[: runs // 2], np.arange(verification.samples)])
    shown = list(dict.fromkeys(int(k) for k in order))[:runs]
    replays = [verification.replay(k, frames=2 * frames) for k in shown]
    lines = len(verification.plan.lines)
    pictures = [
        (k, time, [_pose(replay, k, time) for replay in replays])
        for k in range(lines)
        for time in np.linspace(0.0, max(_duration(r, k) for r in replays), frames)
    ]
    figure = go.Figure(
        data=_ground(verification, 0) + _parts(verification, shown, pictures[0][2]),
        frames=[
            go.Frame(
                name=str(i),
                data=_show(k, lines) + _parts(verification, shown, poses),
                layout={"title": _caption(verification, k, time)},
            )
            for i, (k, time, poses) in enumerate(pictures)
        ],
    )
    _add_controls(figure, [f"{k + 1}: {time:.2f} s" for k, time, _ in pictures])
    array = verification.activations[0].array
    figure.update_xaxes(range=[-500 * array.width, 500 * array.width], constrain="domain")
    figure.update_yaxes(range=[-500 * array.height, 500 * array.height], scaleanchor="x")
    lay_out(figure, x="x [mm]", y="y [mm]", title=_caption(verification, 0, 0.0))
    figure.update_layout(
        height=780,
        legend={"title": "run", "orientation": "v", "x": 1.0, "y": 1.0, "yanchor": "top"},
    )
    return figure


def _show(line: int, lines: int) -> list[dict[str, Any]]:
    """Return the changes that show one line's pixels and hide those of the others."""
    return [
        {"type": kind, "visible": k == line}
        for k in range(lines)
        for kind in ("heatmap", "scatter")
    ]


def _caption(verification: ArrayVerification, line: int, time: float) -> str:
    angle = np.degrees(verification.plan.lines[line])
    first = ", after centring the part" if len(verification.stages[line]) > 1 else ""
    return f"Line {line + 1} at {angle:.1f} deg{first}, {time:.2f} s"


def _duration(replay: list[Trajectory], line: int) -> float:
    return replay[line].duration if line < len(replay) else 0.0


def _pose(replay: list[Trajectory], line: int, time: float) -> Array:
    """Return the pose at a time on a line; the last pose once the motion is over."""
    trajectory = replay[min(line, len(replay) - 1)]
    if line >= len(replay):
        return trajectory.final_pose
    return np.array([np.interp(time, trajectory.times, q) for q in trajectory.poses.T])


def _parts(verification: ArrayVerification, shown: list[int], poses: list[Array]) -> list[Any]:
    import plotly.graph_objects as go

    part = verification.part
    traces = []
    for run, pose, color in zip(shown, poses, COLORS * len(shown), strict=False):
        shape = shapely.simplify(part.at(pose), 2e-3 * part.circumradius)
        x, y = np.round(outline_path(shape), 3).T
        ending = "" if verification.successes[run] else " (failed)"
        traces.append(
            go.Scatter(
                x=x,
                y=y,
                mode="lines",
                fill="toself",
                opacity=0.55,
                name=f"{run}{ending}",
                line={"color": color, "width": 2},
            )
        )
    return traces


def _ground(verification: ArrayVerification, visible: int) -> list[Any]:
    """Return, for every line, the pixels coloured by their push, and the line."""
    import plotly.graph_objects as go

    traces = []
    for k, activation in enumerate(verification.activations):
        array, angle = activation.array, verification.plan.lines[k]
        centers = 1e3 * array.pixel_centers
        reach = 1000 * np.hypot(array.width, array.height) * np.array([-1.0, 1.0])
        beside = 1e3 * verification.beside
        traces += [
            go.Heatmap(
                x=centers[0, :, 0],
                y=centers[:, 0, 1],
                z=_pushes(activation),
                zmin=-0.5,
                zmax=3.5,
                colorscale=_direction_scale(),
                opacity=0.6,
                visible=k == visible,
                colorbar={
                    "title": "push",
                    "tickvals": [0, 1, 2, 3],
                    "ticktext": ["+x", "-x", "+y", "-y"],
                    "x": -0.16,
                    "thickness": 14,
                    "len": 0.4,
                },
            ),
            go.Scatter(
                x=reach * np.cos(angle) + beside * np.sin(angle),
                y=reach * np.sin(angle) - beside * np.cos(angle),
                mode="lines",
                showlegend=False,
                line={"color": "black", "dash": "dash"},
                visible=k == visible,
            ),
        ]
    return traces


def _pushes(activation: Activation) -> NDArray[np.int64]:
    """Return which way each pixel pushes: 0 to 3 for +x, -x, +y, -y."""
    array = activation.array
    sites = array.nominal_directions * activation.running[..., None]
    pixels = sites.reshape(array.rows, 2, array.columns, 2, 2).sum(axis=(1, 3))
    x, y = pixels[..., 0], pixels[..., 1]
    return np.select([x > 0, x < 0, y > 0], [0, 1, 2], 3)


def _direction_scale() -> list[list[float | str]]:
    steps: list[list[float | str]] = []
    for k, color in enumerate(DIRECTION_COLORS):
        steps += [[k / 4, color], [(k + 1) / 4, color]]
    return steps


def _add_controls(figure: Any, labels: list[str]) -> None:
    timing = {"frame": {"duration": 60, "redraw": True}, "transition": {"duration": 0}}
    play = {"label": "Play", "method": "animate", "args": [None, {**timing, "fromcurrent": True}]}
    stop = {"frame": {"duration": 0, "redraw": False}, "mode": "immediate"}
    pause = {"label": "Pause", "method": "animate", "args": [[None], stop]}
    jump = {**timing, "mode": "immediate"}
    steps = [
        {"label": label, "method": "animate", "args": [[str(i)], jump]}
        for i, label in enumerate(labels)
    ]
    figure.update_layout(
        updatemenus=[
            {
                "type": "buttons",
                "direction": "left",
                "buttons": [play, pause],
                "x": 0.0,
                "y": -0.13,
                "xanchor": "left",
                "yanchor": "top",
                "showactive": False,
            }
        ],
        sliders=[
            {
                "steps": steps,
                "x": 0.18,
                "len": 0.82,
                "y": -0.09,
                "currentvalue": {"prefix": "line and time "},
            }
        ],
    )
