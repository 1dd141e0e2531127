"""Contacts under an L-shaped part and loads with known answers, for the benchmarks."""

import numpy as np


def contacts(n, seed=0):
    """Return positions (N, 2) about the centre, in radii of gyration, radii and offsets."""
    rng = np.random.default_rng(seed)
    side = max(2, round(np.sqrt(n / 0.75)))
    grid = (np.arange(side) + 0.5) / side
    x, y = (a.ravel() for a in np.meshgrid(grid, grid, indexing="ij"))
    under = (x <= 0.5) | (y <= 0.5)
    place = np.column_stack([x, y])[under]
    place = (place - place.mean(axis=0) + [0.0004, -0.0002]) / 0.4
    radius = rng.uniform(0.8, 1.2, len(place)) / len(place)
    pushes = np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])[rng.integers(0, 4, len(place))]
    return place, radius, 0.3 * radius[:, None] * pushes


def friction(place, radius, v, without=None):
    """Return ``sum m_i G_i u_i/|u_i|`` at a twist, in long doubles."""
    x, y = place.astype(np.longdouble).T
    ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
    speed = np.hypot(ux, uy)
    m = radius.astype(np.longdouble)
    if without is not None:
        m[without], speed[without] = 0.0, 1.0
    fx, fy = m * ux / speed, m * uy / speed
    return np.array([fx.sum(), fy.sum(), (x * fy - y * fx).sum()], dtype=float)


def sliding(rng, place, radius, size=0.3):
    """Return a load and its closest point, for a part that slides."""
    v = size * rng.normal(size=3)
    F = friction(place, radius, v)
    return v + F, F


def rotating(rng, place, radius):
    """Return a load and its closest point, for a part that turns about a point within it."""
    center = place[rng.integers(len(place))] + 0.01 * rng.normal(size=2)
    v = 0.3 * np.array([center[1], -center[0], 1.0])
    F = friction(place, radius, v)
    return v + F, F


def pivoting(rng, place, radius):
    """Return a load and its closest point, for a part that turns about one of its contacts."""
    j = rng.integers(len(place))
    v = 0.3 * np.array([place[j, 1], -place[j, 0], 1.0])
    f = rng.normal(size=2)
    f *= 0.6 * radius[j] / np.hypot(*f)
    moment = place[j, 0] * f[1] - place[j, 1] * f[0]
    F = friction(place, radius, v, j) + np.array([*f, moment])
    return v + F, F


def stuck(rng, place, radius, share=0.5):
    """Return a load inside the sum, at a share of the way to its boundary."""
    F = share * friction(place, radius, rng.normal(size=3))
    return F, F


CASES = {
    "sliding": sliding,
    "turning within the part": rotating,
    "turning about a contact": pivoting,
    "stuck": stuck,
    "sliding at 1e-3": lambda *a: sliding(*a, size=1e-3),
    "stuck at 99.9 %": lambda *a: stuck(*a, share=0.999),
    "stuck at 1 - 1e-6": lambda *a: stuck(*a, share=1 - 1e-6),
    "on the boundary": lambda *a: stuck(*a, share=1.0),
}
