"""Clouds of contacts, weights and twists that sums over contacts must get right."""

import numpy as np


def lattice(n, pitch=0.1):
    side = max(int(np.sqrt(n)), 1)
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    return pitch * x.ravel() - 0.3, pitch * y.ravel() - 0.2


def clusters(rng, n):
    centres = rng.normal(size=(2, 5))[:, rng.integers(5, size=n)]
    return centres + 1e-3 ** rng.integers(0, 4, n) * rng.normal(size=(2, n))


def clouds(rng, n):
    """Yield name and positions (x, y) of about n contacts."""
    x, y = rng.normal(size=(2, n))
    angle = rng.uniform(0.0, 2 * np.pi, n)
    yield "normal", x, y
    yield "lattice", *lattice(n)
    yield "clusters", *clusters(rng, n)
    yield "collinear", 0.3 * x + 0.1, -0.7 * x
    yield "along an axis", x, np.zeros(n)
    yield "coincident", np.full(n, 0.3), np.full(n, -0.2)
    yield "nearly coincident", 0.3 + 1e-9 * x, 0.2 + 1e-9 * y
    yield "far origin", x + 1e3, y - 2e3
    yield "tiny", 1e-9 * x, 1e-9 * y
    yield "huge", 1e6 * x, 1e6 * y
    yield "ring", np.cos(angle), np.sin(angle)


def weights(rng, n):
    """Yield weights: alike, spanning 1e12, and most of them zero."""
    yield rng.uniform(0.5, 1.0, n)
    yield 10.0 ** rng.uniform(-12.0, 0.0, n)
    yield (rng.random(n) < 0.3) * 1.0


def twists(rng, x, y):
    """Yield name and twist."""
    i = rng.integers(len(x))
    size = np.hypot(np.ptp(x), np.ptp(y)) + 1e-12
    dx, dy = rng.normal(size=2)

    def about(cx, cy, w):
        return w * np.array([cy, -cx, 1.0])

    yield "random", rng.normal(size=3)
    yield "about a contact", about(x[i], y[i], 1.0)
    yield "nearly about a contact", about(x[i] + 1e-12 * size * dx, y[i], -0.7)
    yield "about a point near a contact", about(x[i] + 1e-6 * size * dx, y[i], 0.3)
    yield "about a point inside", about(x.mean() + 0.2 * size * dx, y.mean(), 0.3)
    yield "about a point far away", about(100 * size * dx, 100 * size * dy, 1e-2)
    yield "about the origin", np.array([0.0, 0.0, 2.0])
    yield "translation", np.array([dx, dy, 0.0])
    for w in (-1e-5, 1e-12, 1e-200):
        yield f"translation, w = {w}", np.array([dx, dy, w])
    yield "hardly any", 1e-150 * about(x[i] + size * dx, y[i], 1.0)


def exact_sums(x, y, m, v):
    """Return the eleven sums of `tree_sums` in long double precision."""
    x, y, m, v = (np.asarray(a).astype(np.longdouble) for a in (x, y, m, v))
    ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
    speed = np.sqrt(ux * ux + uy * uy)
    inverse = np.divide(1, speed, out=np.zeros_like(speed), where=speed > 0)
    ex, ey, k = ux * inverse, uy * inverse, m * inverse
    cxx, cxy, cyy = k * ey * ey, -k * ex * ey, k * ex * ex
    wx, wy = x * cxy - y * cxx, x * cyy - y * cxy
    terms = (m * speed, m * ex, m * ey, m * (x * ey - y * ex))
    terms += (cxx, cxy, cyy, wx, wy, x * wy - y * wx, k)
    return np.array([term.sum() for term in terms])
