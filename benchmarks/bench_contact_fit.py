"""Time of the convex program of `ContactModel` for 1000 pairs, against the same stated in cvxpy.

The program: Huber's loss in the loads and the penalty on uneven pressure, over 217 cells.

Usage: python benchmarks/bench_contact_fit.py [pairs]
"""

import sys
import time

import cvxpy as cp
import numpy as np
from simulated_supports import pairs, support

from limitsurf.fitting.contact_fit import ContactFit, Contacts
from limitsurf.fitting.nonnegative import nonnegative_weights
from limitsurf.fitting.pressure_cells import polar_cells


def stated_in_cvxpy(residuals, penalty):
    """Return the weights and the least value, by Clarabel."""
    m = cp.Variable(residuals.X.shape[2], nonneg=True)
    rows = cp.vstack([X @ m - y for X, y in zip(residuals.X, residuals.y, strict=True)])
    loss = residuals.weight @ cp.huber(cp.norm(rows, 2, axis=1), residuals.delta)
    even = cp.sum_squares(cp.multiply(penalty.s, m))
    problem = cp.Problem(cp.Minimize(loss + even))
    problem.solve("CLARABEL")
    return m.value, problem.value


def main():
    """Print both times and values."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    rng = np.random.default_rng(0)
    loads, motions = pairs(support("ten", rng), n, rng)
    loads += 0.1 * rng.normal(size=loads.shape)
    weight = np.full(n, 1.0 / n)
    fit = ContactFit(loads, motions, weight, False, False, 0.0, (0.1, 0.15), 0.005, 0.1)
    contacts = Contacts.of_cells(polar_cells(3.0, 8))
    residuals, penalty = fit.in_loads(contacts), fit.penalty(contacts, 0.03)
    start = time.perf_counter()
    ours = nonnegative_weights(residuals, penalty)
    own = time.perf_counter() - start
    start = time.perf_counter()
    _, value = stated_in_cvxpy(residuals, penalty)
    theirs = time.perf_counter() - start
    print(f"{n} pairs, {len(contacts)} cells: {own:.3f} s against {theirs:.2f} s in cvxpy,")
    print(f"{theirs / own:.0f} times; least value {residuals.loss(ours) + penalty.loss(ours):.9f}")
    print(f"against {value:.9f}")


if __name__ == "__main__":
    main()
