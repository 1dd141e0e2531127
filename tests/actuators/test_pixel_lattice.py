import numpy as np
import pytest
from scipy.spatial import cKDTree

from limitsurf.actuators.actuator_array import load_array
from limitsurf.actuators.pixel_lattice import PixelLattice, by_pixel, by_site, headings
from limitsurf.errors import InputError


def test_rectangular_lattice():
    lattice = PixelLattice.rectangular(3, 5, (2.0, 1.0), headings(4))
    assert lattice.pixel_centers.shape == (15, 2)
    assert lattice.pixel_centers.min(axis=0) == pytest.approx([-4.0, -1.0])
    assert lattice.pixel_centers.max(axis=0) == pytest.approx([4.0, 1.0])
    assert lattice.pixel_area == 2.0
    assert lattice.positions.shape == lattice.pushes.shape == (15, 4, 2)
    assert lattice.offsets[0] == pytest.approx([0.5, 0.0])


def test_hexagonal_lattice_has_six_nearest_neighbours():
    lattice = PixelLattice.hexagonal(9, 9, 0.2, headings(6))
    near = cKDTree(lattice.pixel_centers)
    counts = [len(x) - 1 for x in near.query_ball_point(lattice.pixel_centers, 0.2001)]
    assert max(counts) == 6
    assert sum(c == 6 for c in counts) == 49
    distance = near.query(lattice.pixel_centers, 2)[0][:, 1]
    assert distance == pytest.approx(0.2)
    span = np.ptp(lattice.pixel_centers, axis=0) / [8.5, 8]
    assert span[0] * span[1] == pytest.approx(lattice.pixel_area)


def test_one_actuator_sits_at_the_centre():
    lattice = PixelLattice.rectangular(2, 2, 1.0, [[3.0, 4.0]])
    assert np.array_equal(lattice.positions[:, 0], lattice.pixel_centers)
    assert lattice.pushes[0, 0] == pytest.approx([0.6, 0.8])


def test_an_actuator_array_as_a_lattice():
    array = load_array("resonator32").with_spread(strength=0.1, direction=0.1, dead=0.1, seed=1)
    lattice = PixelLattice.from_array(array)
    x0, y0 = array.first_site
    rows, columns = np.indices((64, 64))
    sites = np.stack([x0 + array.site_pitch * columns, y0 + array.site_pitch * rows], axis=-1)
    for axis in range(2):
        assert by_pixel(sites[..., axis], array) == pytest.approx(lattice.positions[..., axis])
        pushes = by_pixel(array.site_directions[..., axis], array)
        assert pushes == pytest.approx(lattice.pushes[..., axis])
    assert np.array_equal(by_site(by_pixel(array.alive, array), array), array.alive)
    plain = PixelLattice.from_array(load_array("resonator32"))
    assert np.linalg.norm(plain.pushes, axis=-1) == pytest.approx(1.0)


def test_spread_of_a_lattice_is_seeded():
    lattice = PixelLattice.hexagonal(5, 5, 1.0, headings(3))
    first, again = (lattice.with_spread(strength=0.1, dead=0.2, seed=4) for _ in range(2))
    assert np.array_equal(first.pushes, again.pushes)
    assert first.spread.dead.any()


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((0, 3, 1.0, headings(4)), "rows"),
        ((3, 2.5, 1.0, headings(4)), "columns"),
        ((3, 3, -1.0, headings(4)), "pitch"),
        ((3, 3, "wide", headings(4)), "pitch"),
        ((3, 3, 1.0, [[0.0, 0.0]]), "directions"),
        ((3, 3, 1.0, [1.0, 0.0]), "directions"),
        ((3, 3, 1.0, headings(2), [[0.0, 0.0]]), "offsets"),
    ],
)
def test_bad_lattices_are_named(arguments, name):
    for build in (PixelLattice.rectangular, PixelLattice.hexagonal):
        with pytest.raises(InputError, match=name):
            build(*arguments)
    with pytest.raises(InputError, match="count"):
        headings(0)
    with pytest.raises(InputError, match="count"):
        headings(2.5)
