"""Random small scenes for event-driven motion, and what holds for each of them."""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.geometry.part import Part
from limitsurf.motion.array_events.event_motion import event_motion
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.simulate import simulate
from limitsurf.motion.trajectory import EventKind

SHAPES = ("convex", "star", "hole", "two pieces")


@dataclass(frozen=True)
class Case:
    """One scene."""

    part: Part
    drive: Activation
    pose: np.ndarray
    twist: np.ndarray
    mode: str
    duration: float

    def run(self, **changes):
        settings = {"twist": self.twist, "mode": self.mode, "frames": 20} | changes
        drag = air_film_drag(self.part, self.drive.array)
        return event_motion(self.part, self.drive, self.pose, self.duration, drag=drag, **settings)

    def steps(self, time_step):
        return simulate(
            self.part,
            self.drive,
            self.pose,
            self.duration,
            twist=self.twist,
            mode=self.mode,
            time_step=time_step,
            frames=20,
        )


def small_array(grip=0.0, pixels=16):
    """Return an array of point tips."""
    array = load_array("resonator64")
    pixel = replace(array.pixel, residual_fraction=grip, tip_width=0.0)
    return replace(array, pixel=pixel, rows=pixels, columns=pixels)


def random_part(rng, shape):
    """Return a part of half a millimetre or so."""
    corners = int(rng.integers(4, 9))
    angles = np.sort(rng.uniform(0.0, 2 * np.pi, corners)) + np.linspace(0, 1e-3, corners)
    radii = rng.uniform(0.3, 0.9, corners) if shape == "star" else np.full(corners, 0.7)
    ring = 1e-3 * radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    outline = shapely.Polygon(ring)
    if shape == "convex" or outline.area < 3e-7 or not outline.is_valid:
        outline = outline.convex_hull.buffer(1e-4, join_style="mitre")
    if shape == "hole":
        x, y = shapely.get_coordinates(outline.centroid)[0]
        outline = outline.difference(shapely.box(x - 1.7e-4, y - 1.3e-4, x + 1.5e-4, y + 1.4e-4))
    if shape == "two pieces":
        x, y = shapely.get_coordinates(outline.centroid)[0]
        outline = outline.difference(shapely.box(x - 1.1e-4, y - 2e-3, x + 1.1e-4, y + 2e-3))
    if outline.geom_type == "Polygon" and shape == "two pieces":
        outline = shapely.MultiPolygon([outline])
    return Part(outline, "80 g/m^2")


def random_case(seed, mode=None, grip=None, duration=0.15):
    rng = np.random.default_rng([20261125, seed])
    mode = mode or ("quasi-static", "inertial")[seed % 2]
    grip = grip if grip is not None else (0.0, 0.01, 0.05)[seed // 2 % 3]
    array = small_array(grip)
    kind = seed // 6 % 3
    if kind == 0:
        drive = squeeze_activation(array, rng.uniform(0, np.pi))
    elif kind == 1:
        direction = rng.normal(size=2)
        push = array.site_directions @ direction
        drive = Activation(array, (push > 0.0) & (rng.random(push.shape) < 0.8))
    else:
        drive = Activation(array, rng.random(array.site_directions.shape[:2]) < 0.35)
    part = random_part(rng, SHAPES[seed // 18 % 4])
    pose = np.array([*rng.uniform(-3e-4, 3e-4, 2), rng.uniform(-np.pi, np.pi)])
    twist = np.zeros(3)
    if mode == "inertial" and rng.random() < 0.5:
        twist = np.array([*rng.normal(scale=5e-3, size=2), rng.normal(scale=5.0)])
    return Case(part, drive, pose, twist, mode, duration)


def on_outline(path):
    """Return for each frame the tips that are kept on the outline then."""
    held, found, events = set(), [], list(path.events)
    for time in path.times:
        while events and events[0].time <= time:
            event = events.pop(0)
            if event.kind is EventKind.CAPTURE:
                held.add(event.where)
            elif event.kind is EventKind.RELEASE:
                held.discard(event.where)
        found.append(set(held))
    return found


def distances(case, pose):
    """Return rows, columns, places of the active tips, whether inside, distance to the outline."""
    array = case.drive.array
    rows, columns = np.nonzero(case.drive.active)
    points = np.array(array.first_site) + array.site_pitch * np.column_stack([columns, rows])
    outline = case.part.at(pose)
    gap = shapely.distance(shapely.boundary(outline), shapely.points(points))
    return (
        list(zip(rows.tolist(), columns.tolist(), strict=True)),
        shapely.contains_xy(outline, points),
        gap,
    )
