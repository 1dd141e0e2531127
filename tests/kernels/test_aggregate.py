"""Few contacts that stand for many: their sum lies in the sum over all."""

import numpy as np
import pytest

from limitsurf.kernels.aggregate import aggregate
from limitsurf.sets.contact_sum import ContactSum
from tests.kernels.clouds import clouds, weights


@pytest.mark.parametrize("side", [1, 2, 24])
def test_friction_and_centroids_are_kept_and_the_sum_shrinks(rng, side):
    for name, x, y in clouds(rng, 700):
        for m in weights(rng, len(x)):
            few = aggregate(x, y, m, side)
            assert 1 <= len(few[0]) <= side * side
            assert np.all(few[2] > 0.0)
            assert few[2].sum() == pytest.approx(m.sum(), rel=1e-12)
            reach = np.abs(x).max() + np.abs(y).max()
            assert few[2] @ few[0] == pytest.approx(m @ x, abs=1e-12 * m.sum() * reach)
            assert few[2] @ few[1] == pytest.approx(m @ y, abs=1e-12 * m.sum() * reach)
            all_ = ContactSum(np.column_stack([x, y]), m)
            inner = ContactSum(np.column_stack(few[:2]), few[2])
            d = rng.normal(size=(20, 3)) / [1.0, 1.0, reach]
            whole = all_.support(d)
            assert np.all(inner.support(d) <= whole * (1 + 1e-12)), name


def test_a_fine_grid_loses_little(rng):
    x, y = rng.uniform(-1.0, 1.0, (2, 20_000))
    few = aggregate(x, y, np.ones(len(x)), 24)
    d = rng.normal(size=(50, 3))
    whole = ContactSum(np.column_stack([x, y]), np.ones(len(x))).support(d)
    part = ContactSum(np.column_stack(few[:2]), few[2]).support(d)
    assert np.all(part >= 0.995 * whole)


def test_one_contact_and_one_place():
    x, y, m = aggregate(np.array([3.0]), np.array([4.0]), np.array([2.0]), 24)
    assert (x[0], y[0], m[0]) == (3.0, 4.0, 2.0)
    x, y, m = aggregate(np.full(5, 3.0), np.full(5, -1.0), np.arange(5.0), 24)
    assert (x.tolist(), y.tolist(), m.tolist()) == ([3.0], [-1.0], [10.0])
