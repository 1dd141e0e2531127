"""Minkowski sums beside the hull of all vertex sums and manifold3d, in one run on one thread.

Usage: python benchmarks/bench_minkowski.py
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time

import numpy as np
from scipy.spatial import ConvexHull
from timing import timed

from limitsurf.kernels.flat_polytope import flat_polytope
from limitsurf.kernels.hull_polytope import hull_polytope
from limitsurf.kernels.minkowski import minkowski_sum, zonotope
from limitsurf.kernels.normal_fan import triangles

try:
    import manifold3d
except ImportError:
    manifold3d = None

AXES = (((1, 1, 1), (1, 1, 1)), ((1, 2, 0.5), (1, 1, 1)), ((1, 1, 5), (5, 1, 1)))


def ellipsoid(rng, facets, axes=(1, 1, 1)):
    """Return the hull of random points on an ellipsoid; n points have 2 n - 4 facets."""
    x = rng.normal(size=(facets // 2 + 2, 3))
    return hull_polytope(x / np.linalg.norm(x, axis=1)[:, None] * axes)


def manifold_of(polytope):
    """Return the polytope as a manifold3d body."""
    mesh = manifold3d.Mesh64(polytope.vertices, triangles(polytope).astype(np.uint64))
    return manifold3d.Manifold(mesh)


def compare(rng):
    """Print one row for each pair of ellipsoids of 1000 facets."""
    print(
        "| axes of P, Q | facets of P + Q | ours, ms | hull, ms | ratio | manifold3d, ms | ratio |"
    )
    print("|---|---|---|---|---|---|---|")
    for p_axes, q_axes in AXES:
        p, q = ellipsoid(rng, 1000, p_axes), ellipsoid(rng, 1000, q_axes)
        ours, total = timed(lambda: minkowski_sum(p, q), 101)
        hull, _ = timed(lambda: ConvexHull((p.vertices[:, None] + q.vertices).reshape(-1, 3)), 5)
        row = f"| {p_axes}, {q_axes} | {len(total.normals)} | {1e3 * ours:.2f} "
        row += f"| {1e3 * hull:.0f} | {hull / ours:.0f} |"
        if manifold3d is not None:
            a, b = manifold_of(p), manifold_of(q)
            other, volume = timed(lambda: a.minkowski_sum(b).volume(), 5)
            row += f" {1e3 * other:.0f} | {other / ours:.0f} |"
            corners = total.vertices[triangles(total)]
            own = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
            assert abs(volume / own - 1) < 1e-6
        print(row)
    if manifold3d is None:
        print("\nmanifold3d is not installed: skipped (pip install manifold3d)")


def exponent(sizes, times):
    """Return the slope of log time over log size."""
    return np.polyfit(np.log(sizes), np.log(times), 1)[0]


def growth(rng):
    """Print times over the size of the sum, and of adding one contact to a large sum."""
    print("\n| facets of P and Q | facets of the sum | ours, ms | ns per facet |")
    print("|---|---|---|---|")
    sizes, times = [], []
    for n in (30, 100, 300, 1000, 3000):
        p, q = ellipsoid(rng, n), ellipsoid(rng, n, (1, 2, 0.5))
        spent, total = timed(lambda: minkowski_sum(p, q), 51)
        sizes.append(len(total.normals))
        times.append(spent)
        print(f"| {n} | {sizes[-1]} | {1e3 * spent:.3f} | {1e9 * spent / sizes[-1]:.0f} |")
    big = np.array(sizes) >= 1000
    slope = exponent(np.array(sizes)[big], np.array(times)[big])
    print(f"\nexponent {exponent(sizes, times):.2f} (from 1000 facets on: {slope:.2f})")


def add_contacts(rng):
    """Print the time to add a 32-gon or a segment to sums of growing size."""
    angle = 2 * np.pi * np.arange(32) / 32
    corners = np.column_stack([np.cos(angle), np.sin(angle), 0.3 * np.sin(angle)])
    making, disk = timed(lambda: flat_polytope(corners), 51)
    rod = flat_polytope([[0, 0, 0], [0.1, 0.2, 0.3]])
    print(f"\nmaking a 32-gon from its corners: {1e3 * making:.3f} ms\n")
    print(
        "| facets of L | of L + 32-gon | ms | ns per facet | of L + segment | ms | ns per facet |"
    )
    print("|---|---|---|---|---|---|---|")
    sizes, times = [], []
    for n in (100, 300, 1000, 3000, 10000, 30000):
        body = ellipsoid(rng, n)
        spent, total = timed(lambda: minkowski_sum(body, disk), 51)
        sizes.append(len(total.normals))
        times.append(spent)
        row = f"| {n} | {sizes[-1]} | {1e3 * spent:.3f} | {1e9 * spent / sizes[-1]:.0f} "
        spent, total = timed(lambda: minkowski_sum(body, rod), 51)
        facets = len(total.normals)
        print(row + f"| {facets} | {1e3 * spent:.3f} | {1e9 * spent / facets:.0f} |")
    print(f"\nexponent over the size of L + 32-gon: {exponent(sizes, times):.2f}")


def zonotopes(rng):
    """Print the time of zonotopes over the number of segments."""
    print("\n| segments | facets | ms | ns per facet |")
    print("|---|---|---|---|")
    for n in (10, 30, 100, 300):
        segments = rng.normal(size=(n, 3))
        spent, total = timed(lambda: zonotope(segments), 11)
        facets = len(total.normals)
        print(f"| {n} | {facets} | {1e3 * spent:.2f} | {1e9 * spent / facets:.0f} |")


def main():
    """Print all tables."""
    rng = np.random.default_rng(7)
    p, q = ellipsoid(rng, 20), ellipsoid(rng, 20)
    start = time.perf_counter()
    minkowski_sum(p, q)
    print(f"first sum (kernels compiled or read): {time.perf_counter() - start:.2f} s\n")
    compare(rng)
    growth(rng)
    add_contacts(rng)
    zonotopes(rng)


if __name__ == "__main__":
    main()
