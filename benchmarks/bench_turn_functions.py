"""Turn functions of parts with many corners, beside scans and brute force.

Usage: python benchmarks/bench_turn_functions.py

One thread; least processor time of several runs. Convex parts: corners at random angles on an
ellipse or on a circle (a part that is nearly neutral), or at equal angles. The scan clips the part
with shapely at the median, whose offset it is given, and takes area and centroid of one half, in
40 of 40,000 directions. General parts: random simple polygons by recursive partition of random
points. Brute force: between the directions along all pairs of vertices the vertices keep their
order across the line; the sign of U' at all of these directions, from sums over all edges.
"""

import os
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import shapely

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.planning.turn_function import turn_function

SCAN, TRIED = 40_000, 40


def least_time(call, runs=5):
    """Return the least processor time of a call [s] and its last result."""
    times = []
    for _ in range(runs):
        start = time.thread_time()
        result = call()
        times.append(time.thread_time() - start)
    return min(times), result


def exponent(sizes, times):
    return np.polyfit(np.log(sizes), np.log(times), 1)[0]


def on_ellipse(angles, ratio):
    return Part(np.column_stack([np.cos(angles), ratio * np.sin(angles)]))


def shapely_scan(part, offsets):
    """Clip, area and centroid of the left half in TRIED directions."""
    shape = shapely.affinity.translate(part.polygon, *(-np.array(part.centroid)))
    reach = 3 * part.circumradius
    for k, z in enumerate(offsets):
        theta = np.pi * k / TRIED
        u, n = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
        ends = z * n - reach * u, z * n + reach * u
        half = shapely.intersection(
            shape, shapely.Polygon([*ends, ends[1] + reach * n, ends[0] + reach * n])
        )
        assert abs(half.area / part.area - 0.5) < 1e-9
        _ = half.centroid


def partition_polygon(rng, n):
    """Return a random simple polygon through n random points."""
    points = rng.random((n, 2))

    def side(a, b, rest):
        d = points[b] - points[a]
        r = points[rest] - points[a]
        return d[0] * r[:, 1] - d[1] * r[:, 0] > 0

    def chain(a, b, rest):
        """Return a path from a to b, without b, through the rest."""
        if len(rest) == 0:
            return [a]
        c = int(rng.choice(rest))
        rest = rest[rest != c]
        cut = points[a] + rng.random() * (points[b] - points[a])
        d, r = cut - points[c], points[rest] - points[c]
        of_a = d[0] * (points[a] - points[c])[1] - d[1] * (points[a] - points[c])[0] > 0
        near_a = (d[0] * r[:, 1] - d[1] * r[:, 0] > 0) == of_a
        return chain(a, c, rest[near_a]) + chain(c, b, rest[~near_a])

    a, b = 0, 1
    rest = np.arange(2, n)
    left = side(a, b, rest)
    return Part(points[chain(a, b, rest[left]) + chain(b, a, rest[~left])])


def brute_force(part):
    """Return how often the sign of U' changes over the directions along all pairs of vertices."""
    edges = part.unit_edges
    i, j = np.triu_indices(len(edges), 1)
    towards = edges[j, :2] - edges[i, :2]
    theta = np.sort(np.mod(np.arctan2(towards[:, 1], towards[:, 0]), np.pi))
    signs = np.sign(squeeze_states(edges, theta, 0.5)[:, 2])
    return np.count_nonzero(signs != np.roll(signs, 1))


def convex_parts():
    print(
        "| corners | n | part, ms | turn function, ms | equilibria | critical angle, ms | ", end=""
    )
    print("pieces, ms | shapely scan, s | ratio |\n|---|---|---|---|---|---|---|---|---|")
    for name in ("random on an ellipse", "random on a circle", "regular"):
        sizes, times = (1000, 10_000, 100_000), []
        for n in sizes:
            angles = np.sort(np.random.default_rng(n).uniform(0, 2 * np.pi, n))
            if name == "regular":
                angles = 2 * np.pi * np.arange(n) / n
            ratio = 0.7 if "ellipse" in name else 1.0
            build, part = least_time(lambda: on_ellipse(angles, ratio), 3)
            _ = part.unit_edges
            spent, turn = least_time(lambda: turn_function(part))
            times.append(spent)
            steepest, _ = least_time(lambda: turn_function(part).critical_angle, 3)
            pieces, _ = least_time(lambda: turn_function(part).pieces, 2)
            theta = np.pi * np.arange(TRIED) / TRIED
            offsets = squeeze_states(part.edges, theta, 0.5 * part.area)[:, 0]
            scan = least_time(lambda: shapely_scan(part, offsets), 1)[0] * SCAN / TRIED
            found = len(turn.stable) + len(turn.unstable)
            print(
                f"| {name} | {n} | {1e3 * build:.1f} | {1e3 * spent:.2f} | {found} "
                f"| {1e3 * (steepest - spent):.2f} | {1e3 * (pieces - spent):.0f} "
                f"| {scan:.0f} | {scan / spent:.0f} |",
                flush=True,
            )
        print(f"| {name} | exponent | | {exponent(sizes, times):.2f} | | | | | |", flush=True)


def general_parts():
    print("\n| n | turn function, ms | equilibria | pieces | both, ms | brute force, ms | ratio |")
    print("|---|---|---|---|---|---|---|")
    sizes, times, both = (30, 100, 300, 1000, 3000), [], []
    for n in sizes:
        parts = [partition_polygon(np.random.default_rng(seed), n) for seed in range(5)]
        spent, with_pieces, brute = [], [], []
        number, pieces = [], []
        for part in parts:
            _ = part.unit_edges
            t, turn = least_time(lambda part=part: turn_function(part))
            spent.append(t)
            t, _ = least_time(lambda part=part: turn_function(part).pieces, 3)
            with_pieces.append(t)
            number.append(len(turn.stable) + len(turn.unstable))
            pieces.append(len(turn.pieces))
            assert turn.certificate.complete
            if n <= 300:
                t, changes = least_time(lambda part=part: brute_force(part), 1)
                brute.append(t)
                assert changes <= number[-1]
        times.append(np.mean(spent))
        both.append(np.mean(with_pieces))
        slow = f"{1e3 * np.mean(brute):.1f} | {np.mean(brute) / both[-1]:.0f}" if brute else "|"
        print(
            f"| {n} | {1e3 * times[-1]:.2f} | {np.mean(number):.1f} | {np.mean(pieces):.0f} "
            f"| {1e3 * both[-1]:.2f} | {slow} |",
            flush=True,
        )
    print(f"| exponent | {exponent(sizes, times):.2f} | | | {exponent(sizes, both):.2f} | | |")


def main():
    """Print the tables."""
    start = time.perf_counter()
    turn = turn_function(on_ellipse(2 * np.pi * np.arange(7) / 7, 0.7))
    first = time.perf_counter() - start
    _ = turn.critical_angle, turn.pieces, turn.potential(0.0)
    squeeze_states(turn.part.unit_edges, np.zeros(1), 0.5)
    print(f"First call (kernels compiled or read): turn function {first:.2f} s, the rest ", end="")
    print(f"{time.perf_counter() - start - first:.2f} s.\n")
    convex_parts()
    general_parts()


if __name__ == "__main__":
    main()
