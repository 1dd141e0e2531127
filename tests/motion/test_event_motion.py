"""Event-driven motion against small steps, exact crossings, rest and sliding on borders."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.constants import g
from scipy.optimize import linprog

from limitsurf.actuators.activation import Activation, squeeze_activation
from limitsurf.errors import InputError, PartTooHeavy, TooManyEvents
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.event_motion import event_motion
from limitsurf.motion.trajectory import EventKind, Outcome
from tests.motion.event_scenes import distances, on_outline, random_case, small_array

PITCH = 1e-4
CROSSINGS = (EventKind.ENTER, EventKind.LEAVE)


def kinds(path):
    return [event.kind for event in path.events]


def difference(case, path, time_step, tip_width=0.0):
    """Return the largest distance of rim points from those of small steps, over the pitch."""
    pixel = replace(case.drive.array.pixel, tip_width=tip_width)
    array = replace(case.drive.array, pixel=pixel)
    steps = replace(case, drive=Activation(array, case.drive.active)).steps(time_step)
    worst = 0.0
    for time, pose in zip(steps.times, steps.poses, strict=True):
        nearest = int(np.argmin(np.abs(path.times - time)))
        if time > path.duration:  # at rest, or gone
            nearest = -1
        elif abs(path.times[nearest] - time) > 1e-9:
            continue
        if time > path.duration and path.outcome is Outcome.LEFT_ARRAY:
            continue
        gap = (pose - path.poses[nearest]) * [1.0, 1.0, case.part.circumradius]
        worst = max(worst, float(np.abs(gap).max()) / PITCH)
    return worst


def errors_of(case):
    """Return the path, and its differences from steps that become sixteen times smaller.

    Steps of point tips chatter about a border, each of them with the friction of one cell: with
    friction that is not the hull of the two cells' sets. There the steps take tips of a width
    that vanishes with the step.
    """
    path = case.run()
    wide = case.drive.array.pixel.residual_fraction > 0.0 and EventKind.CAPTURE in kinds(path)
    steps = case.duration / 20 * 0.25 ** np.arange(2, 5)
    return path, [difference(case, path, h, 0.03 * h * wide) for h in steps]


def check_subsets(case, path):
    """The tips counted are those in the polygon, but for those on the outline."""
    for pose, tips, held in zip(path.poses, path.tips, on_outline(path), strict=True):
        names, inside, gap = distances(case, pose)
        sure = [
            i and name not in held and d > 1e-12 * PITCH
            for name, i, d in zip(names, inside, gap, strict=True)
        ]
        free = [name in held or d <= 1e-12 * PITCH for name, d in zip(names, gap, strict=True)]
        assert sum(sure) <= tips <= sum(sure) + sum(free)


def check_crossings(case, path):
    """Where a tip enters or leaves, it is on the outline to 1e-12 of the pitch."""
    array = case.drive.array
    for event in path.events:
        if event.kind in CROSSINGS:
            pose = path.poses[np.searchsorted(path.times, event.time)]
            row, column = event.where
            place = np.array(array.first_site) + array.site_pitch * np.array([column, row])
            boundary = shapely.boundary(case.part.at(pose))
            assert shapely.distance(boundary, shapely.Point(place)) < 1e-12 * array.site_pitch


@pytest.mark.parametrize("seed", range(0, 72, 5))
def test_small_steps_approach_the_events(seed):
    case = random_case(seed)
    path, errors = errors_of(case)
    check_subsets(case, path)
    check_crossings(case, path)
    assert errors[-1] <= 2e-2
    assert errors[-1] == pytest.approx(0.0, abs=0.4 * errors[0] + 1e-9)
    sizes = np.abs(path.energy.work).max() + path.energy.kinetic.max()
    assert np.abs(path.energy.residual).max() <= 1e-8 * sizes
