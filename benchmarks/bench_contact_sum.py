"""Closest point of N contacts: limitsurf beside Clarabel, called directly, in one run.

Usage: python benchmarks/bench_contact_sum.py

One thread unless said. Positions are in radii of gyration, so that the metric is the identity;
errors are relative to ``sum m_i + |load|``, against answers known by construction.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time
import tracemalloc

import clarabel
import numba
import numpy as np
from contact_loads import CASES, contacts
from scipy import sparse
from timing import timed

import limitsurf as ls

WARM = 20


def clarabel_solve(place, radius, load):
    """Return the closest point by ``min 1/2 |v|^2 - c.v + m.t, |u_i| <= t_i``, a SOCP."""
    n = len(place)
    (x, y), r, one = place.T, np.arange(n), np.ones(n)
    rows = np.concatenate([3 * r, 3 * r + 1, 3 * r + 1, 3 * r + 2, 3 * r + 2])
    columns = np.concatenate([3 + r, 0 * r, 0 * r + 2, 0 * r + 1, 0 * r + 2])
    entries = np.concatenate([-one, -one, y, -one, -x])
    A = sparse.csc_matrix((entries, (rows, columns)), shape=(3 * n, 3 + n))
    P = sparse.csc_matrix((np.ones(3), (range(3), range(3))), shape=(3 + n, 3 + n))
    q, b, cones = (
        np.concatenate([-load, radius]),
        np.zeros(3 * n),
        [clarabel.SecondOrderConeT(3)] * n,
    )
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.presolve_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12

    def call():
        return load - np.array(clarabel.DefaultSolver(P, q, A, b, cones, settings).solve().x)[:3]

    return call


def beside_clarabel():
    """Print time and error of one call a solve."""
    print("| N | ours, us | error | passes | Clarabel, us | error | ratio |")
    print("|---|---|---|---|---|---|---|")
    for n in (10, 100, 1000, 10_000, 100_000):
        place, radius, _ = contacts(n)
        surface, rng, rows = (
            ls.ContactSet(place, radius).limit_surface(),
            np.random.default_rng(1),
            [],
        )
        for _ in range(7):
            load, F = CASES["sliding"](rng, place, radius)
            scale = radius.sum() + np.linalg.norm(load)
            fast, found = timed(lambda: surface.project(load), 200 if n < 1e4 else WARM)
            slow, theirs = timed(clarabel_solve(place, radius, load), 5 if n < 1e4 else 1)
            errors = np.linalg.norm(np.array([found.point, theirs]) - F, axis=1) / scale
            rows.append((fast, errors[0], int(found.iterations), slow, errors[1], slow / fast))
        fast, _, passes, slow, _, ratio = np.median(rows, axis=0)
        worst = np.max(rows, axis=0)
        print(
            f"| {len(place)} | {1e6 * fast:.1f} | {worst[1]:.0e} | {passes:.0f} | {1e6 * slow:.0f} "
            f"| {worst[4]:.0e} | {ratio:.0f} |"
        )


def passes():
    """Print passes over the contacts, cold; N = 1e5 starts from a few hundred cells."""
    print("\n| load | N = 10 | 1e3 | 1e5 | error | bound |\n|---|---|---|---|---|---|")
    for name, case in CASES.items():
        cells, worst = [], np.zeros(2)
        for n in (10, 1000, 100_000):
            place, radius, _ = contacts(n)
            surface, rng, counts = ls.ContactSum(place, radius), np.random.default_rng(2), []
            for _ in range(100 if n < 1e4 else 10):
                load, F = case(rng, place, radius)
                found = surface.project(load, sublinear=False)
                counts.append(int(found.iterations))
                scale = radius.sum() + np.linalg.norm(load)
                error = np.linalg.norm(found.point - F), float(found.error_bound)
                worst = np.maximum(worst, np.array(error) / scale)
            cells.append(f"{np.median(counts):.0f}, at most {max(counts)}")
        print(f"| {name} | " + " | ".join(cells) + f" | {worst[0]:.0e} | {worst[1]:.0e} |")


def trajectories():
    """Print passes when each load starts from the answer before."""
    print("\n| trajectory, steps of 0.01 rad | warm passes, mean (largest) | cold |\n|---|---|---|")
    t = 0.01 * np.arange(300)
    turn = np.column_stack([np.cos(t), np.sin(t), 0.5 * np.cos(0.7 * t)])
    paths = {
        "sliding": 2.0 * turn,
        "turning": np.column_stack([0.15 * np.cos(t), 0.15 * np.sin(t), 1.4 + 0 * t]),
        "stuck": 0.4 * turn,
        "stick and slip": (0.75 + 0.5 * np.sin(3 * t))[:, None] * turn,
    }
    place, radius, _ = contacts(1000)
    surface = ls.ContactSum(place, radius)
    for name, loads in paths.items():
        found, warm, cold = surface.project(loads[0]), [], []
        for load in loads[1:]:
            found = surface.project(load, start=found)
            warm.append(int(found.iterations))
            cold.append(int(surface.project(load).iterations))
        print(f"| {name} | {np.mean(warm):.1f} ({max(warm)}) | {np.mean(cold):.1f} |")


@numba.njit(fastmath=True)
def read_once(x, y, m, ax, ay):
    """Add up five arrays: the least that a look at all contacts can take."""
    total = 0.0
    for i in range(len(x)):
        total += x[i] + y[i] + m[i] + ax[i] + ay[i]
    return total


def a_million():
    """Print time, threads and memory at N = 1e6."""
    place, radius, offset = contacts(1_000_000)
    arrays = *(np.ascontiguousarray(a) for a in place.T), radius, *np.ascontiguousarray(offset.T)
    read_once(*arrays)
    floor, _ = timed(lambda: read_once(*arrays), 31)
    tracemalloc.start()
    surface = ls.ContactSet(place, radius, offset).limit_surface()
    rng = np.random.default_rng(3)
    loads = [CASES["sliding"](rng, place, radius)[0] + surface.center for _ in range(7)]
    surface.project(loads[0])
    peak = tracemalloc.get_traced_memory()[1] / sum(a.nbytes for a in arrays)
    tracemalloc.stop()
    one, two = (
        np.median(
            [timed(lambda: surface.project(c, threads=k, sublinear=False), 5)[0] for c in loads]
        )
        for k in (1, 2)
    )
    print(
        f"\nN = {len(place)}, cold: {1e3 * one:.2f} ms, {one / floor:.1f} times reading the five ",
        end="",
    )
    print(f"arrays once ({1e3 * floor:.2f} ms); two threads {one / two:.2f} times one")
    print(f"memory at the peak of construction and solve: {peak:.2f} times the input arrays")


def by_tree():
    """Print solves by moments beside direct ones, to 1e-9."""
    print("\n| N | load | build, ms | by moments, us | evaluations | bound | direct, us | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    times = {}
    for n in (10_000, 100_000, 1_000_000):
        place, radius, _ = contacts(n)
        surface = ls.ContactSum(place, radius)
        surface.project(np.ones(3))
        start = time.perf_counter()
        surface.project(np.ones(3), sublinear=True)
        build = time.perf_counter() - start
        for name in ("sliding", "turning within the part", "turning about a contact"):
            rng, rows = np.random.default_rng(4), []
            for _ in range(9):
                load, _ = CASES[name](rng, place, radius)
                scale = radius.sum() + np.linalg.norm(load)
                fast, found = timed(lambda: surface.project(load, sublinear=True, tol=1e-9), 5)
                slow, _ = timed(lambda: surface.project(load, sublinear=False, tol=1e-9), 3)
                rows.append((fast, int(found.iterations), float(found.error_bound) / scale, slow))
            fast, count, bound, slow = np.median(rows, axis=0)
            times[n, name] = fast
            print(
                f"| {len(place)} | {name} | {1e3 * build:.0f} | {1e6 * fast:.0f} | {count:.0f} "
                f"| {bound:.0e} | {1e6 * slow:.0f} | {slow / fast:.0f} |"
            )
    for name in ("sliding", "turning within the part", "turning about a contact"):
        growth = np.log(times[1_000_000, name] / times[10_000, name]) / np.log(100)
        print(f"{name}: time grows as N^{growth:.2f}")


def many():
    """Print the time of 10,000 problems of 30 contacts."""
    rng, k = np.random.default_rng(5), 10_000
    place, radius = rng.normal(size=(30 * k, 2)), rng.uniform(0.5, 1.5, 30 * k) / 30
    loads = rng.normal(size=(k, 3))
    ragged, _ = timed(lambda: ls.project_many((place, radius, np.full(k, 30)), loads), 5)
    sets = [
        ls.ContactSet(place[30 * i : 30 * i + 30], radius[30 * i : 30 * i + 30]) for i in range(k)
    ]
    listed, _ = timed(lambda: ls.project_many(sets, loads), 5)
    print(f"\n{k} problems of 30 contacts: {1e6 * ragged / k:.1f} us each from arrays, ", end="")
    print(f"{1e6 * listed / k:.1f} us from a list of ContactSets")


def main():
    """Print all tables."""
    start = time.perf_counter()
    ls.ContactSum([[0.0, 0.0], [1.0, 0.0]], [1.0, 1.0]).project([3.0, 2.0, 1.0])
    print(f"first call (compiled or read from the cache): {time.perf_counter() - start:.2f} s\n")
    for part in (beside_clarabel, passes, trajectories, a_million, by_tree, many):
        part()


if __name__ == "__main__":
    main()
