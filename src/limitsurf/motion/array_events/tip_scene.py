"""What does not change while a part moves on an activated array, tips taken as points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import g

from limitsurf.actuators.activation import Activation
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.options import Mode, check_choice, checked_drag
from limitsurf.sets.arguments import as_array

__all__ = ["Load", "Scene", "build_scene"]

Array = NDArray[np.float64]
Load = ArrayLike | Callable[[float], ArrayLike] | None

#: Two places closer than this, relative to the pitch of the sites, are one.
_NEAR = 2e-13


@dataclass(frozen=True, eq=False)
class Scene:
    """Part, active tips and loads.

    Attributes
    ----------
    part : Part
        The part.
    edges : (E, 4) float
        Edges of the part about its centre of mass, the inside on their left.
    normals, lengths : (E, 2), (E,) float
        Unit normals to the inside; lengths.
    following : (E,) int
        The edge that begins where an edge ends.
    convex : (E,) bool
        Whether the part is convex where an edge ends.
    points, forces : (n, 2) float
        Active tips [m], and their mean pushes per normal force.
    where : (n, 2) int
        Their rows and columns.
    grip : float
        Radius of a tip's friction disk per normal force.
    weight, lift : float
        The part's weight, and what a tip can carry [N].
    mass, drag : (3,) float
        For (x, y, theta).
    inertial : bool
        Whether the part's mass counts.
    load : callable
        External load (3,) at a time.
    steady : bool
        Whether that does not change.
    pitch, radius : float
        Distance of neighbouring sites; the part's circumradius [m].
    walls : (4, 4) float
        Border of the cells of the sites, the inside on its left.
    """

    part: Part
    edges: Array
    normals: Array
    lengths: Array
    following: NDArray[np.int64]
    convex: NDArray[np.bool_]
    points: Array
    forces: Array
    where: NDArray[np.int64]
    grip: float
    weight: float
    lift: float
    mass: Array
    drag: Array
    inertial: bool
    load: Callable[[float], Array]
    steady: bool
    pitch: float
    radius: float
    walls: Array

    @property
    def near(self) -> float:
        """Distance below which two places are one [m]."""
        return _NEAR * self.pitch

    @property
    def quadratic(self) -> Array:
        """Diagonal of what resists: mass or drag."""
        return self.mass if self.inertial else self.drag

    @cached_property
    def force(self) -> float:
        """Size of the forces on the part at the start [N]."""
        load = self.load(0.0)
        push = self.weight * np.hypot(self.forces[:, 0], self.forces[:, 1]).max(initial=0.0)
        pull = np.hypot(load[0], load[1]) + abs(load[2]) / self.radius
        return float(push + self.grip * self.weight + pull)

    @cached_property
    def speed(self) -> float:
        """The speed that the drive can give [m/s]: against drag, or over the circumradius."""
        fall = np.sqrt(2 * self.force * self.radius / self.mass[0])
        return float(min(np.divide(self.force, self.drag[0]) if self.drag[0] else np.inf, fall))

    @property
    def rate_size(self) -> float:
        """Size of speeds, or of accelerations of a part with mass, that the drive gives."""
        return self.force / float(self.mass[0]) if self.inertial else self.speed

    def rim_speed(self, twist: Array) -> float:
        """Return a bound on the speed of the part's points [m/s]."""
        return float(np.hypot(twist[0], twist[1]) + self.radius * abs(twist[2]))

    def on_array(self, pose: Array) -> bool:
        """Return whether all corners of the part lie over the cells of the sites."""
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        corners = self.edges[:, :2] @ np.array([[cos, sin], [-sin, cos]]) + pose[:2]
        low, high = self.walls[0, :2] - self.near, self.walls[2, :2] + self.near
        return bool((corners >= low).all() and (corners <= high).all())


def build_scene(
    part: Part,
    drive: Activation,
    drag: ArrayLike,
    load: Load,
    mode: Mode,
    weight: float | None = None,
) -> Scene:
    """Return the scene of a part on an activated array; `mode` as in `event_motion`."""
    check_choice("mode", mode, get_args(Mode))
    array, pixel = drive.array, drive.array.pixel
    rows, columns = np.nonzero(drive.running)
    origin, pitch = np.array(array.first_site), array.site_pitch
    low = origin - 0.5 * pitch
    high = low + pitch * np.array(drive.active.shape[::-1])
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    edges = np.array(part.edges)
    along = edges[:, 2:] - edges[:, :2]
    lengths = np.hypot(along[:, 0], along[:, 1])
    following = _following(edges)
    after = along[following]
    push = pixel.friction * pixel.offset_fraction
    return Scene(
        part=part,
        edges=edges,
        normals=np.column_stack([-along[:, 1], along[:, 0]]) / lengths[:, None],
        lengths=lengths,
        following=following,
        convex=along[:, 0] * after[:, 1] - along[:, 1] * after[:, 0] >= 0.0,
        points=np.ascontiguousarray(origin + pitch * np.column_stack([columns, rows])),
        forces=push * array.site_directions[rows, columns],
        where=np.column_stack([rows, columns]),
        grip=pixel.friction * pixel.residual_fraction,
        weight=part.mass * g if weight is None else weight,
        lift=pixel.vertical_force(array.voltage),
        mass=np.array([part.mass, part.mass, part.inertia]),
        drag=_even_drag(drag, mode),
        inertial=mode == "inertial",
        load=_load(load),
        steady=not callable(load),
        pitch=pitch,
        radius=part.circumradius,
        walls=np.hstack([corners, np.roll(corners, -1, axis=0)]),
    )


def _following(edges: Array) -> NDArray[np.int64]:
    """Return which edge begins where each ends; rings come one after the other."""
    following = np.arange(1, len(edges) + 1)
    first = 0
    for e in range(len(edges)):
        if e == len(edges) - 1 or not np.array_equal(edges[e, 2:], edges[e + 1, :2]):
            following[e], first = first, e + 1
    return following


def _even_drag(drag: ArrayLike, mode: Mode) -> Array:
    checked = checked_drag(drag, mode)
    if checked[0] != checked[1]:
        raise InputError("drag", "must be the same along x and y", value=tuple(checked))
    return checked


def _load(load: Load) -> Callable[[float], Array]:
    if callable(load):
        return lambda t: as_array("load", load(t), 3)
    constant = as_array("load", np.zeros(3) if load is None else load, 3)
    return lambda _: constant
