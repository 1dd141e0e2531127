r"""Fit a convex form to loads and motions: robust, regular, and through small programs only.

The set of applied loads is ``{F : H(L (F - a)) <= 1}``. Of a pair (F, v), with g the gradient of
``H(L (F - a))``, two residuals count: ``g/|g| - v`` of the motion, whose size is the angle, and
``log H / d`` of the load, the relative distance from the boundary along its ray. The fit minimises

.. math:: \sum_i w_i [\rho(|r_i|/\sigma_v) + \rho(s_i/\sigma_F)] + \lambda |c - c_0|^2

with Huber's loss :math:`\rho` and :math:`c_0` the ball, over convex forms c and, for active
contacts, offsets a. Gauss-Newton steps with reweighting (Huber and Ronchetti, Robust Statistics,
2009, section 7.8) have the data only in a matrix of the size of c: a program that does not grow
with the number of pairs. Steps are shortened until the sum falls; a line between two convex forms
holds convex forms only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from limitsurf.conic.convex_form import minimize_over_convex_forms
from limitsurf.errors import SolveFailed
from limitsurf.fitting.forms import FormBasis
from limitsurf.fitting.pairs import Pairs

__all__ = [
    "FittedForm",
    "FormLoss",
    "fit_form",
    "linearised",
    "loss_value",
    "normal_equations",
    "residuals",
]

Array = NDArray[np.float64]

_SETTLED = 1e-10  # relative decrease of the loss that ends the fit
_SHORTEST = 1e-6  # share of a step


@dataclass(frozen=True)
class FormLoss:
    r"""What counts as small: noise of motions [rad] and of loads (relative), bend, and prior.

    Attributes
    ----------
    motion_noise, load_noise : float
        Standard deviations :math:`\sigma_v, \sigma_F`.
    huber : float
        Residuals beyond this many standard deviations count linearly; infinity for squares only.
    shrinkage : float
        Weight :math:`\lambda` of the distance from the ball: one over the variance that
        coefficients are expected to have.
    estimated : tuple of str
        Which of the two noises are only first guesses, to be estimated from the residuals.
    """

    motion_noise: float
    load_noise: float
    huber: float
    shrinkage: float
    estimated: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class FittedForm:
    """The set ``{F : H(L (F - a)) <= 1}`` of applied loads, in newtons.

    Attributes
    ----------
    basis : FormBasis
        Monomials of H.
    c : (m,) float
        Coefficients of H.
    frame : (3, 3) float
        L [1/N].
    center : (3,) float
        a [N].
    iterations : int
        Gauss-Newton steps taken.
    value : float
        What was minimised.
    """

    basis: FormBasis
    c: Array
    frame: Array
    center: Array
    iterations: int = 0
    value: float = np.inf

    def coordinates(self, loads: Array) -> Array:
        """Return ``L (F - a)``."""
        return np.asarray((loads - self.center) @ self.frame.T)

    def gradients(self, loads: Array) -> Array:
        """Return the outer normals g (n, 3) at loads."""
        return np.asarray(self.basis.gradients(self.coordinates(loads)) @ self.c @ self.frame)


def fit_form(
    start: FittedForm, pairs: Pairs, loss: FormLoss, offset: bool, steps: int
) -> FittedForm:
    """Return the form of least loss near a start.

    Raises
    ------
    SolveFailed
        No minimum within `steps` steps; carries the best form.
    """
    form = replace(start, value=loss_value(start, pairs, loss))
    degree = form.basis.degree
    for count in range(1, steps + 1):
        P, q = normal_equations(form, pairs, loss, offset)
        x = minimize_over_convex_forms(P, q, degree)
        step = x - np.concatenate([form.c, np.zeros(len(x) - len(form.c))])
        new = _shortened(form, step, pairs, loss)
        done = not new.value < form.value * (1.0 - _SETTLED)
        form = replace(new if new.value <= form.value else form, iterations=count)
        if done:
            return form
    raise SolveFailed(f"fit: the loss still falls after {steps} steps", best=form)


def normal_equations(
    form: FittedForm, pairs: Pairs, loss: FormLoss, offset: bool
) -> tuple[Array, Array]:
    """Return P and q of one step: the loss near `form` is ``1/2 x'Px + q.x``, ``x = (c, L da)``."""
    J, r = linearised(form, pairs, loss, offset)
    P, q = J.T @ J, J.T @ r
    m = len(form.c)
    prior = loss.shrinkage * form.basis.norm
    P[:m, :m] += np.diag(prior)
    q[:m] -= prior * form.basis.ball
    return P, q


def linearised(form: FittedForm, pairs: Pairs, loss: FormLoss, offset: bool) -> tuple[Array, Array]:
    """Return J and r: weighted residuals near `form` are ``J (c, L da) + r``.

    The direction g/|g| does not change with the size of c, so that ``J c`` vanishes at `form`.
    """
    basis, L = form.basis, form.frame
    x = form.coordinates(pairs.loads)
    values = basis.values(x)
    G = np.einsum("ji,njk->nik", L, basis.gradients(x))
    g, h = G @ form.c, values @ form.c
    length = np.linalg.norm(g, axis=1)
    along = g / length[:, None]
    if offset:
        G = np.concatenate([G, -L.T @ basis.hessians(x, form.c)], axis=2)
        values = np.hstack([values, -basis.gradients(x) @ form.c])
    across = np.eye(3) - along[:, :, None] * along[:, None, :]
    motion = across @ G / length[:, None, None]
    r, s = residuals(form, pairs)
    wr, ws = (np.sqrt(w) for w in _weights(r, s, pairs.weight, loss))
    load = values / (basis.degree * h)[:, None]
    J = np.vstack([(motion * wr[:, None, None]).reshape(-1, motion.shape[2]), load * ws[:, None]])
    return J, np.concatenate([(r * wr[:, None]).ravel(), (s - 1.0 / basis.degree) * ws])


def residuals(form: FittedForm, pairs: Pairs) -> tuple[Array, Array]:
    """Return the residuals ``g/|g| - v`` (n, 3) and ``log H / d`` (n,)."""
    x = form.coordinates(pairs.loads)
    g = form.gradients(pairs.loads)
    r = g / np.linalg.norm(g, axis=1, keepdims=True) - pairs.motions
    return r, np.log(form.basis.values(x) @ form.c) / form.basis.degree


def _sizes(r: Array, s: Array, loss: FormLoss) -> tuple[Array, Array]:
    """Return the sizes of residuals in standard deviations of the noise."""
    return np.linalg.norm(r, axis=1) / loss.motion_noise, np.abs(s) / loss.load_noise


def _weights(r: Array, s: Array, weight: Array, loss: FormLoss) -> tuple[Array, Array]:
    """Return the weights of squares that touch Huber's loss from above at the residuals."""
    ur, us = _sizes(r, s, loss)
    bend = [np.minimum(1.0, loss.huber / np.maximum(u, 1e-300)) for u in (ur, us)]
    return weight * bend[0] / loss.motion_noise**2, weight * bend[1] / loss.load_noise**2


def loss_value(form: FittedForm, pairs: Pairs, loss: FormLoss) -> float:
    """Return the sum that the fit minimises."""
    total = 0.0
    for u in _sizes(*residuals(form, pairs), loss):
        square = np.minimum(u, loss.huber)  # beyond it the loss is linear
        total += float(pairs.weight @ (square * (u - 0.5 * square)))
    away = form.c - form.basis.ball
    return total + 0.5 * loss.shrinkage * float(form.basis.norm @ away**2)


def _shortened(form: FittedForm, step: Array, pairs: Pairs, loss: FormLoss) -> FittedForm:
    """Return the form after the longest of the halved steps by which the loss falls."""
    m, share = len(form.c), 1.0
    while True:
        move = share * step
        away = np.linalg.solve(form.frame, move[m:]) if len(move) > m else 0.0
        center = form.center + away
        new = replace(form, c=form.c + move[:m], center=center)
        new = replace(new, value=loss_value(new, pairs, loss))
        if new.value <= form.value or share < _SHORTEST:
            return new
        share *= 0.5
