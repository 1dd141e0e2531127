"""Row spans against point-in-polygon tests, their changes against sets of sites, and their cost."""

import numpy as np
import pytest
import shapely

from limitsurf.geometry.part import Part
from limitsurf.kernels.row_spans import (
    first_at_least,
    no_spans,
    row_crossings,
    row_spans,
    span_changes,
    span_sites,
)

PITCH, X0, Y0 = 0.1, -1.55, -1.45
ROWS, COLUMNS = 30, 32

ANGLES = np.arange(14) * np.pi / 7
STAR = np.tile([1.0, 0.3], 7)[:, None] * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
PARTS = {
    "T": Part(
        np.array([(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)]) / 3
    ),
    "ring": Part(shapely.Point(0, 0).buffer(1.0).difference(shapely.box(-0.3, -0.4, 0.5, 0.2))),
    "pieces": Part(
        shapely.MultiPolygon([shapely.box(-1, -1, -0.3, 0), shapely.box(0, 0, 0.9, 0.7)])
    ),
    "needle": Part([(-0.9, 0), (0.9, 0.02), (-0.9, 0.04)]),
    "star": Part(STAR),
    "comb": Part(
        shapely.union_all(
            [shapely.box(-1, 0, 1, 0.2)]
            + [shapely.box(k / 25 - 1, 0, k / 25 - 0.98, 0.9) for k in range(50)]
        )
    ),
}
POSES = [(0, 0, 0), (0.013, -0.021, 0.4), (0.3, 0.2, 2.0), (-0.9, 0.8, 4.0), (5.0, 0.0, 0.0)]


def placed_edges(part, pose):
    moved = Part(part.at(pose))
    return moved.edges + np.tile(moved.centroid, 2)


def as_set(sites):
    listed = set(map(tuple, sites.tolist()))
    assert len(listed) == len(sites)
    return listed


@pytest.mark.parametrize("bounded", [True, False])
@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("name", PARTS)
def test_spans_match_point_in_polygon(name, pose, bounded):
    part = PARTS[name]
    rows, columns = np.meshgrid(np.arange(-60, 80), np.arange(-60, 90), indexing="ij")
    x, y = X0 + PITCH * columns, Y0 + PITCH * rows
    shape = part.at(pose)
    inside = shapely.contains_xy(shape, x, y)
    near = shapely.distance(shapely.boundary(shape), shapely.points(x, y)) < 1e-12
    if bounded:
        inside &= (rows >= 0) & (rows < ROWS) & (columns >= 0) & (columns < COLUMNS)
    size = (ROWS, COLUMNS) if bounded else (-1, -1)
    spans = row_spans(placed_edges(part, pose), X0, Y0, PITCH, *size)
    found = as_set(span_sites(spans))
    doubtful = as_set(np.column_stack([rows[near], columns[near]]))
    expected = as_set(np.column_stack([rows[inside], columns[inside]]))
    assert found - doubtful == expected - doubtful


@pytest.mark.parametrize("name", PARTS)
def test_intervals_are_sorted_and_disjoint(name):
    spans = row_spans(placed_edges(PARTS[name], (0.01, 0.02, 0.3)), X0, Y0, PITCH, -1, -1)
    assert spans.offsets[0] == 0
    assert spans.offsets[-1] == len(spans.left) == len(spans.right)
    assert np.all(spans.left < spans.right)
    for start, end in zip(spans.offsets, spans.offsets[1:], strict=False):
        assert np.all(spans.right[start:end][:-1] <= spans.left[start:end][1:])


def test_changes_are_the_differences_of_sets(rng):
    poses = np.column_stack([rng.uniform(-1, 1, (40, 2)), rng.uniform(0, 7, 40)])
    every = [
        row_spans(placed_edges(part, pose), X0, Y0, PITCH, ROWS, COLUMNS)
        for pose in poses
        for part in PARTS.values()
    ]
    for old, new in zip([no_spans(), *every], [*every, no_spans()], strict=True):
        entered, left = (as_set(sites) for sites in span_changes(old, new))
        before, after = as_set(span_sites(old)), as_set(span_sites(new))
        assert entered == after - before
        assert left == before - after


def test_squares_that_touch_share_no_site():
    """Half-open intervals: each site of an aligned tiling belongs to one square."""
    tiles = [shapely.box(i, j, i + 1, j + 1) for i in range(3) for j in range(3)]
    listed = []
    for tile in tiles:
        edges = Part(tile).edges + np.tile(Part(tile).centroid, 2)
        listed += span_sites(row_spans(edges, 0.0, 0.0, 0.25, -1, -1)).tolist()
    assert sorted(listed) == [[r, c] for r in range(12) for c in range(12)]


def test_work_grows_with_rows_not_with_sites():
    """An edge is visited once a row that it crosses; rows, crossings and spans are all there is."""
    edges = placed_edges(PARTS["ring"], (0.0, 0.0, 0.1))
    work, sites = [], []
    for pitch in (0.02, 0.01, 0.005):
        crossings = row_crossings(edges, Y0, pitch, -1)
        low, high = np.sort(edges[:, [1, 3]], axis=1).T
        rows_crossed = np.ceil((high - Y0) / pitch) - np.ceil((low - Y0) / pitch)
        assert len(crossings.x) == rows_crossed.sum()
        spans = row_spans(edges, X0, Y0, pitch, -1, -1)
        work.append(len(crossings.x) + len(crossings.offsets) + len(spans.left))
        sites.append(len(span_sites(spans)))
    assert work[2] / work[0] == pytest.approx(4.0, rel=0.05)
    assert sites[2] / sites[0] == pytest.approx(16.0, rel=0.05)


@pytest.mark.parametrize(("origin", "pitch"), [(0.0, 0.1), (-1.55, 0.1), (1e6, 1e-3), (0.3, 1e-7)])
def test_first_site_is_right_to_the_last_place(rng, origin, pitch):
    for i in rng.integers(-1000, 1000, 200):
        site = origin + pitch * i
        for position in (np.nextafter(site, -np.inf), site, np.nextafter(site, np.inf)):
            first = first_at_least(position, origin, pitch, 1.0 / pitch)
            slack = 2 * np.spacing(max(abs(position), abs(origin)))
            assert origin + pitch * first >= position - slack
            assert origin + pitch * (first - 1) < position + slack


def test_nothing_is_covered_between_the_rows_or_off_the_lattice():
    thin = placed_edges(Part([(0, 0.01), (1, 0.01), (1, 0.02), (0, 0.02)]), (0.5, 0.015, 0.0))
    assert len(span_sites(row_spans(thin, 0.0, 0.0, 0.1, -1, -1))) == 0
    far = placed_edges(PARTS["T"], (50.0, 0.0, 0.0))
    assert len(span_sites(row_spans(far, X0, Y0, PITCH, ROWS, COLUMNS))) == 0
    assert len(span_sites(row_spans(far, X0, Y0, PITCH, 0, 0))) == 0
