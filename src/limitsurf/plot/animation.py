"""Animate one motion: a part on an array, or a walker on its feet."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.trajectory import Trajectory
from limitsurf.plot.scene import Box, Feet, Outline, Path, Piece, Tips, reach_of
from limitsurf.sets.arguments import as_count, as_positive

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

__all__ = ["animate"]

Array = NDArray[np.float64]
T = TypeVar("T")
Drive = Activation | ContactSet | Schedule[Activation] | Schedule[ContactSet]


def animate(
    trajectory: Trajectory,
    body: Part | ContactSet | Schedule[ContactSet],
    drive: Drive | None = None,
    *,
    frames: int = 60,
    seconds: float = 4.0,
) -> FuncAnimation:
    """Return a matplotlib animation of a motion, seen from above, with axes in millimetres.

    Parameters
    ----------
    trajectory : Trajectory
        The motion.
    body : Part, ContactSet, or Schedule of ContactSet
        What moves: a part, or a walker, drawn as its feet and the hull around them.
    drive : Activation, ContactSet, or a Schedule of them, optional
        What moves a part: the running tips of an array, with those under the part in red, or
        feet of its own, with the pushes on them.
    frames : int
        Frames, evenly spread over the motion; one if it is over at once.
    seconds : float
        Time that playing takes [s].

    Returns
    -------
    FuncAnimation
        ``IPython.display.HTML(animation.to_jshtml())`` shows it in a notebook, and
        ``animation.save("walk.gif", writer="pillow")`` writes a file.

    Examples
    --------
    >>> from limitsurf.motion.walk import walk
    >>> feet = ContactSet([[0.0, 1e-3], [0.0, -1e-3]], 0.0, [[2e-6, 0.0], [1e-6, 0.0]])
    >>> motion = animate(walk(feet, 1.0, drag=(1e-3, 1e-3, 1e-9)), feet, frames=3)
    >>> motion.to_jshtml().count("data:image/png")
    3
    """
    from matplotlib.animation import FuncAnimation
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not isinstance(trajectory, Trajectory):
        raise InputError("trajectory", "is no Trajectory", value=trajectory)
    count, time = as_count("frames", frames), as_positive("seconds", seconds)
    times = np.linspace(0.0, trajectory.duration, count if trajectory.duration > 0.0 else 1)
    poses = np.column_stack([np.interp(times, trajectory.times, q) for q in trajectory.poses.T])
    figure = Figure(figsize=(6.0, 5.4), layout="constrained")
    FigureCanvasAgg(figure)  # no window, and nothing for pyplot to keep
    axes = figure.add_subplot()
    pieces = _pieces(axes, trajectory, body, drive)

    def show(k: int) -> list[Axes]:
        for piece in pieces:
            piece.show(float(times[k]), poses[k])
        axes.set_title(f"{times[k]:.3g} s", loc="left")
        return [axes]

    return FuncAnimation(
        figure, show, frames=len(times), init_func=lambda: [axes], interval=1e3 * time / count
    )


def _pieces(
    axes: Axes,
    trajectory: Trajectory,
    body: Part | ContactSet | Schedule[ContactSet],
    drive: Drive | None,
) -> list[Piece]:
    """Draw what there is to see on labelled axes."""
    part = body if isinstance(body, Part) else None
    feet = _scheduled(ContactSet, body if part is None else drive)
    tips = _scheduled(Activation, drive)
    if part is None and (feet is None or drive is not None):
        raise InputError("body", "must be a part, or feet without a drive", value=body)
    if part is not None and drive is not None and feet is None and tips is None:
        raise InputError("drive", "must be activations or feet", value=drive)
    reach = max(part.circumradius if part else 0.0, reach_of(feet) if feet else 0.0)
    box = _box(trajectory.poses, 1.3 * reach)
    pieces: list[Piece] = [Path(axes, trajectory.times, trajectory.poses)]
    if part is not None:
        pieces.append(Outline(axes, part))
    if feet is not None:
        pieces.append(Feet(axes, feet))
    if part is not None and tips is not None:
        pieces.append(Tips(axes, tips, part, box))
    _label(axes, box)
    return pieces


def _scheduled(kind: type[T], drive: object) -> Schedule[T] | None:
    """Return a drive, or a schedule of drives, of that kind as a schedule; None if it is not."""
    if isinstance(drive, kind):
        return Schedule([(0.0, drive)])
    if isinstance(drive, Schedule) and all(isinstance(each, kind) for _, each in drive.entries):
        return drive
    return None


def _box(poses: Array, reach: float) -> Box:
    """Return left, bottom, right, top of what the body comes to [m]."""
    low, high = poses[:, :2].min(axis=0) - reach, poses[:, :2].max(axis=0) + reach
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _label(axes: Axes, box: Box) -> None:
    left, bottom, right, top = (1e3 * side for side in box)
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.grid(visible=True, color="#e6e6e6")
    axes.set_axisbelow(True)
