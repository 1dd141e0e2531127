r"""Poses at rest of a part in a force field with a potential.

Where the potential is convex in position (squeezes, pulls towards points, and their sums) there is
one position of rest for every orientation, and the equilibria are the sign changes of a function
of the orientation alone; see `ReducedPotential` and `sign_changes`. Otherwise many starts look
for them, and nothing says that all are found.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.potential_field import ConvexField, LoadField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.many_starts import stationary_poses
from limitsurf.planning.reduced_potential import ReducedPotential
from limitsurf.planning.sign_changes import sign_changes
from limitsurf.sets.arguments import as_instance

__all__ = ["Equilibria", "equilibria"]

Array = NDArray[np.float64]

_TURN = 2 * np.pi
_EFFORT = 12_000_000  # edges looked at, some seconds


@dataclass(frozen=True, eq=False)
class Equilibria:
    """Poses at which a field leaves a part at rest, sorted by orientation.

    Attributes
    ----------
    poses : (k, 3) float
        Poses ``(x, y, theta)`` of the centre of mass, theta in [0, 2 pi) [m, m, rad].
    index : (k,) int
        In how many independent directions the potential falls: 0 stable, 1 saddle, 2 or 3 others.
    potentials : (k,) float
        Potentials [J].
    flat : (d, 2) float
        Directions in which the field does not change: every pose stands for all its shifts along
        them.
    neutral : bool
        True if the part is at rest in every orientation; the pose given is that of orientation 0.
    complete : bool
        Whether there are no others: the moment is proven to have no zero outside of `gaps`, which
        are short and show one change of its sign at most. For a neutral part, whether that is
        proven.
    gaps : (g, 2) float
        Intervals of orientation [rad] in which the sign of the moment is not proven.
    note : str
        Why there are none, or what is not certain; empty if there is nothing to say.
    """

    poses: Array
    index: NDArray[np.int64]
    potentials: Array
    flat: Array
    neutral: bool
    complete: bool
    gaps: Array
    note: str = ""

    @property
    def stable(self) -> Array:
        """Poses (k, 3) to which the part returns: minima of the potential."""
        return np.asarray(self.poses[self.index == 0])

    @property
    def saddles(self) -> Array:
        """Poses (k, 3) from which the potential falls in one direction and its opposite."""
        return np.asarray(self.poses[self.index == 1])

    @property
    def unstable(self) -> Array:
        """Poses (k, 3) from which the potential falls in more than one direction."""
        return np.asarray(self.poses[self.index > 1])

    def __repr__(self) -> str:
        """Return the counts, and what is special."""
        counts = f"{len(self.stable)} stable, {len(self.saddles)} saddles"
        if len(self.unstable):
            counts += f", {len(self.unstable)} unstable"
        special = [word for word in ("neutral",) if self.neutral]
        special += ["along a line"] if len(self.flat) == 1 and len(self.poses) else []
        special += [] if self.complete else ["perhaps not all"]
        return "Equilibria(" + ", ".join([counts, *special]) + ")"


def equilibria(part: Part, field: LoadField) -> Equilibria:
    """Return the poses at which a field with a potential leaves a part at rest.

    Parameters
    ----------
    part : Part
        The part.
    field : DensityField, RadialField, FieldSum, or any `LoadField`
        What pushes.

    Returns
    -------
    Equilibria
        Complete, with proof, if the field is a `ConvexField` with a finite `turning_bound`, for
        positions of rest that stay within twice the distance from a centre of those on a grid.

    Raises
    ------
    InputError
        The field has no potential, or pushes nowhere.

    Examples
    --------
    A rectangle rests along the line it is squeezed towards, either way round:

    >>> from limitsurf.actuators.density_field import DensityField
    >>> card = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> found = equilibria(card, DensityField.squeeze(0.0, 1.0))
    >>> found, found.stable.round(9) + 0.0
    (Equilibria(2 stable, 2 saddles, along a line), array([[0.        , 0.        , 0.        ],
           [0.        , 0.        , 3.14159265]]))
    """
    as_instance("part", part, Part, remedy="make one of the outline: Part(outline)")
    if not hasattr(field, "load"):
        raise InputError(
            "field", "is no force field", value=field, remedy="such as DensityField.squeeze(0, 1)"
        )
    if not getattr(field, "has_potential", True):
        raise InputError(
            "field",
            "has no potential",
            remedy="for a skewed squeeze see skewed_equilibria; else simulate",
        )
    if not isinstance(field, ConvexField):
        return _from_many_starts(part, field, np.zeros((1, 2)), np.empty((0, 2)))
    if not field.convex:
        return _from_many_starts(part, field, field.centers, field.flat)
    return _from_reduced(part, field)


def _from_reduced(part: Part, field: ConvexField) -> Equilibria:
    reduced = ReducedPotential.of(part, field)
    if reduced is None:
        return _none(field, "pushed away: no position within ten thousand circumradii is at rest")
    rise = reduced.rise
    budget = min(200_000, _EFFORT // len(part.edges))
    changes = sign_changes(reduced.slope, _TURN, rise, noise=reduced.noise, budget=budget)
    if changes.zero:
        theta, index = np.zeros(1), np.zeros(1, dtype=np.int64)
        complete, note = rise == 0.0, "at rest in every orientation" + ", to rounding" * (rise > 0)
    else:
        theta = np.concatenate([changes.rising, changes.falling])
        index = np.repeat([0, 1], [len(changes.rising), len(changes.falling)])
        complete = changes.isolated
        note = "" if complete else "moments too small to prove that there are no others"
    order = np.argsort(theta)
    poses = np.column_stack([reduced.position(theta), theta])[order]
    return Equilibria(
        poses=poses,
        index=index[order],
        potentials=field.potential(part, poses),
        flat=field.flat,
        neutral=changes.zero,
        complete=complete,
        gaps=changes.gaps,
        note=note,
    )


def _none(field: ConvexField, note: str) -> Equilibria:
    return Equilibria(
        poses=np.empty((0, 3)),
        index=np.empty(0, dtype=np.int64),
        potentials=np.empty(0),
        flat=field.flat,
        neutral=False,
        complete=True,
        gaps=np.empty((0, 2)),
        note=note,
    )


def _from_many_starts(part: Part, field: LoadField, centers: Array, flat: Array) -> Equilibria:
    poses, index = stationary_poses(part, field, centers, flat)
    return Equilibria(
        poses=poses,
        index=index,
        potentials=field.potential(part, poses),
        flat=flat,
        neutral=False,
        complete=False,
        gaps=np.array([[0.0, _TURN]]),
        note="the potential is not known to be convex in position: there may be others",
    )
