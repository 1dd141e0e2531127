"""Parts and fields for the tests of equilibria."""

import numpy as np
import shapely

from limitsurf.actuators.density_field import DensityField
from limitsurf.actuators.radial_density import RadialField
from limitsurf.geometry.part import Part

BRACKET = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)], dtype=float)
PARTS = {
    "bracket": Part(BRACKET),
    "triangle": Part([(0, 0), (3, 0), (1, 1.5)]),
    "plate with a hole": Part(shapely.box(0, 0, 3, 2) - shapely.box(0.4, 0.3, 1.2, 1.5)),
    "two pieces": Part(shapely.union_all([shapely.box(0, 0, 1, 1), shapely.box(3, 0.2, 4, 1.9)])),
}
#: All convex, with isolated equilibria.
FIELDS = {
    "feeder": RadialField(2.0, (0.5, -1.0)) + DensityField.uniform(0.4, 0.2),
    "strong feeder": RadialField(2.0, (0.5, -1.0)) + DensityField.uniform(0.4, 1.6),
    "radial and squeeze": RadialField(2.0, (0.5, -1.0)) + DensityField.squeeze(0.3, 2.0, 0.1),
    "two centres": RadialField(2.0, (0.5, -1.0)) + RadialField(1.0, (-1.0, 0.3)),
    "crossed squeezes": DensityField.squeeze(0.3, 2.0) + DensityField.squeeze(1.5, 1.0, 0.2),
    "elliptic": DensityField.linear([[2.0, 0.3], [0.3, 1.0]], (0.2, 0.1)),
    "centred squeeze": DensityField.linear(1.0, (0.2, 0.1)) + DensityField.squeeze(0.3, 2.0),
}


def sizes(part, field, poses):
    """Return loads at poses in units of typical ones (k, 3)."""
    R = part.circumradius
    away = poses + np.array([2.0 * R, -1.3 * R, 0.4])
    unit = np.abs(field.load(part, away)[:, :2]).max()
    return field.load(part, poses) / (unit * np.array([1.0, 1.0, R]))


def settled(part, field, starts, time):
    """Return where starts (k, 3) come to rest, moving as if through a viscous film."""
    from scipy.integrate import solve_ivp

    mobility = 1.0 / np.array([part.area, part.area, part.polar_moment])

    def rates(_, q):
        return (field.load(part, q.reshape(-1, 3)) * mobility).ravel()

    path = solve_ivp(rates, (0.0, time), starts.ravel(), method="LSODA", rtol=1e-7, atol=1e-9)
    assert path.success
    return path.y[:, -1].reshape(-1, 3)


def turned(a, b):
    """Return the distance between angles."""
    return np.abs(np.mod(a - b + np.pi, 2 * np.pi) - np.pi)
