"""Tips under a part: against point-in-polygon tests, and kept up to date against listed anew."""

import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.kernels.contact_pass import Contacts
from limitsurf.kernels.contact_problem import second_moments
from limitsurf.kernels.lattice import Lattice
from limitsurf.kernels.row_spans import no_spans
from limitsurf.kernels.tip_list import COUNT, PUSH_M, PUSH_X, SHARE, moments_of, new_tips, tip_data
from limitsurf.kernels.tips import move_tips

PITCH, ORIGIN = 0.1, (-1.55, -1.45)
ROWS, COLUMNS = 30, 32
DIRECTIONS = np.random.default_rng(3).normal(size=(ROWS, COLUMNS, 2))


class Follower:
    """Tips under a part that moves."""

    def __init__(self, part, width, active=None):
        self.part = part
        active = np.ones((ROWS, COLUMNS), bool) if active is None else active
        self.lattice = Lattice(*ORIGIN, PITCH, active, DIRECTIONS, width)
        self.tips, self.spans = new_tips(self.lattice, part.circumradius), no_spans()

    def move(self, pose):
        placed = Part(self.part.at(pose))
        edges = placed.edges + np.tile(placed.centroid, 2)
        self.spans = move_tips(self.lattice, edges, pose[0], pose[1], self.tips, self.spans)
        return self.table()

    def table(self):
        n, data = self.tips.numbers[COUNT], tip_data(self.tips)
        rows, columns = self.tips.rows[:n], self.tips.columns[:n]
        assert len(set(zip(rows, columns, strict=True))) == n
        assert not data[2, n:].any()
        x = ORIGIN[0] + PITCH * columns - self.tips.anchor[0]
        y = ORIGIN[1] + PITCH * rows - self.tips.anchor[1]
        assert data[:2, :n] == pytest.approx(np.stack([x, y]), abs=1e-15)
        table = np.zeros((ROWS, COLUMNS))
        table[rows, columns] = data[2, :n]
        return table

    def sums(self):
        """Add up what the tips keep, the slow way."""
        n, data = self.tips.numbers[COUNT], tip_data(self.tips)
        push = DIRECTIONS[self.tips.rows[:n], self.tips.columns[:n]] * data[2, :n, None]
        x, y = data[:2, :n]
        return np.array([*push.sum(axis=0), x @ push[:, 1] - y @ push[:, 0]])


def covered(part, pose, width, active=None):
    return Follower(part, width, active).move(pose)


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


@pytest.mark.parametrize("width", [0.0, 0.037])
@pytest.mark.parametrize("name", PARTS)
def test_a_list_kept_up_to_date_is_the_list_made_anew(name, width, rng):
    part, active = PARTS[name], rng.random((ROWS, COLUMNS)) < 0.6
    follower = Follower(part, width, active)
    pose = np.array([-0.3, 0.2, 0.0])
    for step in range(150):
        # short moves, some into places not seen before, some far ones
        pose = pose + rng.normal(size=3) * ([0.02, 0.02, 0.05] if step % 40 else 0.4)
        pose[:2] = np.clip(pose[:2], -0.6, 0.6)
        table = follower.move(pose)
        assert table == pytest.approx(covered(part, pose, width, active), abs=1e-12)
        sums = follower.tips.sums
        assert sums[SHARE] == pytest.approx(table.sum(), rel=1e-12, abs=1e-12)
        assert sums[PUSH_X : PUSH_M + 1] == pytest.approx(follower.sums(), abs=1e-11)
        direct = second_moments(Contacts(tip_data(follower.tips), 1, None))
        assert moments_of(follower.tips) == pytest.approx(direct, rel=1e-10, abs=1e-11)


ANGLES = np.linspace(0.0, 2 * np.pi, 300, endpoint=False)
WAVES = (0.8 + 0.1 * np.cos(37 * ANGLES))[:, None]
ODD_PARTS = {
    "hundreds of vertices": Part(WAVES * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])),
    "between the sites": Part(0.03 * np.array([(0, 0), (1, 0), (0.4, 0.8)])),
    "thin teeth": Part(
        shapely.union_all(
            [shapely.box(-0.9, -0.9, 0.9, -0.8)]
            + [shapely.box(x, -0.85, x + 0.02, 0.9) for x in np.arange(-0.85, 0.85, 0.07)]
        )
    ),
}


@pytest.mark.parametrize("width", [1e-9, 0.1, 0.6])
@pytest.mark.parametrize("name", ODD_PARTS)
def test_odd_parts_that_leave_and_come_back(name, width, rng):
    part, active = ODD_PARTS[name], rng.random((ROWS, COLUMNS)) < 0.7
    follower, pose = Follower(part, width, active), np.zeros(3)
    for step in range(40):
        far = rng.uniform(-3.0, 3.0, 3) if step % 10 else np.array([50.0, 0.0, 0.0])
        pose = far if step % 5 == 0 else pose + rng.normal(size=3) * [0.02, 0.02, 0.1]
        table = follower.move(pose)
        assert table == pytest.approx(covered(part, pose, width, active), abs=1e-12)
        assert follower.tips.sums[SHARE] == pytest.approx(table.sum(), rel=1e-11, abs=1e-11)
        assert follower.tips.sums[PUSH_X : PUSH_M + 1] == pytest.approx(follower.sums(), abs=1e-10)
