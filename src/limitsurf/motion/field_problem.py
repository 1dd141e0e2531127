"""A part in a force density: what acts on it, and the scales of its motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.density_field import DensityField
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.field_steps import FieldBody, uniform_step
from limitsurf.kernels.project_uniform import ANSWER
from limitsurf.kernels.uniform_friction import new_room, uniform_patch
from limitsurf.motion.load_table import LoadLike, LoadTable
from limitsurf.motion.options import Mode, check_choice
from limitsurf.sets.arguments import as_array
from limitsurf.tolerances import CONTACT_SUM, REST_SPEED

__all__ = ["ExternalLoad", "FieldProblem", "as_load", "field_problem"]

Array = NDArray[np.float64]
ExternalLoad = Callable[[float], ArrayLike]


@dataclass(frozen=True, eq=False)
class FieldProblem:
    """A part in a force density, with drag and friction.

    Attributes
    ----------
    part, field, friction : Part, DensityField, UniformFriction or None
        What moves, what pushes, what rubs.
    mass, drag : (3,) float
        Mass, mass, inertia, zeros if quasi-static; viscous drag.
    load : (3,) float or callable
        External load, perhaps of the time [s].
    speed, force : float
        What the part can reach [m/s], and the size of the loads on it [N].
    """

    part: Part
    field: DensityField
    friction: UniformFriction | None
    mass: Array
    drag: Array
    load: Array | ExternalLoad
    speed: float
    force: float

    @property
    def inertial(self) -> bool:
        """Whether the part has mass."""
        return bool(self.mass[0] > 0.0)

    @property
    def steady(self) -> bool:
        """Whether the external load is constant: only then can a part come to rest for good."""
        return not callable(self.load)

    @property
    def rest_speed(self) -> float:
        """Slower than this is at rest [m/s]."""
        return REST_SPEED * self.speed

    @property
    def time(self) -> float:
        """Time for a circumradius [s]."""
        return self.part.circumradius / self.speed if self.speed > 0.0 else 1.0

    def external(self, time: float) -> Array:
        """Return the external load (3,)."""
        if callable(self.load):
            return as_array("load", self.load(time), 3)
        return self.load

    def rim_speed(self, twist: Array) -> float:
        """Return the largest speed that a point within the circumradius may have [m/s]."""
        turning = self.part.circumradius * abs(float(twist[2]))
        return float(np.hypot(twist[0], twist[1])) + turning

    @cached_property
    def body(self) -> FieldBody:
        """What the kernels take."""
        part = self.part
        if self.friction is None:
            patch, unit = uniform_patch(part.edges / part.circumradius), np.empty((0, 0))
        else:
            patch, unit = self.friction.patch, np.ascontiguousarray(self.friction.load_of_unit)
        return FieldBody(np.array(part.edges), part.circumradius, self.mass, self.drag, patch, unit)

    def balance(self, theta: float, pull: Array, Q: Array) -> tuple[Array, Array, float, bool]:
        """Solve ``Q v = pull + F``: twist, friction, error in the norm of Q, whether held."""
        out = np.empty(7 + ANSWER)
        held = uniform_step(self.body, theta, np.array(pull), Q, CONTACT_SUM, new_room(), out)
        return out[:3], out[3:6], float(out[6]), held

    def sliding_friction(self, theta: float, twist: Array) -> Array:
        """Return the friction (3,) on the part while it moves, world axes."""
        if self.friction is None:
            return np.zeros(3)
        c, s = np.cos(theta), np.sin(theta)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return np.asarray(-turn @ self.friction.support_point(turn.T @ twist))


def field_problem(
    part: Part,
    field: DensityField,
    pose: Array,
    twist: Array,
    mode: Literal["inertial", "quasi-static"],
    drag: ArrayLike | None,
    friction: UniformFriction | None,
    load: LoadLike,
) -> FieldProblem:
    """Check what acts on a part, and find the scales of its motion."""
    for name, value, kind in (("part", part, Part), ("field", field, DensityField)):
        if not isinstance(value, kind):
            raise InputError(name, f"is no {kind.__name__}", value=value)
    if not isinstance(friction, UniformFriction | None):
        raise InputError("friction", "is no UniformFriction", value=friction)
    check_choice("mode", mode, get_args(Mode))
    viscous = np.array(as_array("drag", np.zeros(3) if drag is None else drag, 3))
    if viscous.min() < 0.0:
        raise InputError("drag", "has negative entries", value=viscous.tolist())
    if mode == "quasi-static" and viscous.min() == 0.0:
        raise InputError(
            "drag",
            "must be positive in every direction: quasi-static speed is load over drag",
            value=viscous.tolist(),
            remedy="give three entries, as of air_film_drag, or use mode 'inertial'",
        )
    mass = np.zeros(3)
    if mode == "inertial":
        mass[:] = part.mass, part.mass, part.inertia
    if isinstance(load, LoadTable) and load.steady:
        load = load(0.0)
    given = load if callable(load) else as_load(load)
    force = _force_scale(part, field, pose, given)
    if friction is not None:
        force = max(force, friction.traction * friction.part.area)
    speed = _speed_scale(part, force, mass, viscous)
    own = float(np.hypot(twist[0], twist[1])) + part.circumradius * abs(float(twist[2]))
    speed = max(speed, own if mode == "inertial" else 0.0)
    return FieldProblem(part, field, friction, mass, viscous, given, speed, force)


def as_load(load: ArrayLike | None) -> Array:
    """Return a constant load, none by default."""
    return as_array("load", np.zeros(3) if load is None else load, 3)


def _force_scale(part: Part, field: DensityField, pose: Array, load: Array | ExternalLoad) -> float:
    """Return the largest density under the part at the start times its area, and the load's."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    corners = part.edges[:, :2] @ np.array([[c, s], [-s, c]]) + pose[:2]
    density = np.hypot(*field(np.vstack([corners, pose[:2]])).T).max()
    outer = as_array("load", load(0.0), 3) if callable(load) else load
    arm = abs(float(outer[2])) / part.circumradius
    return float(density * part.area + np.hypot(outer[0], outer[1]) + arm)


def _speed_scale(part: Part, force: float, mass: Array, drag: Array) -> float:
    """Return the lesser of the terminal speed and the speed after a circumradius."""
    limits = []
    if drag[0] > 0.0:
        limits.append(force / float(drag[0]))
    if mass[0] > 0.0:
        limits.append(float(np.sqrt(2.0 * force * part.circumradius / mass[0])))
    return min(limits)
