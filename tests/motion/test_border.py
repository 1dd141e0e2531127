"""Shares of tips on the outline: complementarity, crossing, sliding, dependent tips."""

import numpy as np
import pytest

from limitsurf.errors import SolveFailed
from limitsurf.motion.array_events.border import free_tips, settle, solve_free


def linear(A, b):
    return lambda s: A @ s + b


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_shares_meet_the_conditions(rng, k):
    """Random rates with a definite matrix: one solution, found from any start."""
    for _ in range(50):
        B = rng.normal(size=(k, k))
        A = -(B @ B.T) - 0.2 * np.eye(k) + 0.3 * (B - B.T)
        rates = linear(A, rng.normal(size=k))
        found = settle(rates, rng.uniform(size=k), 1.0)
        g = rates(found)
        assert np.all((found >= 0.0) & (found <= 1.0))
        assert np.all(g[found < 1.0] <= 1e-10)
        assert np.all(g[found > 0.0] >= -1e-10)
        again = settle(rates, np.ones(k), 1.0)
        assert again == pytest.approx(found, abs=1e-9)


@pytest.mark.parametrize(
    ("rate", "start", "end"),
    [
        ((1.0, 2.0), 0.0, 1.0),  # crosses to the inside
        ((-1.0, -2.0), 1.0, 0.0),  # and to the outside
        ((1.0, -3.0), 0.0, 0.25),  # is captured
        ((-1.0, 1.0), 1.0, 1.0),  # leaves on the side where it is
        ((-1.0, 1.0), 0.0, 0.0),
        ((0.0, 0.0), 0.5, 0.5),  # moves along the border whatever it does
    ],
)
def test_one_tip(rate, start, end):
    found = settle(
        linear(np.array([[rate[1] - rate[0]]]), np.array(rate[:1])), np.array([start]), 1.0
    )
    assert found == pytest.approx([end], abs=1e-12)


def test_tips_that_move_together_keep_their_shares():
    """Rank two for four tips: two follow, the others stay, and all rates vanish."""
    rng = np.random.default_rng(3)
    J = rng.normal(size=(4, 2))
    rates = linear(-J @ J.T, J @ J.T @ np.full(4, 0.4))
    found = settle(rates, np.array([0.2, 0.9, 0.5, 0.3]), 1.0)
    assert np.abs(rates(found)).max() < 1e-10
    free = free_tips(rates, found, np.arange(4), 1.0)
    assert len(free) == 2
    moved = linear(-J @ J.T, J @ J.T @ np.full(4, 0.41))
    shares = solve_free(moved, found, np.arange(4), free, 1.0)
    assert np.abs(moved(shares)).max() < 1e-12
    kept = np.setdiff1d(np.arange(4), free)
    assert np.array_equal(shares[kept], found[kept])


def test_rates_that_turn_without_end_are_refused():
    """No continuous rates lack a solution; discontinuous ones say so."""
    k = 7
    rates = lambda s: np.where(s < 0.5, 1.0, -1.0) + 0.0 * np.arange(k)  # noqa: E731
    with pytest.raises(SolveFailed, match="no shares found for 7 tips"):
        settle(rates, np.zeros(k), 1.0)
