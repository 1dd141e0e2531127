r"""The ideal squeeze field as a drive: where it leaves a part, and on which path.

The field is the same everywhere along its line, so that two numbers say where the part is: the
offset z of the line from the centroid, along :math:`n = (-\sin\theta, \cos\theta)`, and the
orientation :math:`\phi = -\theta`, theta the direction of the line in the part's frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.squeeze_flow import MOVING, flow_trace, settle
from limitsurf.sets.arguments import as_number, as_numbers, writable

__all__ = ["STEP_ERROR", "IdealSqueeze", "SqueezePath", "as_mobility_ratio", "turning_mobility"]

Array = NDArray[np.float64]

STEP_ERROR = 1e-8  # of each step, in lengths and angles; it blurs the borders of the basins

_LEAST_RATIO, _LARGEST_RATIO = 1e-6, 1e6


@dataclass(frozen=True, eq=False)
class SqueezePath:
    """One motion in a squeeze field.

    Attributes
    ----------
    times : (m,) float
        Times, for a part that moves at one metre per second while it does not touch the line [s].
    offsets : (m,) float
        Offset of the line from the centroid [m].
    orientations : (m,) float
        Orientation, not reduced [rad].
    """

    times: Array
    offsets: Array
    orientations: Array


@dataclass(frozen=True)
class IdealSqueeze:
    r"""A unit force per area towards a line from both sides, on a part in a viscous film.

    .. math:: z' = -U_z / A, \qquad \theta' = -\rho\, U_\theta / I

    with U the potential of the field, A the area and I the polar second moment of the part.

    Parameters
    ----------
    mobility_ratio : float
        rho: how easily the part turns, compared to a uniform viscous film (1). With 0 it first
        moves onto its median and then turns, the assumption 2PHASE of the 1994 paper.

    Raises
    ------
    InputError
        A ratio that is neither 0 nor in [1e-6, 1e6].

    Examples
    --------
    A rectangle comes to rest along the line:

    >>> card = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> offset, phi = IdealSqueeze().rest(card, 0.3, [0.4, 1.5])
    >>> bool(abs(phi).max() < 1e-12)
    True
    """

    mobility_ratio: float = 1.0

    def __post_init__(self) -> None:
        """Check the ratio."""
        as_mobility_ratio(self.mobility_ratio)

    def rest(self, part: Part, offset: ArrayLike, phi: ArrayLike) -> tuple[Array, Array]:
        """Return where parts come to rest.

        Parameters
        ----------
        part : Part
            The part.
        offset : (...) float
            Offset of the line from the centroid at the start [m].
        phi : (...) float
            Orientation at the start, the line at world angle 0 [rad].

        Returns
        -------
        offset, phi : (...) float
            The same at rest; phi not reduced: it tells how far the part turned. A start on the
            border of two basins rests at an unstable orientation.

        Raises
        ------
        SolveFailed
            A motion did not come to rest; `best` holds the two arrays.
        """
        z, angle, status = self.settle(part, offset, phi)
        if (status == MOVING).any():
            raise SolveFailed(f"{int((status == MOVING).sum())} motions did not rest", (z, angle))
        return z, angle

    def settle(
        self, part: Part, offset: ArrayLike, phi: ArrayLike, step_error: float = STEP_ERROR
    ) -> tuple[Array, Array, NDArray[np.int32]]:
        """Return what `rest` does, and how each motion ended, without an error.

        `STABLE` in a strict minimum of the potential, `FLAT` where no force is left, or `MOVING`.
        `step_error` [rad], for lengths relative to the side of a square of the part's area, blurs
        the borders of the basins; where a motion ends is exact.
        """
        z, angle = as_numbers("offset", offset), as_numbers("phi", phi)
        try:
            z, angle = np.broadcast_arrays(z, angle)
        except ValueError as error:
            problem = f"have shapes {z.shape} and {angle.shape}, which do not fit"
            raise InputError("offset, phi", problem) from error
        unit = part.area**0.5
        starts = np.column_stack([z.ravel() / unit, -angle.ravel()])
        edges, kappa = writable(part.unit_edges), turning_mobility(part, self.mobility_ratio)
        ends, status = settle(edges, kappa, starts, step_error)
        return (
            (unit * ends[:, 0]).reshape(z.shape),
            -ends[:, 1].reshape(z.shape),
            status.reshape(z.shape),
        )

    def path(self, part: Part, offset: float, phi: float) -> SqueezePath:
        """Return the motion from one start to rest; see `rest`.

        With a mobility ratio of 0 it begins on the median, and its times have no scale.
        """
        unit = part.area**0.5
        start = np.array([as_number("offset", offset) / unit, -as_number("phi", phi)])
        if not np.isfinite(start).all():
            raise InputError("offset, phi", "must be finite")
        edges, kappa = writable(part.unit_edges), turning_mobility(part, self.mobility_ratio)
        rows, status = flow_trace(edges, kappa, 1.0, start, STEP_ERROR)
        path = SqueezePath(unit * rows[:, 0], unit * rows[:, 1], -rows[:, 2])
        if status == MOVING:
            raise SolveFailed("the motion did not come to rest", path)
        return path


def as_mobility_ratio(value: float) -> float:
    """Return a mobility ratio, or raise InputError."""
    ratio = as_number("mobility_ratio", value)
    if ratio != 0.0 and not _LEAST_RATIO <= ratio <= _LARGEST_RATIO:
        raise InputError(
            "mobility_ratio",
            f"must be 0 or lie in [{_LEAST_RATIO:g}, {_LARGEST_RATIO:g}]",
            value=value,
            remedy="use 1 for a uniform viscous film",
        )
    return ratio


def turning_mobility(part: Part, mobility_ratio: float) -> float:
    """Return ``rho / I`` of the part scaled to area 1."""
    return mobility_ratio * part.area**2 / part.polar_moment
