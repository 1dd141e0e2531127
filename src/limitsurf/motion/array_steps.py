"""A part on an activated array in implicit steps of the compiled kernel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.kernels.lattice import Lattice
from limitsurf.kernels.slide import FRAME, slide
from limitsurf.kernels.slide_step import TIME, Body, Ground, Pace
from limitsurf.sets.arguments import writable

__all__ = ["ArraySteps", "ground_of"]

Array = NDArray[np.float64]

_CALL_STEPS = 20_000  # a call of the kernel takes a second at most for ordinary parts


@dataclass(frozen=True, eq=False)
class ArraySteps:
    """A `Stepper` for rate-independent limit surfaces.

    Attributes
    ----------
    body, pace : Body, Pace
        What moves, in which steps.
    every : float
        Time between frames [s].
    """

    body: Body
    pace: Pace
    every: float

    def advance(
        self, activation: Activation, motion: Array, until: float, final: bool
    ) -> tuple[int, Array, bool]:
        """Move on an activation; see `Stepper`."""
        left = (until - motion[TIME]) / self.every
        frames = np.empty((int(min(left, _CALL_STEPS)) + 3, FRAME))
        status, written, over = slide(
            self.body,
            ground_of(activation),
            self.pace,
            motion,
            until,
            _CALL_STEPS,
            self.every,
            final,
            frames,
        )
        return status, frames[:written].copy(), over


def ground_of(activation: Activation) -> Ground:
    """Return what the kernel has to know of an activated array."""
    array, pixel = activation.array, activation.array.pixel
    return Ground(
        lattice=Lattice(
            *array.first_site,
            array.site_pitch,
            writable(activation.running),
            _directions(array),
            pixel.tip_width,
        ),
        push=pixel.friction * pixel.offset_fraction,
        grip=pixel.friction * pixel.residual_fraction,
        lift=pixel.vertical_force(array.voltage),
    )


@lru_cache(maxsize=8)
def _directions(array: ActuatorArray) -> Array:
    """Return the pushes of all sites; many motions share an array."""
    return writable(array.site_directions)
