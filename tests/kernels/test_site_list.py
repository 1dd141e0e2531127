"""A list of sites against a Python set."""

import numpy as np
import pytest

from limitsurf.kernels.site_list import change_sites, new_site_list


@pytest.mark.parametrize("spread", [3, 40, 100_000])
def test_follows_a_set_through_changes(rng, spread):
    capacity = 200
    items, count, expected = new_site_list(capacity), 0, set()
    for _ in range(300):
        pool = rng.integers(-spread, spread, (30, 2))
        new = sorted({tuple(p) for p in pool.tolist()} - expected)[: capacity - len(expected)]
        old = [p for p in sorted(expected) if rng.random() < 0.2]
        entered = np.array(new, np.int32).reshape(-1, 2)
        count = change_sites(items, count, entered, np.array(old, np.int32).reshape(-1, 2))
        expected = (expected - set(old)) | set(new)
        assert count == len(expected)
        assert set(map(tuple, items.sites[:count].tolist())) == expected
        assert np.array_equal(np.sort(items.table[items.table >= 0]), np.arange(count))


def test_only_changed_places_are_written():
    """Removing k of n sites moves at most k others."""
    items = new_site_list(1000)
    sites = np.array([(r, c) for r in range(30) for c in range(30)], np.int32)
    nothing = np.empty((0, 2), np.int32)
    count = change_sites(items, 0, sites, nothing)
    before = items.sites[:count].copy()
    count = change_sites(items, count, nothing, sites[100:110])
    assert count == 890
    assert np.sum(np.any(items.sites[:count] != before[:count], axis=1)) == 10
