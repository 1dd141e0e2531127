"""Closest point of N contacts: the kernel beside Clarabel, called directly, in one run.

Usage: python benchmarks/bench_contact_sum.py
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time

import clarabel
import numpy as np
from scipy import sparse
from timing import timed

from limitsurf.kernels.contact_sum import solve_contact_sum

SIZES = (10, 100, 1000, 10000)


def problem(rng, n):
    """Return contacts and a load with a known sliding answer."""
    x, y = rng.uniform(-1, 1, (2, n))
    m = rng.uniform(0.8, 1.2, n) / n
    v = 0.3 * rng.normal(size=3)
    ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
    fx, fy = m * np.array([ux, uy]) / np.hypot(ux, uy)
    return x, y, m, v + np.array([fx.sum(), fy.sum(), (x * fy - y * fx).sum()])


def clarabel_program(x, y, m, c):
    """Return ``min 1/2 |g|^2`` over forces and gap g = sum G f - c, disks as second-order cones."""
    n = len(x)
    fx, fy = 2 * np.arange(n), 2 * np.arange(n) + 1
    ones = np.ones(n)
    rows = np.concatenate([np.zeros(n), np.ones(n), np.full(2 * n, 2)])
    columns = np.concatenate([fx, fy, fy, fx])
    loads = sparse.coo_matrix((np.concatenate([ones, ones, x, -y]), (rows, columns)), (3, 2 * n))
    equal = sparse.hstack([loads, -sparse.eye(3)])
    picks = sparse.coo_matrix(
        (
            -np.ones(2 * n),
            (
                np.concatenate([3 * np.arange(n) + 1, 3 * np.arange(n) + 2]),
                np.concatenate([fx, fy]),
            ),
        ),
        (3 * n, 2 * n + 3),
    )
    radii = np.zeros(3 * n)
    radii[::3] = m
    P = sparse.csc_matrix(sparse.diags(np.concatenate([np.zeros(2 * n), np.ones(3)])))
    A = sparse.csc_matrix(sparse.vstack([equal, picks]))
    cones = [clarabel.ZeroConeT(3)] + [clarabel.SecondOrderConeT(3)] * n
    return P, np.zeros(2 * n + 3), A, np.concatenate([c, radii]), cones


def main():
    """Print one row for each number of contacts."""
    rng = np.random.default_rng(0)
    start = time.perf_counter()
    solve_contact_sum(*problem(rng, 5), np.zeros(3), 1e-9)
    print(f"first call (compiled or read from the cache): {time.perf_counter() - start:.2f} s\n")
    print("| N | kernel, us | certified | passes | Clarabel, us | its difference | ratio |")
    print("|---|---|---|---|---|---|---|")
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    for n in SIZES:
        rows = []
        for _ in range(7):
            x, y, m, c = problem(rng, n)
            fast, (_, friction, bound, _, passes) = timed(
                lambda: solve_contact_sum(x, y, m, c, np.zeros(3), 1e-9), 20
            )
            program = clarabel_program(x, y, m, c)
            slow, solution = timed(
                lambda: clarabel.DefaultSolver(*program, settings).solve(), 3 if n < 1e4 else 1
            )
            closest = c + np.array(solution.x[-3:])
            scale = m.sum() + np.linalg.norm(c)
            rows.append(
                (fast, bound / scale, passes, slow, np.linalg.norm(closest + friction) / scale)
            )
        fast, bound, passes, slow, gap = np.median(rows, axis=0)
        print(
            f"| {n} | {1e6 * fast:.1f} | {bound:.0e} | {passes:.0f} | {1e6 * slow:.0f} "
            f"| {gap:.0e} | {slow / fast:.0f} |"
        )


if __name__ == "__main__":
    main()
