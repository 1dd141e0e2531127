"""How the time of a plan grows with the number of steps and of given lines.

Usage: python benchmarks/bench_plans.py
"""

import time

import numpy as np
from step_twins import naive_chain, random_steps, shortest_by_sets
from timing import timed

from limitsurf.errors import NoPlan
from limitsurf.planning.plan_lines import plan_lines
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.tolerances import LINE_MARGIN

SIZES = (125, 250, 500, 1000, 2000)
SEEDS = 3


def nearly_equal_steps(k, seed=0):
    """Return steps of which arcs grow by one step at a time: plans of about k lines."""
    widths = 1.0 + 1e-3 * np.random.default_rng(seed).permutation(k)
    breaks = np.append(0.0, np.cumsum(widths)) * (np.pi / widths.sum())
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    return SqueezeFunction(breaks[:-1], breaks[1:], middle, np.pi)


def growth(kind, steps):
    """Print times over the number of steps."""
    print(f"| {kind} steps m | lines | plan with largest margin, ms | least margin, deg |")
    print("|---|---|---|---|")
    times = []
    for m in SIZES:
        runs = [timed(lambda: plan_lines(steps(m, seed)), 3) for seed in range(SEEDS)]
        times.append(np.median([run[0] for run in runs]))
        lines = sorted(len(plan.lines) for _, plan in runs)
        margin = np.degrees(np.median([plan.least_margin for _, plan in runs]))
        print(f"| {m} | {lines[0]} to {lines[-1]} | {1e3 * times[-1]:.1f} | {margin:.1e} |")
    slope = np.polyfit(np.log(SIZES), np.log(times), 1)[0]
    print(f"\nexponent {slope:.2f} (median of {SEEDS} seeds)\n")


def naive(m=1000):
    """Compare with the triple loop over arcs, which does not even look for the margin."""
    squeeze = random_steps(np.random.default_rng(0), m)
    fast, plan = timed(lambda: plan_lines(squeeze), 3)
    start = time.perf_counter()
    chain = naive_chain(squeeze, 2 * LINE_MARGIN)
    slow = time.perf_counter() - start
    assert len(chain) == len(plan.lines)
    print(
        f"triple loop, m = {m}: {slow:.1f} s; here {1e3 * fast:.0f} ms: {slow / fast:.0f} times\n"
    )


def breadth_first(count=2000):
    """Compare lengths with breadth-first search over sets of images."""
    rng = np.random.default_rng(0)
    lengths = []
    for n in range(count):
        k = int(rng.integers(1, 8))
        squeeze = random_steps(rng, k, bands=n % 3 == 1, inside=n % 2 == 0)
        try:
            length = len(plan_lines(squeeze).lines)
        except NoPlan:
            length = None
        assert length == shortest_by_sets(squeeze)
        if n % 3 != 1:
            assert length <= 2 * k - 1
            lengths.append(length)
    print(
        f"{count} random step functions: all as long as breadth-first search, the longest "
        f"{max(lengths)} lines, none above 2 n - 1\n"
    )


def given_lines():
    """Print times for plans on evenly spaced lines."""
    print("| steps | given lines | plans | median, ms | slowest, ms |")
    print("|---|---|---|---|---|")
    for k, n in ((3, 4), (3, 8), (3, 16), (6, 16), (6, 36), (12, 36), (20, 36)):
        times, planned = [], 0
        for seed in range(8):
            squeeze = random_steps(np.random.default_rng(seed), k)
            start = time.perf_counter()
            try:
                plan_lines(squeeze, lines=n)
                planned += 1
            except NoPlan:
                pass
            times.append(time.perf_counter() - start)
        middle, slowest = 1e3 * np.median(times), 1e3 * max(times)
        print(f"| {k} | {n} | {planned} of 8 | {middle:.0f} | {slowest:.0f} |")


def main():
    """Print all tables."""
    plan_lines(random_steps(np.random.default_rng(0), 5))  # compiles
    growth("random", lambda m, seed: random_steps(np.random.default_rng(seed), m))
    growth("nearly equal", nearly_equal_steps)
    naive()
    breadth_first()
    given_lines()


if __name__ == "__main__":
    main()
