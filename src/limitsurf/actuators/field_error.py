"""How far a realised field is from its ideal: mean direction, and force and moment on a part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from limitsurf.actuators.realised_field import RealisedField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part

__all__ = ["DirectionError", "LoadError", "direction_errors", "load_error"]

Array = NDArray[np.float64]

_ACROSS = 400  # points across a part of the integral of the ideal field


@dataclass(frozen=True)
class DirectionError:
    """Angles between the mean push of a neighbourhood and its ideal [rad]."""

    rms: float
    worst: float


@dataclass(frozen=True)
class LoadError:
    """Realised less ideal load on a part.

    Attributes
    ----------
    force : (float, float)
        Force over the force that the ideal field gives if all of it pushed one way.
    moment : float
        Moment about the part's centroid, over the same force times the radius of gyration.
    realised, ideal : (3,) float
        The loads ``(fx, fy, m)`` in the same units.
    """

    force: tuple[float, float]
    moment: float
    realised: Array
    ideal: Array


def direction_errors(realised: RealisedField, radius: float) -> DirectionError:
    """Return the errors of the mean direction in circles of a radius [m] about every pixel.

    Circles where the ideal field cancels itself to less than half, as on the line of a squeeze, and
    those that reach over the lattice's edge are left out.

    Examples
    --------
    >>> from limitsurf.actuators.force_fields import uniform_field
    >>> from limitsurf.actuators.pixel_lattice import PixelLattice, headings
    >>> from limitsurf.actuators.realised_field import realise
    >>> lattice = PixelLattice.rectangular(32, 32, 200e-6, headings(4))
    >>> errors = [direction_errors(realise(lattice, uniform_field(0.5), method), 1e-3)
    ...           for method in ("nearest", "dither")]
    >>> [f"{error.worst:.2f}" for error in errors]
    ['0.50', '0.08']
    """
    centers = realised.lattice.pixel_centers
    if not (np.isfinite(radius) and radius > 0.0):
        raise InputError("radius", "must be positive", value=radius)
    inner = np.all(np.abs(centers) <= centers.max(axis=0) - radius, axis=1)
    if not inner.any():
        raise InputError("radius", "no circle lies within the lattice", value=radius)
    near = cKDTree(centers)
    pairs = near.sparse_distance_matrix(near, radius * (1 + 1e-9), output_type="coo_matrix")
    push, ideal = realised.forces.sum(axis=1), realised.scale * realised.field(centers)
    sums = np.zeros((len(centers), 5))
    columns = np.column_stack([push, ideal, np.linalg.norm(ideal, axis=1)])
    np.add.at(sums, pairs.row, columns[pairs.col])
    found, wanted, size = sums[:, :2], sums[:, 2:4], sums[:, 4]
    used = inner & (np.linalg.norm(wanted, axis=1) > 0.5 * size)
    if not used.any():
        raise InputError("radius", "the field cancels in every circle", value=radius)
    sine = found[:, 0] * wanted[:, 1] - found[:, 1] * wanted[:, 0]
    angle = np.arctan2(sine, np.einsum("ni,ni->n", found, wanted))[used]
    return DirectionError(float(np.sqrt(np.mean(angle**2))), float(np.abs(angle).max()))


def load_error(realised: RealisedField, part: Part, pose: ArrayLike = (0.0, 0.0, 0.0)) -> LoadError:
    """Return the error of the load on a part: tips under it, against the integral of the field.

    Parameters
    ----------
    realised : RealisedField
        The field.
    part : Part
        The part.
    pose : (3,) float
        Pose of the part [m, m, rad].

    Examples
    --------
    >>> from limitsurf.actuators.force_fields import uniform_field
    >>> from limitsurf.actuators.pixel_lattice import PixelLattice, headings
    >>> from limitsurf.actuators.realised_field import realise
    >>> lattice = PixelLattice.rectangular(32, 32, 200e-6, headings(4))
    >>> error = load_error(realise(lattice, uniform_field(0.5)), Part.from_file("paper_t"))
    >>> abs(error.moment) < 0.05
    True
    """
    outline, lattice = part.at(pose), realised.lattice
    shapely.prepare(outline)
    middle = np.asarray(pose, np.float64)[:2]
    edge = lattice.pixel_centers.max(axis=0) + 0.5 * np.sqrt(lattice.pixel_area)
    if np.any(np.abs(np.reshape(outline.bounds, (2, 2))) > edge * (1 + 1e-9)):
        raise InputError("pose", "puts the part over the edge of the lattice", value=tuple(middle))
    spots, forces = lattice.positions.reshape(-1, 2), realised.forces.reshape(-1, 2)
    under = shapely.contains_xy(outline, spots[:, 0], spots[:, 1])
    points, area = _points_in(outline)
    density = realised.scale * realised.field(points) / lattice.pixel_area * area
    full = np.linalg.norm(density, axis=1).sum()
    if full == 0.0:
        raise InputError("field", "is zero under the part")
    gyration = float(np.sqrt(part.polar_moment / part.area))
    unit = np.array([full, full, full * gyration])
    found = _load(spots[under] - middle, forces[under]) / unit
    ideal = _load(points - middle, density) / unit
    error = found - ideal
    return LoadError((float(error[0]), float(error[1])), float(error[2]), found, ideal)


def _points_in(outline: shapely.Geometry) -> tuple[Array, float]:
    """Return midpoints of a fine square grid within an outline, and the area of each [m^2]."""
    x0, y0, x1, y1 = outline.bounds
    step = max(x1 - x0, y1 - y0) / _ACROSS
    x = x0 + step * (np.arange(int(np.ceil((x1 - x0) / step))) + 0.5)
    y = y0 + step * (np.arange(int(np.ceil((y1 - y0) / step))) + 0.5)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = points[shapely.contains_xy(outline, points[:, 0], points[:, 1])]
    return inside, outline.area / len(inside)


def _load(arm: Array, force: Array) -> Array:
    """Return the sum of forces at arms as a load (3,)."""
    moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    return np.array([*force.sum(axis=0), moment.sum()])
