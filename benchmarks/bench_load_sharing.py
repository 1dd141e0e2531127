"""Minimum-norm loads of many supports beside cvxpy with Clarabel on the same program, in one run.

Clarabel at its default tolerances, and at 1e-15, without which supports of nearly no load are off
by more than 1e-9. "Difference" is between the two answers, relative to the largest load.

Usage: python benchmarks/bench_load_sharing.py
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import warnings

import cvxpy as cp
import numpy as np
from timing import timed

from limitsurf.contacts.load_sharing import share_load

SIZES = (1000, 10_000, 100_000)
HEAD = (
    "supports",
    "loaded",
    "ours, ms",
    "steps",
    "residual",
    "cvxpy, ms",
    "difference",
    "ratio",
    "cvxpy at 1e-15, ms",
    "difference",
    "ratio",
)


def through_cvxpy(places, weight, center, tol):
    """Return the loads, in units of the mean load inside the program."""
    n = len(places)
    N = cp.Variable(n)
    balance = [cp.sum(N) == n, (places - center).T @ N == 0.0, N >= 0.0]
    program = cp.Problem(cp.Minimize(cp.sum_squares(N)), balance)
    options = {f"tol_{k}": tol for k in ("gap_abs", "gap_rel", "feas")} if tol else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # 1e-15 is reached, but called inaccurate
        program.solve(solver=cp.CLARABEL, **options)
    return N.value * weight / n


def main():
    """Print a row for each number of supports."""
    rng = np.random.default_rng(0)
    share_load(np.eye(3, 2), 1.0, [0.2, 0.2])
    print(f"| {' | '.join(HEAD)} |\n{'|---' * len(HEAD)}|")
    for n in SIZES:
        places, center = rng.uniform(-1.0, 1.0, (n, 2)), np.array([0.5, 0.3])
        fast, share = timed(lambda: share_load(places, 1.0, center), 9)
        loads = share.normal_force
        row = [f"{n}", f"{np.count_nonzero(loads)}", f"{1e3 * fast:.2f}"]
        row += [f"{share.iterations}", f"{share.residual:.0e}"]
        for tol in (None, 1e-15):
            slow, twin = timed(lambda: through_cvxpy(places, 1.0, center, tol), 3)
            gap = np.abs(twin - loads).max() / loads.max()
            row += [f"{1e3 * slow:.0f}", f"{gap:.0e}", f"{slow / fast:.0f}"]
        print(f"| {' | '.join(row)} |")


if __name__ == "__main__":
    main()
