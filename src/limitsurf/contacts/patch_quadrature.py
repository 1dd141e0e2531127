"""Quadrature over patches: polygons cut into triangles, disks into rings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.special import roots_sh_jacobi

from limitsurf.errors import InputError

__all__ = ["Nodes", "hertz_nodes", "polygon_nodes"]

Array = NDArray[np.float64]

_MOST_NODES = 4_000_000

#: Barycentric coordinates (k, 3) and weights of Gauss rules with all nodes inside, and the degree
#: up to which they are exact: the medians' rule, and Radon's (1948).
_A, _B = (6.0 - np.sqrt(15.0)) / 21.0, (6.0 + np.sqrt(15.0)) / 21.0
_THREE = (np.full((3, 3), 1 / 6) + 0.5 * np.eye(3), np.full(3, 1 / 3))
_SEVEN = (
    np.vstack(
        [
            np.full((1, 3), 1 / 3),
            *(np.full((3, 3), c) + (1.0 - 3.0 * c) * np.eye(3) for c in (_A, _B)),
        ]
    ),
    np.concatenate(
        [[9 / 40], np.full(3, (155 - np.sqrt(15)) / 1200), np.full(3, (155 + np.sqrt(15)) / 1200)]
    ),
)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Points of a patch (k, 2), their weights (k,), and the size of the cells they stand for (k,).

    The measure of each cell can be moved to its points without going farther than the size.
    """

    position: Array
    weight: Array
    size: Array


def polygon_nodes(polygon: shapely.Geometry, size: float, *, coarse: bool = False) -> Nodes:
    """Return nodes over a polygon, holes and pieces included, that integrate area.

    Exact for polynomials of degree 5 (`coarse`: 2). Triangles of a constrained Delaunay
    triangulation are cut evenly until their sides are no longer than `size`.
    """
    corners = _triangles(polygon)
    sides = corners - np.roll(corners, 1, axis=1)
    longest = np.hypot(sides[..., 0], sides[..., 1]).max(axis=1)
    parts = np.maximum(np.ceil(longest / size * (1.0 - 1e-12)), 1.0)
    points, weights = _SEVEN if not coarse else _THREE
    if float((parts**2).sum()) * len(weights) > _MOST_NODES:
        raise InputError("size", "is too small for the patch", value=size, remedy="check units")
    position, weight, reach = [], [], []
    for k in np.unique(parts):
        same = parts == k
        small = _cut(corners[same], int(k))
        area = 0.5 * np.abs(_cross(small[:, 1] - small[:, 0], small[:, 2] - small[:, 0]))
        position.append(np.einsum("kc,tcd->tkd", points, small).reshape(-1, 2))
        weight.append(np.outer(area, weights).ravel())
        reach.append(np.repeat(longest[same] / k, int(k) ** 2 * len(weights)))
    return Nodes(np.vstack(position), np.concatenate(weight), np.concatenate(reach))


def hertz_nodes(radius: float, size: float, *, coarse: bool = False) -> Nodes:
    """Return nodes over a disk about 0 that integrate the Hertz pressure ``sqrt(1 - (r/a)^2)``.

    Weights add up to 1. With ``s = 1 - (r/a)^2`` the load between two radii is an integral of
    ``sqrt(s) ds``: Gauss-Jacobi in s, equal steps in angle.
    """
    rings = max(int(np.ceil(radius / size)), 2)
    rings = rings if not coarse else (rings + 1) // 2
    if 7.0 * rings * rings > _MOST_NODES:
        raise InputError("size", "is too small for the patch", value=size, remedy="check units")
    spokes = 2 * int(np.ceil(np.pi * rings))
    s, load = roots_sh_jacobi(rings, 1.5, 1.5)
    load = load / load.sum()
    # nodes lie in the shares of the load that they carry (Chebyshev, Markov, Stieltjes)
    rim = radius * np.sqrt(np.maximum(1.0 - np.append(0.0, np.cumsum(load)) ** (2 / 3), 0.0))
    r = radius * np.sqrt(1.0 - s)
    turn = 2.0 * np.pi * (np.arange(spokes) + 0.5 * (np.arange(rings)[:, None] % 2)) / spokes
    position = r[:, None, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    reach = rim[:-1] - rim[1:] + rim[:-1] * np.pi / spokes
    return Nodes(
        position.reshape(-1, 2), np.repeat(load / spokes, spokes), np.repeat(reach, spokes)
    )


def _triangles(polygon: shapely.Geometry) -> Array:
    """Return triangles (t, 3, 2) that make up a polygon."""
    found = shapely.constrained_delaunay_triangles(polygon)
    rings = shapely.get_coordinates(shapely.get_parts(found))
    return np.asarray(rings.reshape(-1, 4, 2)[:, :3])


def _cut(corners: Array, k: int) -> Array:
    """Return the k^2 similar triangles of each triangle."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(k), np.arange(k), indexing="ij"))
    up = i + j < k
    down = i + j < k - 1
    i, j = np.concatenate([i[up], i[down] + 1]), np.concatenate([j[up], j[down] + 1])
    turn = np.concatenate([np.ones(up.sum()), -np.ones(down.sum())])
    first, second = (corners[:, [c]] - corners[:, [0]] for c in (1, 2))
    at = np.stack([i, j], axis=-1)
    steps = [np.zeros_like(at), turn[:, None] * [1, 0], turn[:, None] * [0, 1]]
    places = [(at + step) / k for step in steps]
    made = [corners[:, [0]] + p[:, :1] * first + p[:, 1:] * second for p in places]
    return np.stack(made, axis=2).reshape(-1, 3, 2)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
