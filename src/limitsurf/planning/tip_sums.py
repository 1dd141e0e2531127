"""What the running tips of an array do to a part in a squeeze: sums over poses near its rests."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from limitsurf.actuators.activation import Activation
from limitsurf.contacts.lattice_contacts import LatticeContacts
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.turn_function import TurnFunction

__all__ = ["held_moment", "poses_near_rest", "tip_sums"]

Array = NDArray[np.float64]

_ANGLES = 45  # orientations, beside the equilibria, at which held moments are looked at


def poses_near_rest(
    turn: TurnFunction, line: float, pitch: float, reach: float, samples: int
) -> Array:
    """Return rows ``phi, x, y, theta, px, py``: poses, and the middle of the median chord there."""
    part = turn.part
    rests = np.concatenate([turn.stable, turn.unstable])
    unit = 2.0 * qmc.Halton(3, scramble=False).random(samples * len(rests) + 1)[1:] - 1.0
    phi = np.tile(rests, samples) + pitch / part.circumradius * unit[:, 0]
    along, normal = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    middles = np.array([_chord_middle(turn, angle) for angle in phi])
    cosine, sine = np.cos(phi + line), np.sin(phi + line)
    x, y = middles.T
    arm = np.column_stack([cosine * x - sine * y, sine * x + cosine * y])
    offset = -(arm @ normal) + 0.5 * pitch * unit[:, 1]
    place = offset[:, None] * normal + reach * unit[:, 2:] * along
    return np.asarray(np.column_stack([phi, place, phi + line, arm]), dtype=np.float64)


def _chord_middle(turn: TurnFunction, phi: float) -> Array:
    """Return the middle of the median's chords from the centroid, part frame [m]."""
    center = turn.median(float(phi))[1].centroid
    x, y = turn.part.centroid
    return np.array([center.x - x, center.y - y])


def tip_sums(activation: Activation, part: Part, poses: Array) -> Array:
    """Return rows of sums over running tips, pushes in units of the nominal one.

    Moment about the chord's middle; work against the line, the U of the array; moment that turned
    directions take away; variance of the first without its mean, per dead tip; number of tips.
    """
    line = activation.line
    assert line is not None
    along, normal = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    rows = []
    for (x, y, *_), arm, spots, push in _tips(activation, part, poses):
        s, n, height = push @ along, push @ normal, (spots - arm) @ normal
        moment = (spots - arm) @ along * n - height * s
        work = -(spots + np.array([x, y])) @ normal * n
        moment_sum, work_sum = moment.sum(), work.sum()
        off = moment - moment_sum / work_sum * work
        rows.append([moment_sum, work_sum, (height * s).sum(), (off**2).sum(), len(spots)])
    return np.array(rows)


def _tips(
    activation: Activation, part: Part, poses: Array
) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Yield pose, arm, and positions and pushes of the running tips, for each row of poses."""
    array, running = activation.array, activation.running
    sites = LatticeContacts(part, array.site_pitch, array.first_site, running.shape)
    pushes = array.site_directions
    for row in poses:
        sites.move(row[1:4])
        runs = running[tuple(sites.sites.T)]
        if not runs.any():
            raise InputError("array", "leaves no running actuator under the part")
        yield row[1:4], row[4:6], sites.positions[runs], pushes[tuple(sites.sites[runs].T)]


def held_moment(turn: TurnFunction) -> float:
    """Return the largest moment of unit friction, turning about the chord's middle, over U."""
    friction = UniformFriction(turn.part, 1.0)
    phi = np.concatenate([np.linspace(0.0, np.pi, _ANGLES), turn.stable, turn.unstable])
    x, y = np.array([_chord_middle(turn, angle) for angle in phi]).T
    moments = friction.support(np.column_stack([y, -x, np.ones_like(x)]))
    return float(np.max(moments / turn.potential(phi)))
