"""Parts of many kinds for the turn function, and its slow twins."""

import itertools

import numpy as np
import shapely
from scipy.optimize import brentq

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import area_left, squeeze_states


def ring(radii, phase=0.0):
    """Return points at equal angles."""
    angles = phase + 2 * np.pi * np.arange(len(radii)) / len(radii)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def convex(rng, n):
    hull = shapely.convex_hull(shapely.MultiPoint(rng.normal(size=(3 * n, 2))))
    return shapely.get_coordinates(hull)[:-1]


def star(rng, n):
    angles = (np.arange(n) + rng.uniform(0.05, 0.95, n)) * 2 * np.pi / n
    radii = rng.uniform(0.2, 1.0, n)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def untangled(rng, n):
    """Return a random simple polygon: crossing edges of a random one are swapped away."""
    points = rng.random((n, 2))
    order = list(rng.permutation(n))

    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    def crossing():
        for i, j in itertools.combinations(range(n), 2):
            a, b, c, d = (points[order[k % n]] for k in (i, i + 1, j, j + 1))
            if side(a, b, c) * side(a, b, d) < 0 > side(c, d, a) * side(c, d, b):
                return i, j
        return None

    while (found := crossing()) is not None:
        i, j = found
        order[i + 1 : j + 1] = order[i + 1 : j + 1][::-1]
    return points[order]


def comb(rng, n):
    points = [(0.0, 0.0)]
    for i in range(max(n // 4, 1)):
        height = rng.choice([1.0, 1.0, 2.0, rng.uniform(0.5, 2.0)])
        points += [(i, 0.2), (i, height), (i + 0.5, height), (i + 0.5, 0.2)]
    return np.array([*points, (i + 0.5, 0.0)])[1:]


def spiral(rng, n):
    angles = np.linspace(0.3, rng.uniform(3, 12), n)
    width = rng.uniform(0.2, 0.9)
    inner, outer = (
        np.column_stack([r * np.cos(angles), r * np.sin(angles)]) for r in (angles, angles + width)
    )
    return np.vstack([inner, outer[::-1]])


def sliver(rng, n):
    return convex(rng, n) * [1e4, 1.0] @ turn_matrix(rng.uniform(0, np.pi))


def with_holes(rng, n):
    outline = shapely.Polygon(ring(rng.uniform(0.8, 1.2, n + 4)))
    holes = [shapely.Polygon(0.1 * star(rng, 5) + c) for c in ring(np.full(3, 0.4))]
    return outline.difference(shapely.union_all(holes))


def pieces(rng, n):
    return shapely.union_all(
        [
            shapely.Polygon(0.6 * convex(rng, max(n // 3, 2)) + c)
            for c in rng.normal(size=(4, 2)) * 3
        ]
    )


def nearly_symmetric(rng, n):
    return ring(1 + 10.0 ** rng.uniform(-9, -2) * rng.normal(size=n))


def blocks(rng, n):
    """Return unit squares that touch along sides: edges on medians, triple roots, pivots."""
    grid = {(0, 0)}
    while len(grid) < 2 + n % 7:
        x, y = list(grid)[rng.integers(len(grid))]
        dx, dy = [(1, 0), (-1, 0), (0, 1), (0, -1)][rng.integers(4)]
        grid.add((x + dx, y + dy))
    return shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in grid])


KINDS = [
    convex,
    star,
    untangled,
    comb,
    spiral,
    sliver,
    with_holes,
    pieces,
    nearly_symmetric,
    blocks,
]


def turn_matrix(angle):
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def random_part(kind, seed):
    """Return a valid part of a kind, the first from a seed on."""
    while True:
        rng = np.random.default_rng(seed)
        try:
            return Part(kind(rng, int(rng.integers(4, 26))))
        except ValueError:  # crosses itself
            seed += 10_000


def zindler(n):
    """Return a polygon with n corners on a curve all of whose chords that halve it are equal."""
    t = 4 * np.pi * np.arange(n) / n
    z = np.exp(2j * t) + 2 * np.exp(-1j * t) + 8 * np.exp(0.5j * t)
    return np.column_stack([z.real, z.imag])


def size_and_edges(part):
    return part.unit_edges, float(part.circumradius / part.area**0.5)


def brute_force_events(part):
    """Return all directions in [0, pi) at which the median passes a vertex.

    Between directions along two vertices, the area left of a line through a vertex is smooth.
    """
    edges = part.unit_edges
    vertices = edges[:, :2]
    found = []
    for v in vertices:

        def excess(theta, v=v):
            return area_left(edges, theta, np.cos(theta) * v[1] - np.sin(theta) * v[0])[0] - 0.5

        towards = vertices[np.any(vertices != v, axis=1)] - v
        knots = np.sort(np.mod(np.arctan2(towards[:, 1], towards[:, 0]), np.pi))
        for a, b in itertools.pairwise([*knots, knots[0] + np.pi]):
            samples = np.linspace(a, b, 9)
            values = [excess(theta) for theta in samples]
            found += [
                brentq(excess, samples[k], samples[k + 1], xtol=1e-15)
                for k in range(8)
                if values[k] * values[k + 1] < 0
            ]
    return np.sort(np.mod(found, np.pi))


def scan_signs(part, directions=4001):
    """Return directions and the sign of U' there, 0 where it is rounding: sums over all edges."""
    edges, radius = size_and_edges(part)
    theta = 0.123 + np.pi * np.arange(directions) / directions
    slope = squeeze_states(edges, theta, 0.5)[:, 2]
    return theta, np.where(np.abs(slope) <= 1e-13 * max(1.0, radius), 0.0, np.sign(slope))
