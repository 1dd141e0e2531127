"""Sums of sums of nearly parallel bodies: no failure, and support functions add."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from limitsurf.kernels.flat_polytope import flat_polytope
from limitsurf.kernels.hull_polytope import hull_polytope
from limitsurf.kernels.minkowski import minkowski_sum_of_all
from limitsurf.kernels.normal_fan import polytope_from_faces


def regular(n):
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])


def contact(x, y, sides):
    corners = regular(sides)
    corners[:, 2] = x * corners[:, 1] - y * corners[:, 0]
    return flat_polytope(corners)


def random_body(rng):
    """Return a contact polygon, a prism, a box or a random hull."""
    kind = rng.integers(4)
    if kind == 0:
        return contact(*rng.normal(size=2), int(rng.integers(3, 9)))
    if kind == 1:
        base = regular(int(rng.integers(3, 8)))
        lid = np.array([0.0, 0.0, rng.uniform(0.1, 2)])
        return hull_polytope(np.vstack([base, base + lid]))
    if kind == 2:
        sides = [[0.0, s] for s in rng.uniform(0.2, 2, 3)]
        return hull_polytope(np.stack(np.meshgrid(*sides), -1).reshape(-1, 3))
    return hull_polytope(rng.normal(size=(int(rng.integers(4, 14)), 3)))


def turned(body, turn, factor, by):
    corners = factor * Rotation.from_rotvec(turn).apply(body.vertices) + by
    if len(body.normals) < 3:
        return flat_polytope(corners)
    return polytope_from_faces(corners, body.offsets, body.indices)


def nearly_parallel(rng):
    """Return bodies turned by 1e-14 to 1e-9, of sizes 1e-3 to 1e3, some far from the origin."""
    terms = [random_body(rng)]
    far = rng.choice([0.0, 0.0, 10.0, 1e3])
    for _ in range(rng.integers(1, 5)):
        body = terms[rng.integers(len(terms))] if rng.random() < 0.8 else random_body(rng)
        turn = 10.0 ** rng.uniform(-14, -9) * rng.normal(size=3)
        factor = rng.choice([1.0, 0.7, 10.0 ** rng.uniform(-3, 3)])
        terms.append(turned(body, turn, factor, far * rng.normal(size=3)))
    return terms


def nearly_coplanar_contacts(rng):
    """Return contact polygons that are collinear up to 1e-13 to 1e-6."""
    along = rng.normal(size=2)
    gap = 10.0 ** rng.uniform(-13, -6)
    sides = int(rng.integers(3, 9))
    places = rng.normal() * along + gap * rng.normal(size=(int(rng.integers(2, 6)), 2))
    return [contact(*place, sides) for place in places]


def support(body, directions):
    return (directions @ body.vertices.T).max(axis=1)


def check(terms, rng):
    """Compare support functions, also in directions along and across the sum."""
    total = minkowski_sum_of_all(terms)
    middle = total.vertices - total.vertices.mean(axis=0)
    axes = np.linalg.svd(middle, full_matrices=False)[2]
    directions = np.vstack([rng.normal(size=(120, 3)), axes, -axes, total.normals])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    expected = sum(support(body, directions) for body in terms)
    size = sum(float(np.ptp(body.vertices, axis=0).max()) for body in terms)
    rounding = 4e-16 * sum(float(np.abs(body.vertices).max()) for body in terms)
    assert np.abs(support(total, directions) - expected).max() <= 1e-9 * size + 4 * rounding
    # the facets support the sum
    heights = np.einsum(
        "ij,ij->i", total.normals, total.vertices[total.indices[total.offsets[:-1]]]
    )
    expected = sum(support(body, total.normals) for body in terms)
    assert np.abs(heights - expected).max(initial=0.0) <= 1e-9 * size + 64 * rounding
    return total


def test_nearly_parallel_bodies():
    for seed in range(400):
        rng = np.random.default_rng(seed)
        check(nearly_parallel(rng), rng)
        check(nearly_coplanar_contacts(rng), rng)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(1000, 13000, 3000))
def test_many_nearly_parallel_bodies(start):
    for seed in range(start, start + 3000):
        rng = np.random.default_rng(seed)
        check(nearly_parallel(rng), rng)
        check(nearly_coplanar_contacts(rng), rng)
