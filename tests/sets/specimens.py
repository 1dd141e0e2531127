"""One list of sets, of every kind and degeneracy, that many tests run over."""

import numpy as np

from limitsurf.sets.contact_sum import ContactSum
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.h_polytope import HPolytope
from limitsurf.sets.linear_image import LinearImage, transport
from limitsurf.sets.minkowski_sum import MinkowskiSum
from limitsurf.sets.polynomial_set import PolynomialSet
from limitsurf.sets.v_polytope import VPolytope
from limitsurf.sets.zonotope import Zonotope


def contact(x, y, radius=1.0):
    """Return the disk of loads of a Coulomb contact at (x, y)."""
    return Ellipsoid(np.zeros(3), radius * np.array([[1, 0], [0, 1], [-y, x]]))


def polygon_contact(x, y, sides=8, radius=1.0):
    """Return the load polygon of a contact with a regular polygon instead of the disk."""
    angles = 2 * np.pi * np.arange(sides) / sides
    forces = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return VPolytope(np.column_stack([forces, x * forces[:, 1] - y * forces[:, 0]]))


def box(*half, center=(0.0, 0.0, 0.0)):
    """Return a box by its facets."""
    A = np.vstack([np.eye(3), -np.eye(3)])
    return HPolytope(A, np.tile(half, 2) + A @ np.array(center))


_rng = np.random.default_rng(7)
_cloud = _rng.normal(size=(30, 3))
_turn = np.linalg.qr(_rng.normal(size=(3, 3)))[0]

SPECIMENS = {
    "point": Ellipsoid([1.0, -2.0, 0.5], np.empty((3, 0))),
    "segment": Ellipsoid([0.0, 1.0, 0.0], [[1.0], [2.0], [-1.0]]),
    "one contact": contact(0.5, -1.0),
    "ball": Ellipsoid([0.3, 0.0, -0.2], np.eye(3)),
    "ellipsoid": Ellipsoid([0.1, 0.2, 0.3], _turn * np.array([2.0, 0.5, 0.1])),
    "thin ellipsoid": Ellipsoid([0.0, 0.0, 0.0], _turn * np.array([1.0, 1e-3, 1e-6])),
    "redundant axes": Ellipsoid([0.0, 0.0, 0.0], _rng.normal(size=(3, 5))),
    "far ellipsoid": Ellipsoid([1e3, -1e3, 5e2], _turn * np.array([2.0, 0.5, 0.1])),
    "ellipse": Ellipsoid([0.5, 0.0], [[2.0, 0.3], [0.0, 0.7]]),
    "vertex point": VPolytope([[1.0, 2.0, 3.0]]),
    "vertex segment": VPolytope([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.5, 1.0, 1.5]]),
    "polygon contact": polygon_contact(0.5, -1.0),
    "hull": VPolytope(_cloud),
    "sliver": VPolytope(_cloud * np.array([1.0, 1.0, 1e-6])),
    "far hull": VPolytope(_cloud + np.array([1e3, 0.0, -1e3])),
    "plane hull": VPolytope(_cloud[:, :2]),
    "interval": VPolytope([[1.0], [3.0]]),
    "box": box(1.0, 2.0, 0.5),
    "flat box": box(1.0, 2.0, 0.0, center=(0.0, 0.0, 0.3)),
    "wedge of nearly parallel facets": HPolytope(
        [[0, 0, 1], [0, 1e-4, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, -1]],
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    ),
    "plane facets": HPolytope([[1, 0], [0, 1], [-1, -1]], [1.0, 1.0, 1.0]),
    "zonotope": Zonotope([0.1, 0.0, 0.0], _rng.normal(size=(6, 3))),
    "flat zonotope": Zonotope([0.0, 0.0, 0.0], [[1, 0, 0], [0, 1, 0], [1, 1, 0]]),
    "no generators": Zonotope([1.0, 2.0, 3.0], np.empty((0, 3))),
    "bar": MinkowskiSum(contact(1.0, 0.0), contact(-1.0, 0.0)),
    "collinear contacts": MinkowskiSum(*[contact(float(k), 0.0, 0.5) for k in range(4)]),
    "polygonal bar": MinkowskiSum(polygon_contact(1.0, 0.0), polygon_contact(-1.0, 0.0)),
    "sum of polytopes": MinkowskiSum(VPolytope(_cloud), box(0.5, 0.5, 0.5)),
    "disk and box": MinkowskiSum(contact(0.0, 1.0), box(0.5, 0.1, 0.2)),
    "moved contact": LinearImage(transport([2.0, -1.0]), contact(0.0, 0.0)),
    "moved bar": LinearImage(
        transport([0.3, 0.4]), MinkowskiSum(contact(1.0, 0.0), contact(-1.0, 0.0)), [0.0, 1.0, 0.0]
    ),
    "shadow": LinearImage([[1, 0, 0], [0, 1, 0]], VPolytope(_cloud)),
    "contact sum": ContactSum(_rng.normal(size=(12, 2)), _rng.uniform(0.1, 1.0, 12)),
    "active contact sum": ContactSum(_cloud[:5, :2], [0.1, 0.5, 0.3, 0.0, 1.0], [1.0, -2.0, 0.5]),
    "elliptic contact sum": ContactSum(
        _rng.normal(size=(7, 2)), _rng.uniform(0.1, 1.0, 7), None, _rng.normal(size=(7, 3))
    ),
    "sum of one contact": ContactSum([[0.5, -1.0]], [1.0]),
    "sum of no contacts": ContactSum(np.empty((0, 2)), [], [1.0, 2.0, 3.0]),
    "far contact sum": ContactSum(_cloud[:9, :2] + [300.0, -200.0], np.full(9, 0.3)),
    "quartic": PolynomialSet(
        [[4, 0, 0], [0, 4, 0], [0, 0, 4], [2, 2, 0], [2, 0, 0], [2, 0, 2]],
        [1.0, 2.0, 3.0, 0.5, 0.3, 1.0],
    ),
}
