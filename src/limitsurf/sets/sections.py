"""Sections of sets of loads by planes, and limit curves: sections at M = 0."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.flat_outline import hull_outline
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["Section", "limit_curve", "section"]

Array = NDArray[np.float64]

_TOUCH = 1e-12  # relative to the size of the set: planes closer than this to a face touch it
_HALVINGS = 60
_FIRST, _ROUNDS, _CLOSEST = 8, 16, 1e-7  # tangents, and the least angle between them


@dataclass(frozen=True, eq=False)
class Section:
    """What a plane cuts out of a set in three dimensions.

    Attributes
    ----------
    outline : shapely geometry
        In the plane's coordinates (s, t): a Polygon, a LineString, a Point, or an empty Polygon;
        all of it lies in the set.
    error : float
        Largest distance of a point of the true section from it; 0 (rounding) for polytopes.
    origin, axes : (3,) and (2, 3) float
        The point (s, t) is ``origin + s axes[0] + t axes[1]``.
    """

    outline: shapely.Geometry
    error: float
    origin: Array
    axes: Array

    def in_space(self) -> Array:
        """Return the corners of the outline in three dimensions (k, 3)."""
        return np.asarray(self.origin + shapely.get_coordinates(self.outline) @ self.axes)

    def __repr__(self) -> str:
        """Return the kind of outline, its corners and the error."""
        if shapely.is_empty(self.outline):
            return "Section(empty)"
        corners = len(np.unique(shapely.get_coordinates(self.outline), axis=0))
        return f"Section({self.outline.geom_type}, {corners} corners, error {self.error:.1e})"


def limit_curve(surface: ConvexSet, *, tol: float = 1e-4) -> Section:
    """Return the loads (fx, fy) of a limit surface with M = 0 (paper, Figure 6) [N].

    Examples
    --------
    >>> from limitsurf.contacts.contact_set import ContactSet
    >>> bar = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.5)
    >>> curve = limit_curve(bar.limit_surface())  # a disk of radius 1
    >>> round(curve.outline.area, 3), curve.error < 2e-4
    (3.141, True)
    """
    return section(surface, [0.0, 0.0, 1.0], axes=[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], tol=tol)


def section(
    surface: ConvexSet,
    normal: ArrayLike,
    offset: float = 0.0,
    *,
    axes: ArrayLike | None = None,
    tol: float = 1e-4,
) -> Section:
    """Return the section of a set by the plane ``normal . x = offset``.

    Parameters
    ----------
    surface : ConvexSet
        A set in three dimensions.
    normal, offset : (3,) float, float
        The plane.
    axes : (2, 3) float, optional
        Orthonormal directions within the plane; chosen if left out.
    tol : float
        Error asked for, relative to the size of the section; polytopes are cut exactly.

    Notes
    -----
    A set that is no polytope is held between tangents and points. For each tangent the set's
    support point is turned across the plane by bisection; the segment between its last two places
    crosses the plane in a point of the section. The error is the largest distance between the two
    polygons.

    Examples
    --------
    >>> cube = VPolytope([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    >>> round(section(cube, [1.0, 1.0, 1.0], 1.5).outline.area, 6)
    1.299038
    >>> section(cube, [0.0, 0.0, 1.0], 1.5)
    Section(empty)
    """
    if surface.dim != 3:
        raise InputError("surface", f"has dimension {surface.dim}", remedy="sections need 3")
    if not 1e-10 <= tol < 1.0:
        raise InputError("tol", "must lie between 1e-10 and 1", value=tol)
    n = as_array("normal", normal, 3)
    length = float(np.linalg.norm(n))
    if length == 0.0:
        raise InputError("normal", "is zero", remedy="give a direction")
    n, c = n / length, float(as_array("offset", offset)) / length
    B = _axes(n) if axes is None else _checked(as_array("axes", axes, 2, 3), n)
    if isinstance(same := surface.by_vertices(), VPolytope):
        points, error, size = _cut_edges(same, n, c)
    else:
        points, error, size = _cut_tangents(surface, n, c, B, tol)
    return Section(hull_outline(points @ B.T, _TOUCH * size), error, c * n, B)


def _axes(n: Array) -> Array:
    """Return orthonormal axes (2, 3) of the plane, right-handed with n."""
    first = np.eye(3)[int(np.argmin(np.abs(n)))]
    s = first - (first @ n) * n
    s /= np.linalg.norm(s)
    return np.stack([s, np.cross(n, s)])


def _checked(axes: Array, n: Array) -> Array:
    frame = np.vstack([axes, n])
    if np.abs(frame @ frame.T - np.eye(3)).max() > 1e-9:
        raise InputError("axes", "are not orthonormal within the plane", remedy="leave them out")
    return axes


def _cut_edges(polytope: VPolytope, n: Array, c: float) -> tuple[Array, float, float]:
    """Return the corners of the section of a polytope, exact to rounding."""
    V = polytope.vertices
    size = max(float(np.ptp(V, axis=0).max()), float(np.abs(V).max()) * 1e-3, 1e-300)
    height = V @ n - c
    height[np.abs(height) <= _TOUCH * size] = 0.0
    below, above = _crossing(polytope, height)
    share = height[below] / (height[below] - height[above])
    crossed = V[below] + share[:, None] * (V[above] - V[below])
    return np.vstack([V[height == 0.0], crossed]), 0.0, size


def _crossing(polytope: VPolytope, height: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the lower and upper ends of edges through the plane; of flat ones, all pairs."""
    if len(polytope.triangles) == 0:
        below, above = np.meshgrid(
            np.flatnonzero(height < 0.0), np.flatnonzero(height > 0.0), indexing="ij"
        )
        return below.ravel(), above.ravel()
    edges = polytope.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = edges[(height[edges[:, 0]] < 0.0) & (height[edges[:, 1]] > 0.0)]
    return edges[:, 0], edges[:, 1]


def _cut_tangents(
    surface: ConvexSet, n: Array, c: float, B: Array, tol: float
) -> tuple[Array, float, float]:
    """Return points of the section, the error of their hull, and the size of the set."""
    up, down = surface.support(np.stack([n, -n]))
    ends = surface.support(np.vstack([np.eye(3), -np.eye(3)]))
    size = max(float((ends[:3] + ends[3:]).max()), float(np.abs(ends).max()) * 1e-3, 1e-300)
    if c > up + _TOUCH * size or -c > down + _TOUCH * size:
        return np.empty((0, 3)), 0.0, size

    if min(up - c, c + down) <= _TOUCH * size:
        face = surface.face(n if up - c <= c + down else -n)

        def touch(d: Array) -> tuple[Array, Array]:
            return face.support_point(d @ B), face.support(d @ B)
    else:

        def touch(d: Array) -> tuple[Array, Array]:
            return _turned_across(surface, n, c, d @ B)

    points, error = _sandwiched(touch, B, tol, size)
    return points, error, size


def _sandwiched(
    touch: Callable[[Array], tuple[Array, Array]], B: Array, tol: float, size: float
) -> tuple[Array, float]:
    """Return points of the section, with tangents so dense that the gap between them is small.

    Where it is not, the next tangent is parallel to the chord (Rote, Computing 48, 1992): sides and
    corners are then found exactly.
    """
    angle = 2.0 * np.pi * np.arange(_FIRST) / _FIRST
    points, bound = touch(_circle(angle))
    goal = max(tol * float(np.ptp(points, axis=0).max()), _TOUCH * size)
    for _ in range(_ROUNDS):
        flat = points @ B.T
        gap = _gaps(flat, _circle(angle), bound)
        after = np.append(angle[1:], angle[0] + 2.0 * np.pi)
        at = np.flatnonzero((gap > goal) & (after - angle > _CLOSEST))
        if len(at) == 0:
            break
        chord = np.roll(flat, -1, axis=0)[at] - flat[at]
        turn = np.arctan2(-chord[:, 0], chord[:, 1]) - angle[at]
        turn = np.mod(turn, 2.0 * np.pi)
        width = after[at] - angle[at]
        new = angle[at] + np.where((turn > 0.0) & (turn < width), turn, 0.5 * width)
        more, tangents = touch(_circle(new))
        angle = np.insert(angle, at + 1, new)
        points, bound = np.insert(points, at + 1, more, axis=0), np.insert(bound, at + 1, tangents)
    return points, float(_gaps(points @ B.T, _circle(angle), bound).max())


def _circle(angle: Array) -> Array:
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _turned_across(surface: ConvexSet, n: Array, c: float, D: Array) -> tuple[Array, Array]:
    """Return, for directions D in the plane, points of the section and bounds on its support.

    The support point along ``cos(a) D + sin(a) n`` rises with a. The bounds are
    ``D.x + tan(a) (n.x - c)`` for a support point x at any angle a.
    """
    low, high = np.full(len(D), -0.5 * np.pi), np.full(len(D), 0.5 * np.pi)
    x_low, x_high = (np.tile(surface.support_point(m), (len(D), 1)) for m in (-n, n))
    bound = np.full(len(D), np.inf)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        x = surface.support_point(np.cos(middle)[:, None] * D + np.sin(middle)[:, None] * n)
        height = x @ n - c
        bound = np.minimum(bound, (D * x).sum(axis=1) + np.tan(middle) * height)
        above = height > 0.0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
        x_low = np.where(above[:, None], x_low, x)
        x_high = np.where(above[:, None], x, x_high)
    under, over = x_low @ n - c, x_high @ n - c
    share = under / (under - over)
    return x_low + share[:, None] * (x_high - x_low), bound


def _gaps(points: Array, d: Array, bound: Array) -> Array:
    """Return how far the corners between neighbouring tangents are from the points' hull."""
    after, beyond = np.roll(d, -1, axis=0), np.roll(bound, -1)
    area = d[:, 0] * after[:, 1] - d[:, 1] * after[:, 0]
    x = (bound * after[:, 1] - beyond * d[:, 1]) / area
    y = (beyond * d[:, 0] - bound * after[:, 0]) / area
    hull = shapely.convex_hull(shapely.multipoints(points))
    return np.asarray(shapely.distance(hull, shapely.points(x, y)))
