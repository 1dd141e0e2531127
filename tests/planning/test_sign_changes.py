"""Sign changes of periodic functions beside known roots, and gaps that must hold every zero."""

import numpy as np
import pytest

from limitsurf.planning.sign_changes import sign_changes

TURN = 2 * np.pi


def polynomial(rng, n):
    """Return a trigonometric polynomial, a bound of its slope, and its roots."""
    a, b = rng.normal(size=(2, n))
    k = np.arange(1, n + 1)

    def function(x):
        return np.cos(np.outer(x, k)) @ a + np.sin(np.outer(x, k)) @ b

    # in z = exp(i x): sum (a - i b)/2 z^k + (a + i b)/2 z^-k, times z^n
    upper = 0.5 * (a - 1j * b)
    roots = np.roots(np.concatenate([upper[::-1], [0.0], upper.conj()]))
    real = np.sort(np.mod(np.angle(roots[np.abs(np.abs(roots) - 1.0) < 1e-8]), TURN))
    return function, float(np.sum(k * np.hypot(a, b))), real


def test_all_roots_of_trigonometric_polynomials(rng):
    for n in (1, 2, 5, 12, 30):
        for _ in range(5):
            function, rise, roots = polynomial(rng, n)
            found = sign_changes(function, TURN, rise, noise=1e-13)
            both = np.sort(np.concatenate([found.rising, found.falling]))
            assert len(both) == len(roots)
            assert both == pytest.approx(roots, abs=1e-9)
            assert len(found.rising) == len(found.falling)
            assert (function(found.rising + 1e-6) > 0.0).all()
            assert (function(found.falling + 1e-6) < 0.0).all()
            assert found.isolated


def test_every_zero_lies_in_a_gap(rng):
    function, rise, roots = polynomial(rng, 9)
    gaps = sign_changes(function, TURN, rise, noise=1e-13).gaps
    for root in roots:
        offset = np.mod(root - gaps[:, 0], TURN)
        assert (offset <= gaps[:, 1] - gaps[:, 0]).any()
    assert np.diff(gaps).sum() < 1e-3


def test_steep_falls_are_allowed():
    """The bound is one-sided: a sawtooth climbs at most at slope 1 and falls in a step."""

    def saw(x):
        return np.mod(x - 1.0, TURN) - np.pi

    found = sign_changes(saw, TURN, 1.0, noise=1e-15)
    assert found.rising == pytest.approx([1.0 + np.pi], abs=1e-12)
    assert found.falling == pytest.approx([1.0], abs=1e-12)
    assert found.isolated


def test_a_narrow_pair_between_the_first_nodes_is_found():
    """A dip below zero as narrow as a hundredth of the spacing of the first nodes."""
    middle, half = 0.7123, 1e-4

    def dip(x):
        away = np.abs(np.mod(x - middle + np.pi, TURN) - np.pi)
        return np.minimum(away - half, 0.2)

    found = sign_changes(dip, TURN, 1.0, noise=1e-15)
    assert found.falling == pytest.approx([middle - half], abs=1e-12)
    assert found.rising == pytest.approx([middle + half], abs=1e-12)
    assert found.isolated


def test_zeros_without_change_are_gaps_only():
    found = sign_changes(lambda x: 1.0 + np.cos(x), TURN, 1.0, noise=1e-15)
    assert len(found.rising) == len(found.falling) == 0
    assert len(found.gaps) == 1
    assert found.gaps[0, 0] < np.pi < found.gaps[0, 1]


def test_nothing_but_noise_is_zero():
    found = sign_changes(lambda x: 1e-16 * np.sin(x), TURN, 1.0, noise=1e-15)
    assert found.zero
    assert not found.isolated


def test_without_a_bound_nothing_is_proven():
    found = sign_changes(np.sin, TURN, np.inf, noise=1e-15)
    assert found.rising == pytest.approx([0.0], abs=1e-12)
    assert not found.isolated
