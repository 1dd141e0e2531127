"""The limit surface of many contacts: their Minkowski sum, up to a million of them."""

from __future__ import annotations

from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm
from limitsurf.errors import InputError, SolveFailed
from limitsurf.kernels.aggregate import aggregate
from limitsurf.kernels.contact_sum import COLD
from limitsurf.kernels.moment_tree_build import MomentTree, build_moment_tree
from limitsurf.kernels.project_by_tree import project_by_tree
from limitsurf.kernels.project_loads import (
    BOUNDS,
    COUNTS,
    POINTS,
    STATUSES,
    WITNESSES,
    contact_forces,
    contact_numbers,
    project_loads,
)
from limitsurf.sets.arguments import (
    Metric,
    as_array,
    as_points,
    as_rows,
    check_effort,
    read_metric,
)
from limitsurf.sets.contact_projection import ContactProjection
from limitsurf.sets.convex_set import ConvexSet, Rows
from limitsurf.sets.projection import Projection, Status
from limitsurf.tolerances import CONTACT_SUM

__all__ = ["ContactSum"]

Array = NDArray[np.float64]

_MANY = 4096  # contacts from which a few stand for them in a first solve
_SIDE = 24  # cells a side that they are gathered in
_VERY_MANY, _SOLVES = 100_000, 20  # where a quadtree pays, and after how many loads
_ORDER = 16  # of its moments
_NOTHING_KNOWN = np.empty((0, 4))


class ContactSum(ConvexSet):
    r"""The set ``{center + sum G_i S_i f_i : |f_i| <= m_i}``, ``G f = (f_x, f_y, x f_y - y f_x)``.

    Parameters
    ----------
    position : (N, 2) float
        Contacts, from the reference point [m].
    radius : (N,) float
        Friction radii m_i >= 0 [N].
    center : (3,) float, optional
        A load added to the sum: that of the contacts' offsets [N, N, N m].
    stretch : (N, 3) float, optional
        Entries ``xx, xy, yy`` of symmetric S_i, for ellipses instead of disks.

    Notes
    -----
    N = 0 is the point `center`. Solved by Newton's method on the dual in the twist, whatever N:
    ``docs/contact_sum.md``.

    Examples
    --------
    >>> bar = ContactSum([[1.0, 0.0], [-1.0, 0.0]], [1.0, 1.0])
    >>> bar.support([0.0, 0.0, 1.0])
    array(2.)
    """

    def __init__(
        self,
        position: ArrayLike,
        radius: ArrayLike,
        center: ArrayLike | None = None,
        stretch: ArrayLike | None = None,
    ) -> None:
        places = as_array("position", position, None, 2, copy=False)
        m = as_array("radius", radius, len(places), copy=False)
        if m.min(initial=0.0) < 0.0:
            raise InputError("radius", "has negative entries", remedy="friction radii are >= 0")
        self._center = as_array("center", np.zeros(3) if center is None else center, 3)
        shape = np.empty((0, 3)) if stretch is None else stretch
        self._stretch = as_array("stretch", shape, 0 if stretch is None else len(places), 3)
        total = m.sum()
        self._centroid: Array = m @ places / total if total > 0.0 else np.zeros(2)
        self._data = np.empty((6 if len(self._stretch) else 3, len(places)))
        np.subtract(places.T, self._centroid[:, None], out=self._data[:2])
        self._data[2] = m
        self._radius: Array = self._data[2]
        self._radius.setflags(write=False)
        if len(self._stretch):
            self._data[3:] = self._stretch.T
        self._able, self._projected = len(self._data) == 3 and len(places) >= _MANY, 0

    @property
    def count(self) -> int:
        """Number of contacts."""
        return len(self._radius)

    @property
    def position(self) -> Array:
        """Contacts (N, 2), from the reference point."""
        places: Array = np.column_stack([self._data[0], self._data[1]]) + self._centroid
        return places

    @property
    def radius(self) -> Array:
        """Friction radii (N,)."""
        return self._radius

    @property
    def stretch(self) -> Array | None:
        """Entries (N, 3) of the stretches of ellipses, None for disks."""
        return self._stretch if len(self._stretch) else None

    @property
    def center(self) -> Array:
        """The load that is added to the sum."""
        return self._center

    @property
    def dim(self) -> int:
        """Dimension of load space, 3."""
        return 3

    @cached_property
    def _kernel_data(self) -> tuple[Array, Array, Array]:
        """Contacts, the few that stand for them, and numbers, as `project_loads` takes them."""
        few = np.empty((3, 0))
        if self.count >= _MANY and len(self._data) == 3 and self._data[2].any():
            few = np.stack(aggregate(self._data[0], self._data[1], self._data[2], _SIDE))
        numbers = contact_numbers(self._data, few)
        numbers[12:14], numbers[14:] = self._centroid, self._center
        return self._data, few, numbers

    @cached_property
    def _tree(self) -> tuple[Array, MomentTree]:
        """Contacts in the order of their quadtree, and its moments."""
        moments = build_moment_tree(self._data[0], self._data[1], self._data[2], _ORDER)
        return np.stack([moments.x, moments.y, moments.m]), moments

    def _by_tree(self, sublinear: bool | None, loads: int) -> bool:
        """Return whether to sum by moments, and count the loads."""
        if sublinear is None and not self._able:
            return False
        if sublinear and not self._able:
            raise InputError("sublinear", f"needs {_MANY} disks or more", value=sublinear)
        self._projected += loads
        pays = self.count >= _VERY_MANY and self._projected > _SOLVES
        return pays if sublinear is None else sublinear

    @cached_property
    def _loads(self) -> Array:
        """Loads (N, 2, 3) of the largest forces along the axes of S_i."""
        x, y, m = *self.position.T, self._radius
        a, b, d = (
            self._stretch.T if len(self._stretch) else (np.ones_like(x), 0 * x, np.ones_like(x))
        )
        first = np.column_stack([a, b, x * b - y * a])
        second = np.column_stack([b, d, x * d - y * b])
        return np.asarray(np.stack([first, second], axis=1) * m[:, None, None])

    def conic_form(self) -> ConicForm:
        """Return ``{center + sum P_i f_i : (1, f_i) in second-order cones}``."""
        n = self.count
        F = self._loads.reshape(2 * n, 3).T
        rows = (3 * np.arange(n)[:, None] + [1, 2]).ravel()
        A = sparse.csc_matrix((np.ones(2 * n), (rows, np.arange(2 * n))), (3 * n, 2 * n))
        b = np.tile([1.0, 0.0, 0.0], n)
        return ConicForm(F, self._center, A, b, tuple(Cone("second-order", 3) for _ in range(n)))

    def face(self, d: ArrayLike, tol: float = 1e-9) -> ConvexSet:
        """Return the face with outer normal d: the contacts that do not move may push anyhow."""
        direction = as_array("d", d, 3)
        u = self._loads @ direction
        speeds = np.linalg.norm(u, axis=1)
        still = speeds <= tol * np.linalg.norm(self._loads, axis=(1, 2)) * np.linalg.norm(direction)
        e = u[~still] / speeds[~still, None]
        tip = self._center + np.einsum("ij,ijk->k", e, self._loads[~still])
        stretch = self._stretch[still] if len(self._stretch) else None
        return ContactSum(self.position[still], self._radius[still], tip, stretch)

    def linear_image(self, matrix: Array, offset: Array) -> ContactSum | None:
        """Return the same contacts seen from another point or turned, if M says that; else None."""
        turn = matrix[:2, :2] if matrix.shape == (3, 3) else np.zeros((2, 2))
        rigid = np.allclose(turn @ turn.T, np.eye(2), rtol=0.0, atol=1e-14)
        if not rigid or matrix[:2, 2].any() or matrix[2, 2] != np.round(np.linalg.det(turn)):
            return None
        shift = matrix[2, 2] * np.array([matrix[2, 1], -matrix[2, 0]])  # in the old axes
        places = (self.position + shift) @ turn.T
        return ContactSum(places, self._radius, matrix @ self._center + offset, self._turned(turn))

    def _turned(self, turn: Array) -> Array | None:
        if not len(self._stretch):
            return None
        a, b, d = self._stretch.T
        S = turn @ np.array([[a, b], [b, d]]).transpose(2, 0, 1) @ turn.T
        return np.column_stack([S[:, 0, 0], S[:, 0, 1], S[:, 1, 1]])

    def _velocities(self, direction: Array) -> Array:
        """Return ``S_i G_i'd`` (N, 2)."""
        x, y = self._data[:2] + self._centroid[:, None]
        ux, uy = direction[0] - direction[2] * y, direction[1] + direction[2] * x
        if len(self._stretch):
            a, b, d = self._stretch.T
            ux, uy = a * ux + b * uy, b * ux + d * uy
        return np.column_stack([ux, uy])

    def _support_points(self, directions: Array) -> Array:
        points = np.empty((len(directions), 3))
        for point, d in zip(points, directions, strict=True):
            u = self._velocities(d)
            speed = np.hypot(u[:, 0], u[:, 1])
            speed[speed == 0.0] = np.inf
            point[:] = self._center + self._load_of(self._radius[:, None] * u / speed[:, None])
        return points

    def _supports(self, directions: Array) -> Array:
        reach = [self._radius @ np.hypot(*self._velocities(d).T) for d in directions]
        return np.asarray(directions @ self._center + reach)

    def _load_of(self, forces: Array) -> Array:
        """Return ``sum G_i S_i f_i``."""
        fx, fy = forces.T
        if len(self._stretch):
            a, b, d = self._stretch.T
            fx, fy = a * fx + b * fy, b * fx + d * fy
        x, y = self._data[:2] + self._centroid[:, None]
        return np.array([fx.sum(), fy.sum(), x @ fy - y @ fx])

    def project(
        self,
        p: ArrayLike,
        metric: ArrayLike | None = None,
        start: ArrayLike | Projection | None = None,
        *,
        throw: bool = True,
        tol: float | None = None,
        threads: int = 1,
        sublinear: bool | None = None,
    ) -> ContactProjection:
        """Return the closest points, twists and certified errors.

        Parameters
        ----------
        p : (..., 3) float
            Loads [N, N, N m].
        metric : (3, 3) or (3,) float, optional
            Symmetric positive definite W, or its diagonal; distance^2 is ``e' W e``.
        start : (..., 3) float or Projection, optional
            Twists, or the answer of a problem nearby, to start from.
        throw : bool
            Raise `SolveFailed` if an error bound is above 1e-6 of the size of the problem; False
            returns the best points, with `Status.FAILED`.
        tol : float
            Error bound asked for, relative to ``sum m_i + |p - center|`` in the norm of the metric;
            1e-12 if not given.
            Where rounding or the method leave more, the status is `Status.LOOSE`.
        threads : int
            Threads to use; more than one pays from about 1e5 contacts on.
        sublinear : bool, optional
            Sum by moments of a quadtree, in less than linear time, with their error in the bound.
            Building it takes as long as some 20 solves: None does that for 1e5 disks or more
            when that many loads have been projected.
        """
        points, shape = as_rows("p", p, 3)
        W = read_metric(metric, 3)
        tol = CONTACT_SUM if tol is None else tol
        check_effort(tol, threads)
        starts = _NOTHING_KNOWN if start is None else self._starts(start, len(points))
        if self._by_tree(sublinear, len(points)):
            data, moments = self._tree
            _, few, numbers = self._kernel_data
            answers, failed = project_by_tree(
                data, few, numbers, moments, points, W.C, starts, tol, threads
            )
            kink = answers[:, WITNESSES][:, 4]
            known = kink >= 0
            kink[known] = moments.permutation[kink[known].astype(np.int64)]
        else:
            answers, failed = project_loads(*self._kernel_data, points, W.C, starts, tol, threads)
        forces = partial(self.forces, metric=W)
        projection = ContactProjection(forces, self.count, points, answers, shape)
        if failed:
            as_points("p", p, 3)  # raises where entries are not finite
            if throw:
                raise SolveFailed(
                    f"project: {failed} of {len(points)} points {Status.FAILED!s}", best=projection
                )
        return projection

    def _starts(self, start: ArrayLike | Projection, k: int) -> Array:
        """Return rows ``v, eps`` about the centroid; eps = -1 where nothing is known."""
        known = start.twist if isinstance(start, Projection) else start
        twists, shape = as_points("start", known, 3)
        if len(twists) not in (1, k):
            raise InputError("start", f"has shape {(*shape, 3)}: one for each load, or one for all")
        if isinstance(start, ContactProjection):
            return np.array(np.broadcast_to(start.answers[:, WITNESSES][:, :4], (k, 4)))
        vx, vy, w = -np.broadcast_to(twists, (k, 3)).T
        cx, cy = self._centroid
        moving = np.where((vx != 0.0) | (vy != 0.0) | (w != 0.0), 0.0, COLD)
        return np.column_stack([vx - w * cy, vy + w * cx, w, moving])

    def forces(self, p: Array, witness: Array, metric: Metric) -> Array:
        """Return the forces (N, 2) of the answer with this witness to the load p."""
        f = contact_forces(*self._kernel_data, p, metric.C, witness, CONTACT_SUM)
        if len(self._stretch):
            a, b, d = self._stretch.T
            f = np.column_stack([a * f[:, 0] + b * f[:, 1], b * f[:, 0] + d * f[:, 1]])
        return f

    def _project(self, points: Array, metric: Metric) -> Rows:
        answers, _ = project_loads(
            *self._kernel_data, points, metric.C, _NOTHING_KNOWN, CONTACT_SUM, 1
        )
        return Rows(
            answers[:, POINTS],
            answers[:, BOUNDS],
            answers[:, COUNTS].astype(np.int64),
            answers[:, STATUSES].astype(np.int64),
        )

    def _distances(self, points: Array, metric: Metric) -> Array:
        return self._projected_distances(points, metric)

    def __repr__(self) -> str:
        """Return the number of contacts and their friction."""
        return f"ContactSum({self.count} contacts, {self._radius.sum():.4g} N of friction)"
