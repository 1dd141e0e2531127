"""Crossings of a moving outline: against dense sampling, at clipped corners, at walls."""

import numpy as np
import pytest
import shapely

from limitsurf.geometry.outlines import directed_edges
from limitsurf.kernels.outline_crossings import first_crossing, first_exit, points_on_outline
from limitsurf.kernels.pose_arc import Arc, arc_pose

NEAR = 1e-13


def random_scene(rng):
    """Return a polygon about the origin, its edges, points, and an arc of size 1 or so."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, 7)) + np.linspace(0, 1e-3, 7)
    ring = rng.uniform(0.4, 1.0, 7)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    polygon = shapely.Polygon(ring).buffer(0)
    polygon = polygon if polygon.geom_type == "Polygon" else polygon.convex_hull
    powers = rng.normal(size=(4, 3)) * 0.3 / np.arange(1, 5)[:, None]
    start = np.array([*rng.normal(size=2) * 0.1, rng.uniform(-3, 3)])
    polygon = shapely.orient_polygons(polygon)
    return (
        polygon,
        directed_edges(polygon, (0.0, 0.0)),
        rng.uniform(-1.2, 1.2, (30, 2)),
        start,
        powers,
    )


def at(polygon, pose):
    turned = shapely.affinity.rotate(polygon, pose[2], origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, pose[0], pose[1])


@pytest.mark.parametrize("seed", range(25))
def test_no_crossing_is_missed(seed):
    """The first crossing against 4000 looks along the arc: never later, and on the outline."""
    rng = np.random.default_rng([5, seed])
    polygon, edges, points, start, powers = random_scene(rng)
    arc = Arc(start, powers)
    inside = shapely.contains_xy(at(polygon, start), points)
    skip = np.zeros(len(points), dtype=bool)
    tau, tip, edge = first_crossing(arc, edges, points, inside, skip, NEAR)
    first = 2.0
    for look in np.linspace(0, 1, 4001):
        now = shapely.contains_xy(at(polygon, arc_pose(arc, look)), points)
        if (now != inside).any():
            first = look
            break
    assert tau <= first
    if tau < 1.0:
        pose = np.array(arc_pose(arc, tau))
        boundary = shapely.boundary(at(polygon, pose))
        assert shapely.distance(boundary, shapely.Point(points[tip])) < 1e-14
        found = np.empty((10, 2), dtype=np.int32)
        count = points_on_outline(pose, edges, points, 1e-14, found)
        assert [tip, edge] in found[:count].tolist()
    else:
        assert first == 2.0


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
def test_a_clipped_corner_is_found(depth):
    """A point that is under a corner for a moment only, in the middle of a long step."""
    square = directed_edges(shapely.box(-1, -1, 1, 1), (0.0, 0.0))
    turned = np.pi / 4
    point = np.array([[0.3, np.sqrt(2.0) - depth]])
    arc = Arc(np.array([0.0, 0.0, turned]), np.array([[1.0, 0.0, 0.0]]))
    none = np.zeros(1, dtype=bool)
    tau, tip, _ = first_crossing(arc, square, point, none, none, NEAR)
    assert tip == 0
    assert tau == pytest.approx(0.3 - depth, abs=1e-13)
    beyond = np.array([[0.3, np.sqrt(2.0) + depth]])
    assert first_crossing(arc, square, beyond, none, none, NEAR)[1] == -1


def test_a_point_on_an_edge_leaves_only_if_it_moves_away():
    square = directed_edges(shapely.box(-1, -1, 1, 1), (0.0, 0.0))
    point, none = np.array([[1.0, 0.2]]), np.zeros(1, dtype=bool)
    for status, speed, found in (
        (True, 0.1, -1),
        (False, -0.1, -1),
        (False, 0.1, 0),
        (True, -0.1, 0),
    ):
        arc = Arc(np.zeros(3), np.array([[speed, 0.0, 0.0]]))
        tau, tip, _ = first_crossing(arc, square, point, np.array([status]), none, NEAR)
        assert tip == found
        assert tau == (0.0 if found == 0 else 2.0)
    along = Arc(np.zeros(3), np.array([[0.0, 0.1, 0.0]]))
    assert first_crossing(along, square, point, np.array([True]), none, NEAR)[1] == -1


def test_corners_leave_through_walls_exactly():
    square = directed_edges(shapely.box(-1, -1, 1, 1), (0.0, 0.0))
    corners = np.array([[-3, -3], [3, -3], [3, 3], [-3, 3]], dtype=float)
    walls = np.hstack([corners, np.roll(corners, -1, axis=0)])
    arc = Arc(np.zeros(3), np.array([[1.0, 0.0, np.pi / 4], [1.5, 0.0, 0.0]]))
    tau = first_exit(arc, square, walls, NEAR)
    reach = max(shapely.bounds(at(shapely.box(-1, -1, 1, 1), arc_pose(arc, tau))))
    assert reach == pytest.approx(3.0, abs=1e-14)
    before = [
        max(shapely.bounds(at(shapely.box(-1, -1, 1, 1), arc_pose(arc, look))))
        for look in np.linspace(0, tau, 200)[:-1]
    ]
    assert max(before) < 3.0
    assert first_exit(Arc(np.zeros(3), np.array([[0.5, 0.0, 0.0]])), square, walls, NEAR) == 2.0
