"""A force density of constant size towards a point, and its exact loads on parts."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.actuators.density_piece import finite
from limitsurf.actuators.potential_field import ConvexField, FieldSum
from limitsurf.geometry.part import Part
from limitsurf.kernels.density import JACOBIAN, POTENTIAL, STATE
from limitsurf.kernels.radial_density import radial_states
from limitsurf.kernels.uniform_friction import UniformPatch, uniform_patch
from limitsurf.sets.arguments import as_array, as_points

__all__ = ["RadialField"]

Array = NDArray[np.float64]


class RadialField:
    r"""The force density ``-density (x - center) / |x - center|`` [N/m^2].

    Its potential on a part is ``density * integral |x - center| dA``. Loads have closed forms for
    every pose, also with the center on a corner, on an edge, or far away;
    ``kernels/radial_density.py`` states them. (K.-F. Boehringer, B. R. Donald, N. C. MacDonald,
    *Programmable force fields for distributed manipulation*, Int. J. Robotics Research 18, 1999.)

    Parameters
    ----------
    density : float
        Size of the push [N/m^2]; negative pushes outwards.
    center : (2,) float
        Where it pushes to [m].

    Examples
    --------
    A square far to the right of the center is pushed to the left with almost its whole area:

    >>> square = Part([(0, 0), (2, 0), (2, 2), (0, 2)])
    >>> radial = RadialField(1.0)
    >>> radial.load(square, (100.0, 0.0, 0.3)).round(3) + 0.0
    array([-4.,  0.,  0.])
    >>> float(radial.potential(square, (0.0, 0.0, 0.3)).round(6))
    3.060783
    """

    def __init__(self, density: float, center: ArrayLike = (0.0, 0.0)) -> None:
        self._density = finite("density", density)
        self._center = as_array("center", center, 2)

    @property
    def density(self) -> float:
        """Size of the push [N/m^2]."""
        return self._density

    @property
    def center(self) -> Array:
        """Where it pushes to [m]."""
        return self._center

    @property
    def has_potential(self) -> bool:
        """True: loads are minus the gradient of a potential."""
        return True

    @property
    def convex(self) -> bool:
        """Whether the potential is convex in the position: unless it pushes outwards."""
        return self._density >= 0.0

    @property
    def flat(self) -> Array:
        """No directions, (0, 2): the field changes in all of them, unless it is zero."""
        return np.eye(2) if self._density == 0.0 else np.empty((0, 2))

    @property
    def centers(self) -> Array:
        """The center, (1, 2) [m]."""
        return np.array(self._center[None])

    def turning_bound(self, part: Part, center: ArrayLike | None, reach: float) -> float:
        r"""Return a bound on the second derivative of the potential under turns about a point [J].

        Zero about the center itself. Elsewhere, with a the arm from the point,
        :math:`p \int ((a \cdot e)^2 / \rho - a \cdot e)\, dA`, and an area A sees at most
        :math:`\int dA / \rho = 2 \sqrt{\pi A}`. See `ConvexField`.
        """
        if center is not None and np.array_equal(as_array("center", center, 2), self._center):
            return 0.0
        arm = part.circumradius + (0.0 if center is None else reach)
        size = abs(self._density)
        return float(size * (2.0 * arm**2 * np.sqrt(np.pi * part.area) + arm * part.area))

    def scaled(self, factor: float) -> RadialField:
        """Return the field times a number."""
        return RadialField(finite("factor", factor) * self._density, self._center)

    def __call__(self, points: ArrayLike) -> Array:
        """Return densities (..., 2) at points (..., 2); zero at the center."""
        rows, shape = as_points("points", points, 2)
        arm = self._center - rows
        length = np.hypot(*arm.T)[:, None]
        unit = np.divide(arm, length, out=np.zeros_like(arm), where=length > 0.0)
        return np.asarray(self._density * unit.reshape(*shape, 2))

    def load(self, part: Part, pose: ArrayLike) -> Array:
        """Return loads (..., 3) on a part at poses (..., 3), about its centre of mass [N, N m]."""
        return self.states(part, pose)[..., :POTENTIAL]

    def jacobian(self, part: Part, pose: ArrayLike) -> Array:
        """Return the derivatives (..., 3, 3) of `load` with respect to the poses."""
        states = self.states(part, pose)
        return states[..., JACOBIAN:].reshape(*states.shape[:-1], 3, 3)

    def potential(self, part: Part, pose: ArrayLike) -> Array:
        """Return ``density * integral |x - center| dA`` (...) of a part at poses (..., 3) [J]."""
        return self.states(part, pose)[..., POTENTIAL]

    def states(self, part: Part, pose: ArrayLike) -> Array:
        """Return load, potential and Jacobian by rows, (..., 13), in one go."""
        poses, shape = as_points("pose", pose, 3)
        states = np.empty((len(poses), STATE))
        center = (float(self._center[0]), float(self._center[1]))
        radial_states(_patch(part), part.circumradius, center, self._density, poses, states)
        return states.reshape(*shape, STATE)

    def __add__(self, other: ConvexField) -> FieldSum:
        """Return the sum with another field."""
        return FieldSum(self, other)

    def __repr__(self) -> str:
        """Return density and center."""
        x, y = self._center
        return f"RadialField({self._density:.4g} N/m^2 towards ({x:.4g}, {y:.4g}) m)"


@lru_cache(maxsize=64)
def _patch(part: Part) -> UniformPatch:
    return uniform_patch(part.edges / part.circumradius)
