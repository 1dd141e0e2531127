"""Pairs of load and motion on a known limit surface."""

import numpy as np


def pairs_of(surface, n, seed=0, noise=0.0):
    """Return applied loads and twists of n pairs, with relative noise of both."""
    rng = np.random.default_rng(seed)
    twists = rng.normal(size=(n, 3)) * [1.0, 1.0, 20.0]
    loads = -surface.support_point(-twists)
    loads = loads + noise * np.abs(loads).mean(axis=0) * rng.normal(size=(n, 3))
    return loads, twists + noise * np.abs(twists).mean(axis=0) * rng.normal(size=(n, 3))
