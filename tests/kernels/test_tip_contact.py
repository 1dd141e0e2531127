import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from limitsurf.kernels.tip_contact import (
    ContactLaw,
    half_angle,
    release_angle,
    tip_averages,
    tip_cells,
)

LAWS = [
    ContactLaw(10.0, 0.0, 1.0),
    ContactLaw(10.0, 0.03, 1.0),
    ContactLaw(3.0, 5.0, 1.0),
    ContactLaw(10.0, 0.0, 0.6),
    ContactLaw(10.0, 0.0, 0.0),
]
A = 1.2e-6


def force(law, level, phase):
    """Return N from the law as it is stated, with no closed form: the slow twin."""
    inside = A * (np.sin(phase) - level)
    if inside <= 0.0:
        return 0.0
    share = 1.0 if np.cos(phase) > 0.0 else law.restitution
    return max(law.stiffness * (share * inside + law.loss * A * np.cos(phase)), 0.0)


def by_quadrature(law, depth, weight):
    level = 1.0 - depth / A
    start, end = np.arcsin(level), np.pi - np.arcsin(level)
    if law.loss > 0.0:
        slope = law.loss
        end = brentq(lambda p: np.sin(p) - level + slope * np.cos(p), 0.5 * np.pi, end + 1e-12)
    pieces = [(start, 0.5 * np.pi), (0.5 * np.pi, end)]
    return sum(
        quad(lambda p: force(law, level, p) * weight(p), *piece, epsabs=0, epsrel=1e-12)[0]
        for piece in pieces
    ) / (2 * np.pi)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("depth", [1e-4 * A, 0.02 * A, 0.7 * A, 1.99 * A])
def test_averages_equal_quadrature(law, depth):
    push = tip_averages(law, A, depth)
    weights = {
        "mean": lambda p: 1.0,
        "cos": np.cos,
        "sin": np.sin,
        "signed": lambda p: np.sign(np.cos(p)),
        "signed_cos": lambda p: abs(np.cos(p)),
        "signed_sin": lambda p: np.sign(np.cos(p)) * np.sin(p),
    }
    for name, weight in weights.items():
        expected = by_quadrature(law, depth, weight)
        assert getattr(push, name) == pytest.approx(expected, rel=1e-7, abs=1e-9 * push.mean), name


@pytest.mark.parametrize("law", LAWS)
def test_slope_is_the_derivative(law):
    for depth in (0.05 * A, 1.2 * A):
        h = 1e-6 * depth
        up, down = tip_averages(law, A, depth + h), tip_averages(law, A, depth - h)
        assert tip_averages(law, A, depth).slope == pytest.approx(
            (up.mean - down.mean) / (2 * h), rel=1e-6
        )


def test_small_touches_keep_their_digits():
    """The mean of a lossless light touch is ``K a (2/3) alpha^3 / (2 pi)``, alpha^2 = 2 q/a."""
    law = LAWS[0]
    for depth in (1e-8 * A, 1e-12 * A):
        alpha = np.sqrt(2 * depth / A)
        light = law.stiffness * A * (2 / 3) * alpha**3 / (2 * np.pi)
        assert tip_averages(law, A, depth).mean == pytest.approx(light, rel=1e-7)


def test_restitution_divides_the_impulses():
    push = tip_averages(LAWS[3], A, 0.1 * A)
    assert push.signed / push.mean == pytest.approx(0.4 / 1.6, rel=1e-12)


def test_no_touch_no_force():
    assert tip_averages(LAWS[1], A, 0.0).mean == 0.0
    assert not tip_cells(LAWS[1], A, -1e-9, 16).any()


def test_damped_contact_is_released_early_and_never_pulls():
    law = LAWS[2]
    alpha = half_angle(0.3 * A, A)
    assert 0.0 < release_angle(alpha, law.loss) < alpha
    phase = np.linspace(0, 2 * np.pi, 4001)
    values = np.array([force(law, 0.7, p) for p in phase])
    running = phase[values > 0.0] - 0.5 * np.pi
    assert running.min() == pytest.approx(-alpha, abs=2e-3)
    assert running.max() == pytest.approx(release_angle(alpha, law.loss), abs=2e-3)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("depth", [0.02 * A, 0.7 * A])
def test_cells_are_means_of_the_force(law, depth):
    cells = tip_cells(law, A, depth, 64)
    fine = np.linspace(-0.5 * np.pi, 1.5 * np.pi, 64 * 400, endpoint=False) + np.pi / (64 * 400)
    sampled = np.array([force(law, 1 - depth / A, p) for p in fine]).reshape(64, 400).mean(axis=1)
    assert cells == pytest.approx(sampled, abs=5e-3 * cells.max())
    push = tip_averages(law, A, depth)
    assert cells.mean() == pytest.approx(push.mean, rel=1e-11)
    assert (cells[:32].sum() - cells[32:].sum()) / 64 == pytest.approx(
        push.signed, rel=1e-10, abs=1e-13 * push.mean
    )
