"""Simulated supports of unit friction, of root mean square radius 1 m: ring, square, feet, bar."""

import numpy as np

from limitsurf.sets.contact_sum import ContactSum

SUPPORTS = ("ring", "square", "three", "ten", "bar")
_FINE = 400  # contacts that stand for a line of friction


def support(kind, rng):
    """Return a support; three and ten feet have random places and shares, balanced about 0."""
    if kind == "ring":
        angle = 2.0 * np.pi * (np.arange(_FINE) + 0.5) / _FINE
        return _of(np.column_stack([np.cos(angle), np.sin(angle)]), np.ones(_FINE))
    if kind == "bar":
        along = (np.arange(_FINE) + 0.5) / _FINE - 0.5
        return _of(np.column_stack([along, np.zeros(_FINE)]), np.ones(_FINE))
    if kind == "square":
        along = (np.arange(30) + 0.5) / 30 - 0.5
        return _of(np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2), np.ones(900))
    count = {"three": 3, "ten": 10}[kind]
    while True:
        places = rng.uniform(-1.0, 1.0, (count, 2))
        share = rng.uniform(0.2, 1.0, count)
        places -= share @ places / share.sum()
        narrow, wide = np.sort(np.linalg.svd(places, compute_uv=False))
        if narrow > 0.3 * wide:  # feet in a line are the bar's case
            return _of(places, share)


def _of(places, share):
    share = share / share.sum()
    return ContactSum(places / np.sqrt(share @ (places**2).sum(axis=1)), share)


def pairs(surface, n, rng):
    """Return applied loads and random unit motions (n, 3)."""
    v = rng.normal(size=(n, 3))
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    return -surface.support_point(-v), v
