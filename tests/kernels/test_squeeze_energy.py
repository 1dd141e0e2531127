import numpy as np
import shapely

from limitsurf.actuators.density_field import DensityField
from limitsurf.geometry.part import Part
from limitsurf.kernels.squeeze_energy import squeeze_loads
from limitsurf.sets.arguments import writable

PARTS = (
    Part([(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)]),
    Part(shapely.Point(0, 0).buffer(1.0).difference(shapely.box(-0.2, 0.1, 0.9, 0.4))),
    Part(shapely.MultiPolygon([shapely.box(0, 0, 1, 2), shapely.box(3, 1, 5, 1.5)])),
)


def test_loads_are_those_of_the_density_field(rng):
    for part in PARTS:
        reach = part.circumradius
        poses = rng.normal(size=(200, 3)) * [0.0, 0.5 * reach, 3.0]
        exact = DensityField.squeeze(0.0, 1.0).load(part, poses)[:, 1:]
        found = squeeze_loads(writable(part.edges), part.area, -poses[:, 2], -poses[:, 1])
        size = part.area * np.array([1.0, reach])
        assert np.abs((found - exact) / size).max() < 1e-13


def test_a_part_on_one_side_is_pushed_with_its_area():
    part = PARTS[0]
    load = squeeze_loads(writable(part.edges), part.area, np.array([0.4]), np.array([-9.0]))
    assert np.abs(load[0] - [-part.area, 0.0]).max() < 1e-12 * part.area
