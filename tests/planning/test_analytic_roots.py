import numpy as np
import pytest

from limitsurf.planning.analytic_roots import analytic_roots


def test_simple_roots():
    roots = analytic_roots(np.sin, 0.5, 20.0)
    assert roots == pytest.approx(np.pi * np.arange(1, 7), abs=1e-13)


def test_roots_at_the_ends():
    assert analytic_roots(np.sin, 0.0, np.pi) == pytest.approx([0.0, np.pi], abs=1e-12)


def test_double_and_triple_roots_are_near():
    for power in (2, 3):
        roots = analytic_roots(lambda x, p=power: (x - 0.3) ** p, 0.0, 1.0)
        assert roots
        assert roots == pytest.approx([0.3] * len(roots), abs=3e-5)


def test_no_roots():
    assert analytic_roots(np.cosh, -1.0, 1.0) == []


def test_zero_function_returns_the_ends():
    assert analytic_roots(np.zeros_like, 0.0, 1.0) == [0.0, 1.0]


def test_nearly_singular_functions_are_resolved():
    roots = analytic_roots(lambda x: 1e-3 / (x + 1e-3) - 0.01, 0.0, 1.0)
    assert roots == pytest.approx([0.099], abs=1e-12)
