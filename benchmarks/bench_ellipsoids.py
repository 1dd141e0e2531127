"""Closest points of ellipsoids: ours beside Clarabel and SciPy's exact trust region, in one run.

Usage: python benchmarks/bench_ellipsoids.py
Errors against 50-digit arithmetic, relative to max(|p|, |c|, |A|); batches of 200 points.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time
from statistics import median

import clarabel
import mpmath as mp
import numpy as np
from scipy import sparse
from scipy.optimize._trustregion_exact import IterativeSubproblem

from limitsurf.sets.ellipsoid import Ellipsoid

BATCH = 200
FAMILIES = {
    "condition 3": [1.0, 0.6, 0.3],
    "condition 1e3": [1.0, 0.03, 1e-3],
    "condition 1e6": [1.0, 1e-3, 1e-6],
    "condition 1e12": [1.0, 1e-6, 1e-12],
    "rank 2 (a contact)": [1.0, 0.4],
    "rank 1": [1.0],
}


def exact(turn, s, p):
    """Return the closest point of ``{Q diag(s) u}`` to p in 50 digits."""
    with mp.workdps(50):
        Q = mp.qr(mp.matrix(turn.tolist()))[0]
        b = []
        for j in range(len(s)):
            sign = 1 if mp.fsum(Q[i, j] * turn[i, j] for i in range(3)) > 0 else -1
            b.append((sign, sign * mp.fsum(Q[i, j] * mp.mpf(float(p[i])) for i in range(3))))
        s = [mp.mpf(x) for x in s]

        def norm2(t):
            return mp.fsum((s[j] * b[j][1] / (s[j] ** 2 + t)) ** 2 for j in range(len(s)))

        t = mp.mpf(0)
        if norm2(t) > 1:
            low, high = mp.mpf(10) ** -60, mp.mpf(100) * mp.norm(mp.matrix(p.tolist()))
            for _ in range(300):
                middle = mp.sqrt(low * high)
                low, high = (middle, high) if norm2(middle) > 1 else (low, middle)
            t = high
        x = [
            mp.fsum(
                b[j][0] * Q[i, j] * s[j] ** 2 * b[j][1] / (s[j] ** 2 + t) for j in range(len(s))
            )
            for i in range(3)
        ]
        return np.array([float(v) for v in x])


def by_clarabel(A, p, settings):
    """Return the closest point by ``min 1/2 |g|^2, g = A u - p, |u| <= 1``."""
    k = A.shape[1]
    M = np.zeros((3 + k + 1, k + 3))
    M[:3, :k], M[:3, k:] = A, -np.eye(3)
    M[4:, :k] = -np.eye(k)
    b = np.concatenate([p, [1.0], np.zeros(k)])
    P = sparse.csc_matrix(np.diag(np.concatenate([np.zeros(k), np.ones(3)])))
    cones = [clarabel.ZeroConeT(3), clarabel.SecondOrderConeT(k + 1)]
    program = clarabel.DefaultSolver(P, np.zeros(k + 3), sparse.csc_matrix(M), b, cones, settings)
    return A @ np.array(program.solve().x)[:k]


def by_scipy(A, p):
    """Return the closest point by SciPy's More-Sorensen solver on A'A."""
    H, g = A.T @ A, -A.T @ p
    step = IterativeSubproblem(
        np.zeros(A.shape[1]), lambda u: 0.0, lambda u: g, lambda u: H, k_easy=1e-13, k_hard=1e-13
    ).solve(1.0)[0]
    return A @ step


def timed(call, points):
    """Return the median time of a call for one point [us] and all results."""
    times, results = [], []
    for p in points:
        start = time.perf_counter()
        results.append(call(p))
        times.append(time.perf_counter() - start)
    return 1e6 * median(times), np.array(results)


def main():
    """Print one row for each family."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    start = time.perf_counter()
    Ellipsoid(np.zeros(3), np.eye(3)).project([3.0, 0.0, 0.0])
    print(f"first call (kernel compiled or read): {time.perf_counter() - start:.2f} s\n")
    print(
        "| family | ours, us | error | Clarabel, us | error | SciPy, us | error | Clarabel / ours |"
    )
    print("|---|---|---|---|---|---|---|---|")
    rng = np.random.default_rng(3)
    for name, s in FAMILIES.items():
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0][:, : len(s)]
        A = turn * s
        points = rng.normal(size=(BATCH, 3)) * rng.uniform(0.3, 3.0, size=(BATCH, 1))
        E = Ellipsoid(np.zeros(3), A)
        E.project(points)
        runs = []
        for _ in range(15):
            start = time.perf_counter()
            ours = E.project(points).point
            runs.append(1e6 * (time.perf_counter() - start) / BATCH)
        few = points[:40]
        truth = np.array([exact(turn, s, p) for p in few])
        size = np.maximum(np.abs(few).max(axis=1), 1.0)

        def error(found, truth=truth, size=size):
            return (np.linalg.norm(found[:40] - truth, axis=1) / size).max()

        conic, by_cone = timed(lambda p: by_clarabel(A, p, settings), few)
        exact_trust, by_trust = timed(lambda p: by_scipy(A, p), few)
        print(
            f"| {name} | {median(runs):.2f} | {error(ours):.0e} "
            f"| {conic:.0f} | {error(by_cone):.0e} | {exact_trust:.0f} | {error(by_trust):.0e} "
            f"| {conic / median(runs):.0f} |"
        )


if __name__ == "__main__":
    main()
