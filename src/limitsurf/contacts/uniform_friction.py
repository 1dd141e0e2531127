"""Coulomb friction of uniform traction under a polygon, exactly."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.constants import g

from limitsurf.conic.form import ConicForm
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.pressure_patch import PatchError, PressurePatch
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.kernels.project_uniform import ANSWER, BOUND, COUNT, STATUS, project_uniform_many
from limitsurf.kernels.uniform_friction import UniformPatch, power_many, uniform_patch
from limitsurf.sets.arguments import Metric, as_array, as_number, as_points
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.tolerances import CONTACT_SUM

__all__ = ["UniformFriction"]

Array = NDArray[np.float64]


class UniformFriction(ConvexSet):
    r"""Loads of uniform friction: ``h(v) = traction * integral |v_t + omega x r| dA``.

    The integral over the polygon, its gradient and Hessian have closed forms for every twist;
    ``kernels/uniform_friction.py`` states them, and where a series replaces them. Strictly convex
    and symmetric about 0.

    Parameters
    ----------
    outline : Part, (n, 2) float, or shapely Polygon or MultiPolygon
        What rubs, holes and pieces included: a part about its centre of mass, an outline about the
        origin of its coordinates [m].
    traction : float
        Friction per area ``mu p`` [N/m^2], positive.

    Examples
    --------
    The spin torque of a square of side 2 and of unit traction:

    >>> square = UniformFriction([[-1, -1], [1, -1], [1, 1], [-1, 1]], 1.0)
    >>> torque = square.support([0.0, 0.0, 1.0])
    >>> abs(torque - 4 / 3 * (np.sqrt(2) + np.arcsinh(1.0))) < 1e-14
    np.True_
    >>> square.project([5.0, 0.0, 0.0]).point.round(12) + 0.0
    array([4., 0., 0.])
    """

    def __init__(self, outline: Part | ArrayLike | shapely.Geometry, traction: float) -> None:
        self._traction = as_number("traction", traction)
        if not (np.isfinite(self._traction) and self._traction > 0.0):
            raise InputError("traction", "must be positive", value=traction)
        self._part = outline if isinstance(outline, Part) else Part(outline)
        self._center = np.zeros(2) if isinstance(outline, Part) else np.array(self._part.centroid)

    @classmethod
    def under_weight(cls, part: Part, mu: float) -> UniformFriction:
        """Return the friction of a part that lies flat: traction ``mu * areal density * g``."""
        return cls(part, as_number("mu", mu) * part.mass / part.area * g)

    @property
    def part(self) -> Part:
        """The polygon, as a part."""
        return self._part

    @property
    def traction(self) -> float:
        """Friction per area [N/m^2]."""
        return self._traction

    @property
    def dim(self) -> int:
        """Dimension of load space, 3."""
        return 3

    @cached_property
    def patch(self) -> UniformPatch:
        """What kernels take: the polygon in circumradii."""
        return uniform_patch(self._part.edges / self._part.circumradius)

    @cached_property
    def unit(self) -> float:
        """Force [N] that is 1 in the kernels: the traction on the square of the circumradius."""
        return self._traction * self._part.circumradius**2

    @cached_property
    def load_of_unit(self) -> Array:
        """Map (3, 3) from the loads of the kernels to those about the reference point [N, N m]."""
        x, y = self._center
        transport = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-y, x, 1.0]])
        return np.asarray(self.unit * transport * [1.0, 1.0, self._part.circumradius])

    def _sums(self, directions: Array) -> tuple[Array, Array]:
        """Return the rows of `power_sums`, of directions scaled to size 1, and their sizes."""
        twists = directions @ self.load_of_unit
        size = np.abs(twists).max(axis=1, initial=0.0)
        size[size == 0.0] = 1.0
        out = np.empty((len(twists), 11))
        power_many(self.patch, np.ascontiguousarray(twists / size[:, None]), out)
        return out, size

    def _support_points(self, directions: Array) -> Array:
        sums, _ = self._sums(directions)
        return np.asarray(sums[:, 1:4] @ self.load_of_unit.T)

    def _supports(self, directions: Array) -> Array:
        sums, size = self._sums(directions)
        return sums[:, 0] * size

    def hessian(self, d: ArrayLike) -> Array:
        """Return the second derivatives (..., 3, 3) of the support function at d, (..., 3).

        Positive semidefinite, singular along d; they grow as ``1/|d|``. Not defined at 0.
        """
        directions, shape = as_points("d", d, 3)
        if not directions.any(axis=1).all():
            raise InputError("d", "is zero: there the support function has a kink")
        sums, size = self._sums(directions)
        xx, xy, yy, xw, yw, ww = sums[:, 4:10].T
        H = np.array([[xx, xy, xw], [xy, yy, yw], [xw, yw, ww]]).transpose(2, 0, 1)
        B = self.load_of_unit
        return np.asarray((B @ H @ B.T / size[:, None, None]).reshape(*shape, 3, 3))

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d: a point, as the set is strictly convex."""
        del tol
        direction = as_array("d", d, 3)
        if not direction.any():
            return self
        return Ellipsoid(self._support_points(direction[None])[0], np.empty((3, 0)))

    def _project(self, points: Array, metric: Metric) -> Rows:
        B = self.load_of_unit
        C = np.ascontiguousarray(metric.C @ B)
        loads = np.ascontiguousarray(np.linalg.solve(B, points.T).T)
        answers = np.empty((len(points), ANSWER))
        project_uniform_many(self.patch, loads, C, CONTACT_SUM, answers)
        status = answers[:, STATUS].astype(np.int64)
        closest = np.where((status == 1)[:, None], points, answers[:, :3] @ B.T)
        return Rows(closest, answers[:, BOUND], answers[:, COUNT].astype(np.int64), status)

    def _distances(self, points: Array, metric: Metric) -> Array:
        return self._projected_distances(points, metric)

    def contact_set(self, size: float | None = None) -> tuple[ContactSet, PatchError]:
        """Return contacts that stand for the patch, and the error: `PressurePatch.contact_set`."""
        shift = self._center - self._part.centroid
        polygon = shapely.transform(self._part.polygon, lambda points: points + shift)
        patch = PressurePatch.uniform(polygon, self._traction * self._part.area, 1.0)
        return patch.contact_set(size)

    def conic_form(self) -> ConicForm:
        """Return a form of the contacts of `contact_set`, to its stated error.

        The support function holds logarithms: no product of the cones at hand describes the set.
        """
        return self.contact_set()[0].limit_surface().conic_form()

    def __repr__(self) -> str:
        """Return traction and area."""
        return f"UniformFriction({self._traction:.4g} Pa, {self._part.area:.4g} m^2)"
