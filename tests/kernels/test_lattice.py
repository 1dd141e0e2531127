"""Row spans against point-in-polygon tests, and the shares of tips at the outline."""

import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.kernels.lattice import Lattice, covered_sites, new_cover

PITCH, ORIGIN = 0.1, (-1.55, -1.45)
ROWS, COLUMNS = 30, 32


def covered(part, pose, width, active=None):
    active = np.ones((ROWS, COLUMNS), bool) if active is None else active
    lattice, cover = Lattice(*ORIGIN, PITCH, active, width), new_cover(active)
    placed = Part(part.at(pose))
    edges = placed.edges + np.tile(placed.centroid, 2)
    n = covered_sites(edges, lattice, cover)
    assert np.all(cover.slot == -1)
    rows, columns = cover.rows[:n], cover.columns[:n]
    assert len(set(zip(rows, columns, strict=True))) == n
    table = np.zeros(active.shape)
    table[rows, columns] = cover.share[:n]
    return table


def sites():
    x = ORIGIN[0] + PITCH * np.arange(COLUMNS)
    y = ORIGIN[1] + PITCH * np.arange(ROWS)
    return np.stack(np.meshgrid(x, y), axis=-1)


PARTS = {
    "T": Part(
        np.array([(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)]) / 3
    ),
    "ring": Part(shapely.Point(0, 0).buffer(1.0).difference(shapely.box(-0.3, -0.4, 0.5, 0.2))),
    "pieces": Part(
        shapely.MultiPolygon([shapely.box(-1, -1, -0.3, 0), shapely.box(0, 0, 0.9, 0.7)])
    ),
    "needle": Part([(-0.9, 0), (0.9, 0.02), (-0.9, 0.04)]),
}
POSES = [(0, 0, 0), (0.013, -0.021, 0.4), (0.3, 0.2, 2.0), (-0.9, 0.8, 4.0), (5.0, 0.0, 0.0)]


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("name", PARTS)
def test_points_match_point_in_polygon(name, pose):
    part = PARTS[name]
    points = sites()
    shape = part.at(pose)
    inside = shapely.contains_xy(shape, points[..., 0], points[..., 1])
    near = shapely.distance(shapely.boundary(shape), shapely.points(points)) < 1e-12
    table = covered(part, pose, 0.0)
    assert np.array_equal(table[~near] > 0, inside[~near])


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("name", PARTS)
def test_shares_follow_the_signed_distance(name, pose):
    part, width = PARTS[name], 0.037
    points = sites()
    shape = part.at(pose)
    distance = shapely.distance(shapely.boundary(shape), shapely.points(points))
    inside = shapely.contains_xy(shape, points[..., 0], points[..., 1])
    expected = np.clip(0.5 + np.where(inside, distance, -distance) / width, 0.0, 1.0)
    assert covered(part, pose, width) == pytest.approx(expected, abs=1e-9)


def test_only_active_sites_count(rng):
    active = rng.random((ROWS, COLUMNS)) < 0.3
    every = covered(PARTS["T"], (0.01, 0.02, 0.7), 0.03)
    some = covered(PARTS["T"], (0.01, 0.02, 0.7), 0.03, active)
    assert np.array_equal(some, np.where(active, every, 0.0))


def test_total_share_is_the_area_of_the_part():
    part = PARTS["T"]
    totals = [covered(part, (dx, 0.3 * dx, 0.3), 0.05).sum() for dx in np.linspace(0, 0.1, 21)]
    assert np.mean(totals) * PITCH**2 == pytest.approx(part.area, rel=0.01)
