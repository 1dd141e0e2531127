"""The record of a projection on a sum of contacts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.project_loads import (
    BOUNDS,
    COUNTS,
    DISTANCES,
    NORMALS,
    POINTS,
    STATUSES,
    TWISTS,
    WITNESSES,
)
from limitsurf.sets.projection import Projection

__all__ = ["ContactProjection"]

Array = NDArray[np.float64]


class ContactProjection(Projection):
    """Closest points of a sum of contacts, as `Projection`, and the forces of the contacts.

    The twist is exactly zero for loads inside, and more precise than ``W (point - p)`` where
    these nearly agree.
    """

    count: int
    load: Array
    answers: Array
    shape: tuple[int, ...]
    _forces: Callable[[Array, Array], Array]

    def __init__(
        self,
        forces: Callable[[Array, Array], Array],
        count: int,
        load: Array,
        answers: Array,
        shape: tuple[int, ...],
    ) -> None:
        self.__dict__.update(_forces=forces, count=count, load=load, answers=answers, shape=shape)

    def _vectors(self, columns: slice) -> Array:
        return self.answers[:, columns].reshape(*self.shape, columns.stop - columns.start)

    # a view of the kernel's answers: nothing is copied before it is asked for
    point = property(lambda self: self._vectors(POINTS))
    normal = property(lambda self: self._vectors(NORMALS))
    twist = property(lambda self: self._vectors(TWISTS))
    witness = property(lambda self: self._vectors(WITNESSES))
    distance = property(lambda self: self.answers[:, DISTANCES].reshape(self.shape))
    error_bound = property(lambda self: self.answers[:, BOUNDS].reshape(self.shape))
    iterations = property(lambda self: self.answers[:, COUNTS].astype(np.int64).reshape(self.shape))
    status = property(lambda self: self.answers[:, STATUSES].astype(np.int64).reshape(self.shape))

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether the loads are held, also where the certificate is loose."""
        return np.asarray(~self.twist.any(axis=-1))

    def with_pushes(self, pushes: Array) -> ContactProjection:
        """Return the same answers, with mean pushes (N, 2) added to the forces."""

        def forces(p: Array, witness: Array) -> Array:
            return self._forces(p, witness) + pushes

        return ContactProjection(forces, self.count, self.load, self.answers, self.shape)

    def contact_forces(self) -> Array:
        """Return the forces (..., N, 2) of the contacts on the part.

        Of a `ContactSet` with its pushes: their loads add up to `point`. Of a `ContactSum` friction
        alone: their loads and the center do.
        """
        rows = zip(self.load, self.answers[:, WITNESSES], strict=True)
        forces = np.array([self._forces(p, witness) for p, witness in rows])
        return forces.reshape(*self.shape, self.count, 2)
