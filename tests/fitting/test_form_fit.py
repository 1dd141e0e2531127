from dataclasses import replace

import numpy as np
import pytest
from naive_fits import naive_step

from limitsurf.conic.convex_form import minimize_over_convex_forms
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import SolveFailed
from limitsurf.fitting.form_fit import (
    FittedForm,
    FormLoss,
    fit_form,
    loss_value,
    normal_equations,
    residuals,
)
from limitsurf.fitting.form_start import ball_start, weighted_median
from limitsurf.fitting.forms import form_basis
from limitsurf.fitting.pairs import read_pairs
from limitsurf.sets.ellipsoid import Ellipsoid
from tests.fitting.simulated import pairs_of

FEET = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], 1.0).limit_surface()
LOSS = FormLoss(motion_noise=0.1, load_noise=0.2, huber=1.345, shrinkage=0.7)


def noisy_pairs(n=25, seed=0):
    weight = np.random.default_rng(seed).uniform(0.5, 2.0, n)
    return read_pairs(*pairs_of(FEET, n, seed, noise=0.2), weight, 0.05)


def start(degree, pairs):
    ball = ball_start(pairs, False)
    return FittedForm(form_basis(degree), form_basis(degree).ball, ball.frame, ball.center)


@pytest.mark.parametrize("degree", [2, 4])
def test_a_step_is_that_of_the_plain_cvxpy_statement(degree):
    pairs = noisy_pairs()
    form = fit_form(start(degree, pairs), pairs, replace(LOSS, shrinkage=30.0), False, 500)
    fast = minimize_over_convex_forms(*normal_equations(form, pairs, LOSS, False), degree)
    np.testing.assert_allclose(fast, naive_step(form, pairs, LOSS), atol=3e-5)


@pytest.mark.parametrize("degree", [2, 4])
@pytest.mark.parametrize("offset", [False, True])
def test_the_program_has_the_slope_of_the_loss(degree, offset, rng):
    pairs = noisy_pairs()
    form = start(degree, pairs)
    form = replace(form, c=form.c + 0.1 * rng.normal(size=len(form.c)) * form.basis.ball)
    P, q = normal_equations(form, pairs, LOSS, offset)
    m, h = len(form.c), 1e-6
    slope = P @ np.concatenate([form.c, np.zeros(len(q) - m)]) + q
    for k, e in enumerate(h * np.eye(len(q))):
        center = np.linalg.solve(form.frame, e[m:]) if offset else np.zeros(3)
        moved = [
            replace(form, c=form.c + s * e[:m], center=form.center + s * center) for s in (-1, 1)
        ]
        low, high = (loss_value(f, pairs, LOSS) for f in moved)
        assert slope[k] == pytest.approx((high - low) / (2 * h), rel=1e-5, abs=1e-4)


def test_nothing_near_the_answer_is_better(rng):
    pairs = noisy_pairs()
    form = fit_form(start(4, pairs), pairs, LOSS, False, 500)
    E, ball = form.basis.exponents, form.basis.ball
    for _ in range(20):  # towards other convex forms: powers of linear forms
        a = rng.normal(size=3)
        other = np.array([np.prod(a**e) for e in E]) / form.basis.norm
        for target in (other, ball, other + ball):
            new = replace(form, c=form.c + 1e-3 * (target - form.c))
            assert loss_value(new, pairs, LOSS) > form.value * (1.0 - 1e-8)


def test_residuals_are_angles_and_relative_distances():
    surface = Ellipsoid(np.zeros(3), np.diag([2.0, 2.0, 0.1]))
    loads, twists = pairs_of(surface, 10)
    pairs = read_pairs(1.1 * loads, twists, None, 0.05)
    exact = FittedForm(form_basis(2), form_basis(2).ball, 0.5 * np.eye(3), np.zeros(3))
    r, s = residuals(exact, pairs)
    np.testing.assert_allclose(r, 0.0, atol=1e-12)
    np.testing.assert_allclose(s, np.log(1.1), rtol=1e-12)


def test_too_few_steps_are_an_error_that_carries_the_best():
    pairs = noisy_pairs()
    with pytest.raises(SolveFailed, match="still falls after 1 steps") as caught:
        fit_form(start(4, pairs), pairs, LOSS, False, 1)
    assert caught.value.best.value < loss_value(start(4, pairs), pairs, LOSS)


def test_start_is_exact_for_a_body_of_revolution():
    surface = Ellipsoid(np.zeros(3), np.diag([2.0, 2.0, 0.03]))
    pairs = read_pairs(*pairs_of(surface, 30), None, 0.05)
    np.testing.assert_allclose(ball_start(pairs, False).frame, np.diag([0.5, 0.5, 1 / 0.6]))


def test_weights_of_a_median_count_repeats(rng):
    values, counts = rng.normal(size=12), rng.integers(1, 5, 12)
    expected = np.median(np.repeat(values, counts))
    assert weighted_median(values, counts.astype(float)) == pytest.approx(expected, rel=1e-12)
