"""The nearest contact against a search through all of them."""

import numpy as np
import pytest

from limitsurf.kernels.moment_tree_build import build_moment_tree
from limitsurf.kernels.nearest_contact import nearest_contact
from tests.kernels.clouds import clouds


@pytest.mark.parametrize("n", [1, 5, 300, 3000])
def test_is_the_nearest_of_all(rng, n):
    for name, x, y in clouds(rng, n):
        tree = build_moment_tree(x, y, np.ones(len(x)), 2, 16)
        size = np.hypot(np.ptp(x), np.ptp(y))
        for scale in (0.0, 1e-9, 0.1, 1.0, 100.0):
            j = rng.integers(len(x))
            px, py = np.array([x[j], y[j]]) + scale * size * rng.normal(size=2)
            i, distance = nearest_contact(tree, px, py)
            assert distance == pytest.approx(np.hypot(x - px, y - py).min(), rel=1e-12), name
            assert np.hypot(tree.x[i] - px, tree.y[i] - py) == pytest.approx(distance, rel=1e-12)


def test_without_contacts_there_is_none():
    none = np.empty(0)
    assert nearest_contact(build_moment_tree(none, none, none), 0.0, 0.0) == (-1, np.inf)
