"""The programs of the fitted forms as one would first write them in cvxpy: a term for each pair."""

from collections import defaultdict
from dataclasses import replace
from itertools import combinations_with_replacement

import cvxpy as cp
import numpy as np

from limitsurf.conic.convex_form import FLOOR
from limitsurf.fitting.form_fit import linearised, loss_value, residuals


def naive_step(form, pairs, loss):
    """Return the coefficients that minimise the loss of a form near it, without offset.

    Squares stand for Huber's loss where it is quadratic; beyond, squares that touch it.
    """
    c = cp.Variable(len(form.c))
    terms = [
        0.5 * loss.shrinkage * cp.sum(cp.multiply(form.basis.norm, (c - form.basis.ball) ** 2))
    ]
    r, s = residuals(form, pairs)
    for i in range(len(pairs)):
        x = form.coordinates(pairs.loads[i : i + 1])
        G = form.frame.T @ form.basis.gradients(x)[0]
        m = form.basis.values(x)[0]
        g, h = G @ form.c, m @ form.c
        along = g / np.linalg.norm(g)
        turn = (np.eye(3) - np.outer(along, along)) @ (G @ c) / np.linalg.norm(g)
        grow = (m @ c - h) / (form.basis.degree * h)
        for change, now, noise in ((turn, r[i], loss.motion_noise), (grow, s[i], loss.load_noise)):
            size = np.linalg.norm(now) / noise
            bend = min(1.0, loss.huber / max(size, 1e-300))
            terms.append(0.5 * pairs.weight[i] * bend * cp.sum_squares((change + now) / noise))
    cp.Problem(cp.Minimize(sum(terms)), convexity(c, form.basis.degree)).solve(
        solver=cp.CLARABEL, tol_gap_abs=1e-9, tol_gap_rel=1e-9, tol_feas=1e-9
    )
    return c.value


def stacked_step(form, pairs, loss):
    """Return the same by one matrix of all residuals: cvxpy as its guide advises."""
    J, r = linearised(form, pairs, loss, False)
    c = cp.Variable(len(form.c))
    prior = np.sqrt(loss.shrinkage * form.basis.norm)
    away = cp.multiply(prior, c - form.basis.ball)
    objective = 0.5 * cp.sum_squares(J @ c + r) + 0.5 * cp.sum_squares(away)
    cp.Problem(cp.Minimize(objective), convexity(c, form.basis.degree)).solve(
        solver=cp.CLARABEL, tol_gap_abs=1e-9, tol_gap_rel=1e-9, tol_feas=1e-9
    )
    return c.value


def convexity(c, degree):
    """Return constraints: the Hessian form of c is ``z'Qz``, monomial by monomial, Q >= FLOOR."""
    powers = [
        tuple(t.count(i) for i in range(3)) for t in combinations_with_replacement(range(3), degree)
    ]
    basis = [(i, j) for i in range(3) for j in (range(3) if degree == 4 else [None])]  # y_i x_j
    Q = cp.Variable((len(basis), len(basis)), symmetric=True)
    gram, hessian = defaultdict(list), defaultdict(list)
    for a, (i, j) in enumerate(basis):
        for b, (k, m) in enumerate(basis):
            x = [n for n in (j, m) if n is not None]
            gram[tuple(sorted((i, k))), tuple(x.count(n) for n in range(3))].append(Q[a, b])
    for n, e in enumerate(powers):
        for i in range(3):
            for k in range(3):
                left = list(e)
                left[i] -= 1
                factor = e[i] * left[k]
                left[k] -= 1
                if factor > 0:
                    hessian[tuple(sorted((i, k))), tuple(left)].append(factor * c[n])
    matched = [sum(terms) == sum(hessian[key]) for key, terms in gram.items()]
    return [Q - FLOOR[degree] * np.eye(len(basis)) >> 0, *matched]


def naive_fit(form, pairs, loss, steps):
    """Return the form after so many full or halved steps of `naive_step`."""
    form = replace(form, value=loss_value(form, pairs, loss))
    for _ in range(steps):
        step = naive_step(form, pairs, loss) - form.c
        for share in 0.5 ** np.arange(20):
            new = replace(form, c=form.c + share * step)
            new = replace(new, value=loss_value(new, pairs, loss))
            if new.value <= form.value:
                form = new
                break
    return form
