"""Minkowski sums: against the hull of all vertex sums, support functions and closed forms."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from limitsurf.errors import InputError
from limitsurf.kernels.flat_polytope import flat_polytope
from limitsurf.kernels.hull_polytope import hull_polytope
from limitsurf.kernels.minkowski import add_polygon, minkowski_sum, minkowski_sum_of_all, zonotope
from limitsurf.kernels.normal_fan import polytope_from_faces, triangles


def on_sphere(rng, n, axes=(1.0, 1.0, 1.0)):
    x = rng.normal(size=(n, 3))
    return x / np.linalg.norm(x, axis=1)[:, None] * axes


def box(*sides):
    return hull_polytope(np.stack(np.meshgrid(*[[0.0, s] for s in sides]), -1).reshape(-1, 3))


def regular(n, radius=1.0):
    angle = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])


def prism(n, height):
    return hull_polytope(np.vstack([regular(n), regular(n) + np.array([0, 0, height])]))


def moved(polytope, rotation=None, by=(0.0, 0.0, 0.0), factor=1.0):
    corners = polytope.vertices if rotation is None else rotation.apply(polytope.vertices)
    return polytope_from_faces(factor * corners + by, polytope.offsets, polytope.indices)


def volume(polytope):
    a, b, c = np.moveaxis((polytope.vertices - polytope.vertices[0])[triangles(polytope)], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def support(polytope, directions):
    return (directions @ polytope.vertices.T).max(axis=1)


def all_sums(p, q):
    return (p.vertices[:, None] + q.vertices).reshape(-1, 3)


def size(polytope):
    return np.ptp(polytope.vertices, axis=0).max()


def same_points(a, b, atol):
    return len(a) == len(b) and all(np.abs(b - x).max(axis=1).min() <= atol for x in a)


def check_shape(polytope, tilt=0.0):
    """Euler's formula, twins, unit normals, flat convex facets that bound all vertices."""
    vertices, offsets, indices, normals, twins = polytope
    assert len(vertices) - len(indices) // 2 + len(normals) == 2
    assert np.array_equal(np.unique(indices), np.arange(len(vertices)))
    assert np.array_equal(twins[twins], np.arange(len(indices)))
    after = np.arange(1, len(indices) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    assert np.array_equal(indices[after], indices[twins])
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-15 * 8)
    slack = (1e-12 + 3 * tilt) * size(polytope) + 1e-14 * np.abs(vertices).max()
    heights = (vertices - vertices[0]) @ normals.T
    for i, normal in enumerate(normals):
        corners = indices[offsets[i] : offsets[i + 1]]
        assert np.ptp(heights[corners, i]) <= slack
        assert heights[corners, i].min() >= heights[:, i].max() - slack
        edge = np.roll(vertices[corners], -1, 0) - vertices[corners]
        turn = np.cross(np.roll(edge, 1, 0), edge) @ normal
        assert turn.min() > -slack * size(polytope)


def check_sum(rng, p, q, solid=True, clear=True, tilt=0.0):
    """Compare with the hull of all vertex sums (its vertices if these are clear); return it."""
    total = minkowski_sum(p, q)
    check_shape(total, tilt)
    scale = size(total) + 1e-2 * np.abs(total.vertices).max()
    directions = np.vstack([on_sphere(rng, 500), np.eye(3), -np.eye(3), total.normals])
    twin = support(p, directions) + support(q, directions)
    assert support(total, directions) == pytest.approx(twin, abs=1e-12 * scale)
    if solid:
        points = all_sums(p, q)
        hull = ConvexHull(points - points.mean(axis=0))
        assert volume(total) == pytest.approx(hull.volume, rel=1e-12)
    if solid and clear:
        corners = hull_polytope(points).vertices
        assert same_points(corners, total.vertices, 1e-12 * scale)
    return total


@pytest.mark.parametrize(("m", "n"), [(4, 4), (4, 60), (12, 30), (50, 50)])
def test_random_polytopes(rng, m, n):
    for _ in range(4):
        p = hull_polytope(on_sphere(rng, m, (1, 2, 0.5)))
        q = hull_polytope(on_sphere(rng, n))
        check_sum(rng, p, q)


def test_boxes_add_their_sides(rng):
    total = check_sum(rng, box(1, 2, 3), box(4, 0.1, 2))
    assert len(total.normals) == 6
    assert total.vertices.max(axis=0) == pytest.approx([5, 2.1, 5], abs=1e-15)


def test_boxes_turned_about_an_axis(rng):
    turned = moved(box(1, 2, 3), Rotation.from_rotvec([0, 0, 0.3]))
    total = check_sum(rng, box(1, 2, 3), turned)
    assert len(total.normals) == 10


@pytest.mark.parametrize("n", [3, 4, 7, 32])
def test_prisms_that_share_normals(rng, n):
    total = check_sum(rng, prism(n, 1.0), prism(3 * n, 0.5))
    assert len(total.normals) == 3 * n + 2
    check_sum(rng, prism(n, 1.0), moved(prism(n, 0.5), Rotation.from_rotvec([0.3, 0, 0])))


def test_a_polytope_and_itself_is_twice_as_big(rng):
    for p in (hull_polytope(on_sphere(rng, 40)), box(1, 2, 3), prism(5, 2.0)):
        total = check_sum(rng, p, p)
        assert len(total.normals) == len(p.normals)
        assert same_points(2 * p.vertices, total.vertices, 1e-14)


def test_a_polytope_and_its_mirror_image(rng):
    points = on_sphere(rng, 25)
    p = hull_polytope(points)
    total = check_sum(rng, p, hull_polytope(-points))
    assert same_points(-total.vertices, total.vertices, 1e-14)


def test_turned_copies_share_some_normals(rng):
    p = prism(6, 1.0)
    for k in range(1, 6):
        turn = Rotation.from_rotvec([0, 0, k * np.pi / 3])
        assert len(check_sum(rng, p, moved(p, turn)).normals) == 8
    cube = moved(box(1, 1, 1), Rotation.random(rng=rng))
    axis = cube.normals[0]
    total = check_sum(rng, cube, moved(cube, Rotation.from_rotvec(np.pi / 4 * axis)))
    assert len(total.normals) == 10


@pytest.mark.parametrize("tilt", [1e-3, 1e-6, 1e-9, 1e-11, 3e-12, 1e-12, 3e-13, 1e-13, 1e-15])
def test_nearly_parallel_facets(rng, tilt):
    for p in (box(1, 2, 3), prism(7, 1.0), hull_polytope(on_sphere(rng, 15))):
        for _ in range(5):
            turn = Rotation.from_rotvec(tilt * on_sphere(rng, 1)[0])
            q = moved(p, turn, factor=0.7)
            # normals of the thin facets between ANGLE and 100 ANGLE are good to the tilt only
            check_sum(rng, p, q, clear=False, tilt=tilt if tilt < 1e-10 else 0.0)


def test_sums_of_sums_with_nearly_parallel_facets(rng):
    """These need several attempts; the error is certified all the same."""
    for tilt in 10.0 ** rng.uniform(-13, -10, 30):
        p = prism(7, 1.0)
        q = moved(p, Rotation.from_rotvec(tilt * on_sphere(rng, 1)[0]), factor=0.7)
        total = minkowski_sum(minkowski_sum(p, q), p)
        directions = on_sphere(rng, 200)
        expected = 2 * support(p, directions) + support(q, directions)
        assert support(total, directions) == pytest.approx(expected, abs=1e-11 * size(total))


def test_flat_summands(rng):
    bodies = [hull_polytope(on_sphere(rng, 40)), box(1, 2, 3), prism(5, 1.0)]
    polygon = flat_polytope(Rotation.random(rng=rng).apply(regular(9, 0.3)))
    segment = flat_polytope(rng.normal(size=(2, 3)))
    for body in bodies:
        check_sum(rng, body, polygon)
        check_sum(rng, body, segment)
        check_sum(rng, flat_polytope(regular(5)), body)
        check_sum(rng, flat_polytope([[0, 0, 0], [0, 0, 1]]), body)
        point = minkowski_sum(body, flat_polytope([[1.0, 2.0, 3.0]]))
        assert np.array_equal(point.vertices, body.vertices + np.array([1, 2, 3]))
    check_sum(rng, polygon, segment)
    check_sum(rng, polygon, flat_polytope(regular(4)))


def test_sums_that_stay_flat(rng):
    pentagon, square = flat_polytope(regular(5)), flat_polytope(regular(4))
    hexagon = flat_polytope(regular(6))
    assert len(check_sum(rng, pentagon, square, solid=False).vertices) == 9
    assert len(check_sum(rng, hexagon, hexagon, solid=False).vertices) == 6
    along = flat_polytope(regular(4)[[1, 2]])
    assert len(check_sum(rng, square, along, solid=False).vertices) == 4
    across = flat_polytope([[0.0, 0, 0], [0.3, 0.7, 0]])
    assert len(check_sum(rng, square, across, solid=False).vertices) == 6
    assert len(check_sum(rng, along, across, solid=False).vertices) == 4


def test_segments_points_and_their_sums():
    a, b = flat_polytope([[0, 0, 0], [1, 2, 3]]), flat_polytope([[1, 1, 1], [-1, -3, -5]])
    line = minkowski_sum(a, b)
    assert same_points(line.vertices, np.array([[2, 3, 4], [-1, -3, -5.0]]), 0.0)
    point = flat_polytope([[1.0, 2.0, 3.0]])
    assert np.array_equal(minkowski_sum(point, point).vertices, [[2, 4, 6]])
    assert len(minkowski_sum(point, a).vertices) == 2
    assert len(flat_polytope([[0, 0, 0], [1, 1, 1], [3, 3, 3], [2, 2, 2]]).vertices) == 2
    assert len(flat_polytope([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 2, 0]]).vertices) == 3


def test_far_from_the_origin(rng):
    p, q = hull_polytope(on_sphere(rng, 30)), hull_polytope(on_sphere(rng, 30))
    near = check_sum(rng, p, q)
    far = moved(p, by=(1e6, -1e6, 1e6))
    total = minkowski_sum(far, q)
    check_shape(total)
    assert len(total.normals) == len(near.normals)
    assert volume(total) == pytest.approx(volume(near), rel=1e-8)
    assert len(minkowski_sum(moved(box(1, 2, 3), by=(1e6,) * 3), box(3, 1, 1)).normals) == 6


def test_very_different_sizes(rng):
    p = hull_polytope(on_sphere(rng, 40))
    for small in (hull_polytope(on_sphere(rng, 40, (1e-6,) * 3)), box(1e-6, 2e-6, 1e-6)):
        total = check_sum(rng, p, small)
        assert len(total.normals) >= len(p.normals) + len(small.normals)


def test_commutes_and_associates(rng):
    bodies = [hull_polytope(on_sphere(rng, 20)), prism(5, 1.0), box(1, 2, 3)]
    for p in bodies:
        for q in bodies:
            a, b = minkowski_sum(p, q), minkowski_sum(q, p)
            assert same_points(a.vertices, b.vertices, 0.0)
    p, q, r = bodies
    a, b = minkowski_sum(minkowski_sum(p, q), r), minkowski_sum(p, minkowski_sum(q, r))
    assert same_points(a.vertices, b.vertices, 1e-14)
    assert len(a.normals) == len(b.normals)
    check_shape(a)


def test_bar_on_two_contacts(rng):
    """Friction disks at x = +1 and -1: two flat polygons tilted by 45 degrees to either side."""
    disk = regular(32)
    right, left = (
        flat_polytope(np.column_stack([disk[:, :2], x * disk[:, 1]])) for x in (1.0, -1.0)
    )
    total = check_sum(rng, right, left)
    assert total.vertices[:, 2].max() == pytest.approx(2.0, abs=1e-14)
    assert total.vertices[:, 2].min() == pytest.approx(-2.0, abs=1e-14)
    assert total.vertices[:, :2].max(axis=0) == pytest.approx([2.0, 2.0], abs=1e-14)


def test_many_contacts_added_one_by_one(rng):
    """Coulomb disks at random places; the support function is the sum of those of the disks."""
    disk = regular(16)
    total = flat_polytope([[0.0, 0.0, 0.0]])
    directions = on_sphere(rng, 200)
    expected = np.zeros(200)
    for x, y in rng.normal(size=(7, 2)):
        corners = np.column_stack([disk[:, :2], x * disk[:, 1] - y * disk[:, 0]])
        total = add_polygon(total, corners)
        expected += (directions @ corners.T).max(axis=1)
    check_shape(total)
    assert support(total, directions) == pytest.approx(expected, abs=1e-12 * size(total))


def test_contacts_on_a_lattice(rng):
    """Equal polygons at lattice points: many parallel edges and coplanar facets."""
    disk = regular(8)
    contacts = [
        flat_polytope(np.column_stack([disk[:, :2], x * disk[:, 1] - y * disk[:, 0]]))
        for x in range(-2, 3)
        for y in range(-2, 3)
    ]
    total = minkowski_sum_of_all(contacts)
    check_shape(total)
    directions = np.vstack([on_sphere(rng, 200), total.normals])
    expected = sum(support(c, directions) for c in contacts)
    assert support(total, directions) == pytest.approx(expected, abs=1e-12 * size(total))


@pytest.mark.parametrize("n", [3, 5, 20, 60])
def test_zonotope_in_general_position(rng, n):
    total = zonotope(rng.normal(size=(n, 3)))
    check_shape(total)
    assert len(total.vertices) == n * (n - 1) + 2
    assert len(total.normals) == n * (n - 1)


def test_zonotopes_with_parallel_and_coplanar_segments(rng):
    cube = zonotope(np.vstack([np.eye(3), 2 * np.eye(3), -np.eye(3), np.zeros((1, 3))]))
    assert (len(cube.vertices), len(cube.normals)) == (8, 6)
    assert cube.vertices.max(axis=0) == pytest.approx([3, 3, 3])
    steps = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), -1).reshape(-1, 3).astype(float)
    total = zonotope(steps)
    check_shape(total)
    directions = on_sphere(rng, 200)
    expected = np.maximum(directions @ steps.T, 0).sum(axis=1)
    assert support(total, directions) == pytest.approx(expected, abs=1e-12 * size(total))
    assert len(zonotope(regular(5)).vertices) == 10
    assert len(zonotope([[1, 2, 3], [-2, -4, -6]]).vertices) == 2
    assert len(zonotope(np.zeros((2, 3))).vertices) == 1


def test_zonotope_equals_repeated_addition(rng):
    segments = rng.normal(size=(12, 3))
    total = flat_polytope([[0.0, 0.0, 0.0]])
    for s in segments:
        total = add_polygon(total, [[0.0, 0.0, 0.0], s])
    check_shape(total)
    assert same_points(zonotope(segments).vertices, total.vertices, 1e-13)


def test_vertices_with_many_edges(rng):
    """Pyramids: the cell of an apex has as many arcs as the base has corners."""
    p = hull_polytope(np.vstack([regular(50), [[0.1, 0.2, 1.0]]]))
    q = hull_polytope(np.vstack([regular(64, 0.5), [[0.0, 0.1, -2.0]]]))
    check_sum(rng, p, q)
    check_sum(rng, p, moved(p, Rotation.random(rng=rng)))
    check_sum(rng, p, hull_polytope(on_sphere(rng, 100)))


def test_random_lattice_polytopes(rng):
    """Small integers: coplanar facets and parallel edges of all kinds."""
    for _ in range(40):
        p, q = (hull_polytope(rng.integers(-2, 3, (10, 3))) for _ in range(2))
        check_sum(rng, p, q)


def test_hull_of_flat_and_small_sets(rng):
    turn = Rotation.random(rng=rng)
    assert len(hull_polytope(turn.apply(regular(7)) + 5).vertices) == 7
    assert len(hull_polytope(np.outer(rng.normal(size=9), [1, 2, 3])).vertices) == 2
    assert len(hull_polytope(np.ones((4, 3))).vertices) == 1
    assert len(box(1, 2, 3).normals) == 6


def test_errors_name_the_argument():
    with pytest.raises(InputError, match="corners: are not those of a convex polygon"):
        flat_polytope(regular(8)[[0, 3, 6, 1, 4, 7, 2, 5]])
    with pytest.raises(InputError, match="corners: do not lie in a plane"):
        flat_polytope([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]])
    with pytest.raises(InputError, match="corners: must be one or more finite points"):
        flat_polytope(np.empty((0, 3)))
    with pytest.raises(InputError, match="points: must be one or more finite points"):
        hull_polytope([[np.nan, 0, 0]])
    with pytest.raises(InputError, match="indices: not the facets"):
        polytope_from_faces(np.eye(3), [0, 3], [0, 1, 2])
    with pytest.raises(InputError, match="summands: must not be empty"):
        minkowski_sum_of_all([])
