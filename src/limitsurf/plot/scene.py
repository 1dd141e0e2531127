"""What moves in an animation: a part, the tips under it, the feet of a walker, the path.

Every piece draws itself once on matplotlib axes in millimetres, and is then shown at a time and
pose.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.geometry.part import Part
from limitsurf.motion.rigid_motion import compose, to_world
from limitsurf.motion.schedule import Schedule
from limitsurf.plot.part import outline_path
from limitsurf.plot.style import COLORS, DIRECTION_COLORS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.quiver import Quiver

__all__ = ["Box", "Feet", "Outline", "Path", "Piece", "Tips", "reach_of"]

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]

_MM = 1e3


class Piece(Protocol):
    """A piece of a scene."""

    def show(self, time: float, pose: Array) -> None:
        """Move to where the piece is at a time [s] and pose of the body [m, m, rad]."""


class Path:
    """The path of the reference point, up to now in a strong line."""

    def __init__(self, axes: Axes, times: Array, poses: Array) -> None:
        self._times, self._xy = times, _MM * poses[:, :2]
        axes.plot(*self._xy.T, color=COLORS[6], linewidth=0.8, alpha=0.5)
        (self.line,) = axes.plot([], [], color=COLORS[2], linewidth=2.0, zorder=5)
        (self.center,) = axes.plot([], [], "o", color="black", markersize=4.0, zorder=6)

    def show(self, time: float, pose: Array) -> None:
        """Draw the way so far."""
        here = _MM * pose[:2]
        way = np.vstack([self._xy[self._times <= time], here])
        self.line.set_data(way[:, 0], way[:, 1])
        self.center.set_data(here[:1], here[1:])


class Outline:
    """The outline of a part."""

    def __init__(self, axes: Axes, part: Part) -> None:
        self._part = part
        (self.fill,) = axes.fill([0.0], [0.0], color=COLORS[0], alpha=0.15, zorder=3)
        (self.line,) = axes.plot([], [], color=COLORS[0], linewidth=1.5, zorder=4)

    def show(self, time: float, pose: Array) -> None:
        """Move the outline."""
        del time
        path = outline_path(self._part.at(pose))
        self.line.set_data(path[:, 0], path[:, 1])
        self.fill.set_xy(_joined(path))


class Tips:
    """The running tips of an array inside a box [m], those under the part in a strong colour."""

    def __init__(self, axes: Axes, drive: Schedule[Activation], part: Part, box: Box) -> None:
        self._drive, self._part = drive, part
        self.arrows: dict[int, tuple[Array, Quiver]] = {}
        for _, activation in drive.entries:
            places, pushes = _running(activation, box)
            length = 1.7 * _MM * activation.array.site_pitch
            self.arrows[id(activation)] = (
                places,
                _arrows(axes, places, length * pushes, width=0.14 * length),
            )

    def show(self, time: float, pose: Array) -> None:
        """Show the tips that run now, and mark those under the part."""
        shape = self._part.at(pose)
        shapely.prepare(shape)
        current = id(self._drive.at(time))
        for key, (places, arrows) in self.arrows.items():
            arrows.set_visible(key == current)
            under = shapely.contains_xy(shape, places[:, 0], places[:, 1])
            arrows.set_facecolor(np.where(under, COLORS[1], DIRECTION_COLORS[0]).tolist())


class Feet:
    """The feet of a body: active ones with the push of the ground on them, passive ones grey."""

    def __init__(self, axes: Axes, feet: Schedule[ContactSet]) -> None:
        from matplotlib.collections import EllipseCollection

        self._feet = feet
        largest = max(np.hypot(*c.offset.T).max(initial=0.0) for _, c in feet.entries) or 1.0
        length = 0.7 * _MM * min(reach_of(feet) / max(len(c), 1) ** 0.5 for _, c in feet.entries)
        (self.body,) = axes.fill([0.0], [0.0], color=COLORS[0], alpha=0.15, zorder=3)
        self.places = EllipseCollection(
            widths=[0.35 * length],
            heights=[0.35 * length],
            angles=[0.0],
            units="xy",
            offsets=np.zeros((1, 2)),
            offset_transform=axes.transData,
            zorder=5,
        )
        axes.add_collection(self.places)
        self._pushes = {id(c): length / largest * c.offset for _, c in feet.entries}
        self.arrows = {
            id(c): _arrows(axes, c.position, self._pushes[id(c)], 0.13 * length, zorder=6)
            for _, c in feet.entries
        }

    def show(self, time: float, pose: Array) -> None:
        """Move the feet."""
        feet = self._feet.at(time)
        flat = np.column_stack([feet.position, np.zeros(len(feet))])
        places = compose(np.broadcast_to(pose, flat.shape), flat)[:, :2]
        active = feet.offset.any(axis=1)
        self.places.set_offsets(_MM * places)
        self.places.set_facecolor(np.where(active, COLORS[1], COLORS[6]).tolist())
        hull = shapely.convex_hull(shapely.multipoints(_MM * places))
        self.body.set_xy(shapely.get_coordinates(hull) if len(feet) else np.zeros((1, 2)))
        for key, arrows in self.arrows.items():
            arrows.set_visible(key == id(feet))
        arrows = self.arrows[id(feet)]
        pushes = self._pushes[id(feet)]
        turned = to_world(np.column_stack([pushes, np.zeros(len(feet))]), pose[2])
        arrows.set_offsets(_MM * places)
        arrows.set_UVC(turned[:, 0], turned[:, 1])
        arrows.set_facecolor(COLORS[1])


def reach_of(feet: Schedule[ContactSet]) -> float:
    """Return the largest distance of a foot from the reference point [m]."""
    return max(float(np.hypot(*c.position.T).max(initial=0.0)) for _, c in feet.entries) or 1e-3


def _arrows(axes: Axes, places: Array, arrows: Array, width: float, zorder: float = 2) -> Quiver:
    """Draw arrows [mm], with shafts of a width [mm], at places [m]."""
    x, y = _MM * places.T
    return axes.quiver(
        x,
        y,
        *arrows.T,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="xy",
        width=width,
        minlength=0.0,
        color=DIRECTION_COLORS[0],
        zorder=zorder,
    )


def _running(activation: Activation, box: Box) -> tuple[Array, Array]:
    """Return places [m] and pushes of the running tips in a box, (k, 2) each."""
    array = activation.array
    rows, columns = np.nonzero(activation.running)
    places = np.array(array.first_site) + array.site_pitch * np.column_stack([columns, rows])
    left, bottom, right, top = box
    x, y = places.T
    inside = (left <= x) & (x <= right) & (bottom <= y) & (y <= top)
    return places[inside], array.site_directions[rows[inside], columns[inside]]


def _joined(path: Array) -> Array:
    """Return rings, parted by NaN, as one closed path that fills the same area.

    Every ring is left at its start, and the starts are gone back through at the end.
    """
    gaps = np.flatnonzero(np.isnan(path[:, 0]))
    rings = np.split(path, gaps)
    rings = [ring[~np.isnan(ring[:, 0])] for ring in rings]
    return np.vstack([*rings, *[ring[:1] for ring in reversed(rings)]])
