"""Time to fit limit surfaces to pairs, against the same programs stated pair by pair in cvxpy.

Run ``python benchmarks/bench_fitting.py``. Both take the same Gauss-Newton steps from the same
start to the same end, which is checked.
"""

import sys

import numpy as np
from naive_fits import naive_fit, naive_step, stacked_step
from timing import timed

from limitsurf.conic.convex_form import minimize_over_convex_forms
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.form_fit import FittedForm, FormLoss, fit_form, normal_equations
from limitsurf.fitting.form_start import ball_start
from limitsurf.fitting.forms import form_basis
from limitsurf.fitting.pairs import read_pairs
from limitsurf.fitting.quartic_model import QuarticModel

RHO = 0.05
LOSS = FormLoss(motion_noise=0.1, load_noise=0.1, huber=1.345, shrinkage=1.0)


def noisy_pairs(n, seed=0):
    """Return raw pairs on three feet, 10 % noise."""
    rng = np.random.default_rng(seed)
    feet = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], 1.0).limit_surface()
    twists = rng.normal(size=(n, 3)) * [1.0, 1.0, 20.0]
    loads = -feet.support_point(-twists)
    return loads + 0.1 * np.abs(loads).mean(axis=0) * rng.normal(size=(n, 3)), twists


def main(sizes=(50, 200, 1000)):
    print("one step and a whole fit (s); ours / cvxpy pair by pair, or all residuals in one matrix")
    for degree in (2, 4):
        for n in sizes:
            pairs = read_pairs(*noisy_pairs(n), None, RHO)
            ball, basis = ball_start(pairs, False), form_basis(degree)
            start = FittedForm(basis, basis.ball, ball.frame, ball.center)

            def step(form, pairs=pairs, degree=degree):
                return minimize_over_convex_forms(
                    *normal_equations(form, pairs, LOSS, False), degree
                )

            ours, c = timed(lambda: step(start), 9)
            naive, d = timed(lambda: naive_step(start, pairs, LOSS), 1)
            report(degree, n, "step", ours, naive, np.abs(c - d).max())
            stacked, d = timed(lambda: stacked_step(start, pairs, LOSS), 3)
            report(degree, n, "as matrix", ours, stacked, np.abs(c - d).max())
            ours, form = timed(lambda: fit_form(start, pairs, LOSS, False, 100), 5)
            steps = form.iterations
            naive, twin = timed(lambda: naive_fit(start, pairs, LOSS, steps), 1)
            report(degree, n, f"{steps} steps", ours, naive, np.abs(form.c - twin.c).max())
    loads, twists = noisy_pairs(1000)
    for model in (EllipsoidModel, QuarticModel):
        ours, fitted = timed(lambda: model(RHO).fit(loads, twists), 5)
        print(f"{fitted}.fit of 1000 pairs, noise estimated: {ours:.3f} s")


def report(degree, n, what, ours, naive, apart):
    ratio = naive / ours
    print(
        f"degree {degree}, {n:5d} pairs, {what:9s}: {ours:.4f} / {naive:7.3f} / {ratio:6.0f}x,"
        f" coefficients {apart:.0e} apart"
    )


if __name__ == "__main__":
    main(tuple(int(n) for n in sys.argv[1:]) or (50, 200, 1000))
