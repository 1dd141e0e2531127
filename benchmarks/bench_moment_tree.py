"""Sums over contacts: the quadtree of moments beside a direct pass, one thread, in one run.

Usage: python benchmarks/bench_moment_tree.py
"""

import numpy as np
from numba import njit
from timing import timed

from limitsurf.kernels.cell_sums import add_contacts
from limitsurf.kernels.moment_tree import tree_sums
from limitsurf.kernels.moment_tree_build import build_moment_tree

SIZES = (10**4, 10**5, 10**6)
TOLERANCES = (1e-9, 1e-12)
REPEATS = 20


def l_shaped_lattice(n):
    """Return about n sites of a square lattice under an L-shaped part of size 1."""
    side = round((n / 0.75) ** 0.5)
    line = (np.arange(side) + 0.5) / side
    x, y = np.meshgrid(line, line)
    under = ~((x > 0.5) & (y > 0.5))
    return x[under] - 0.4, y[under] - 0.4


def twists_about_points_inside(rng, x, y, count):
    """Yield twists about points between contacts, the dearest case."""
    for i in rng.integers(len(x), size=count):
        cx, cy = np.array([x[i], y[i]]) + 0.4 / np.sqrt(len(x)) * rng.normal(size=2)
        yield 0.3 * np.array([cy, -cx, 1.0])


@njit
def repeated(tree, v, tol, sums):
    """Call from compiled code, as a solver does."""
    bound = 0.0
    for _ in range(REPEATS):
        bound, _ = tree_sums(tree, v, -1, tol, sums)
    return bound


def measure(n, order):
    """Return build time in passes, time of a pass, and time and bound for each tolerance."""
    rng = np.random.default_rng(4)
    x, y = l_shaped_lattice(n)
    m = rng.uniform(0.5, 1.0, len(x))
    sums = np.zeros(11)
    build, tree = timed(lambda: build_moment_tree(x, y, m, order))
    vs = list(twists_about_points_inside(rng, x, y, 16))
    direct = np.median(
        [timed(lambda: add_contacts(x, y, m, v, 0.0, sums), 9 if n > 1e5 else 99)[0] for v in vs]
    )
    rows = []
    for tol in TOLERANCES:
        found = [timed(lambda: repeated(tree, v, tol, sums)) for v in vs]
        seconds = np.median([t for t, _ in found]) / REPEATS
        rows.append((seconds, max(bound for _, bound in found) / m.sum()))
    return build / direct, direct, rows


def main():
    """Print one row for each order and number of contacts, and the growth with that number."""
    measure(1000, 12)
    print("| order | N | build, passes | pass, us | tol | tree, us | certified | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for order in (12, 16):
        times = []
        for n in SIZES:
            build, direct, rows = measure(n, order)
            times.append([seconds for seconds, _ in rows])
            for tol, (seconds, bound) in zip(TOLERANCES, rows, strict=True):
                print(
                    f"| {order} | {n:.0e} | {build:.0f} | {1e6 * direct:.0f} | {tol:.0e} "
                    f"| {1e6 * seconds:.1f} | {bound:.1e} | {direct / seconds:.1f} |"
                )
        growth = np.log(np.divide(times[-1], times[0])) / np.log(SIZES[-1] / SIZES[0])
        print(f"order {order} grows as N^{growth[0]:.2f} and N^{growth[1]:.2f}\n")


if __name__ == "__main__":
    main()
