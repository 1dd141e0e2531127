"""Contact sums with loads the closest points of which are known by construction.

A twist v is chosen, and the force of each contact from it, ``m u/|u|``; where u = 0 any force in
the disk will do. In extended precision the sum F of their loads is then the point of the sum
closest to ``p = F + W^-1 v``, and the answer's twist is -v.
"""

from typing import NamedTuple

import numpy as np

Long = np.longdouble

METRICS = ("identity", "diagonal", "coupled")


class Cases(NamedTuple):
    """Loads (k, 3), closest points as long doubles, and how far these may be off, in the metric."""

    names: list
    loads: np.ndarray
    closest: np.ndarray
    slack: np.ndarray


def clouds(rng, n):
    """Yield name, positions (n, 2) and radii (n,)."""
    r, m = rng.normal(size=(n, 2)), rng.uniform(0.1, 1.0, n)
    groups = rng.normal(size=(max(n // 3, 1), 2))[rng.integers(max(n // 3, 1), size=n)]
    yield "generic", r, m
    yield "coincident groups", groups, m
    yield "one place", np.tile(rng.normal(size=2), (n, 1)), m
    yield "nearly coincident", groups + 1e-9 * rng.normal(size=(n, 2)), m
    yield "collinear", np.outer(rng.normal(size=n), rng.normal(size=2)) + rng.normal(size=2), m
    yield "along an axis", np.column_stack([r[:, 0], np.zeros(n)]), m
    yield "radii spanning 1e12", r, 10.0 ** rng.uniform(-12.0, 0.0, n)
    yield "many without friction", r, m * (rng.random(n) < 0.5)
    yield "one dominant", r, np.where(np.arange(n) == n // 2, 100.0 * n, m)
    yield "far origin", r + 1e3 * rng.normal(size=2), m
    yield "tiny", 1e-9 * r, m
    yield "tiny and far", 1e-4 * r + rng.normal(size=2), m
    yield "lattice", 0.1 * rng.integers(0, 5, (n, 2)), np.full(n, 0.25)


def metric(rng, kind, size=1.0):
    """Return W for contacts of a radius of gyration `size`; None for the identity."""
    if kind == "identity":
        return None
    diagonal = np.array([1.0, 10.0 ** rng.uniform(-1, 1), 10.0 ** rng.uniform(-1, 1) / size**2])
    if kind == "diagonal":
        return np.diag(diagonal)
    L = np.sqrt(diagonal)[:, None] * (np.tril(rng.normal(size=(3, 3)), -1) + np.eye(3))
    W = L @ L.T
    return (W + W.T) / 2


def gyration(position, radius):
    """Return the radius of gyration, 1 if the contacts lie much closer together than the origin."""
    total = radius.sum()
    if total == 0.0:
        return 1.0
    middle = radius @ position / total
    size = np.sqrt(radius @ ((position - middle) ** 2).sum(axis=1) / total)
    return float(size) if size > 1e-5 * np.linalg.norm(middle) else 1.0


def inverse(W):
    """Return the inverse of a symmetric 3 x 3 matrix in extended precision."""
    W = np.asarray(W).astype(Long)
    C = np.array([np.cross(W[1], W[2]), np.cross(W[2], W[0]), np.cross(W[0], W[1])])
    return C.T / (W[0] @ C[0])


def load_of(position, forces):
    """Return ``sum G f`` in extended precision."""
    (x, y), (fx, fy) = position.astype(Long).T, np.asarray(forces).astype(Long).T
    return np.array([fx.sum(), fy.sum(), (x * fy - y * fx).sum()])


def velocities(position, v):
    """Return ``G' v`` (N, 2) in extended precision."""
    x, y = position.astype(Long).T
    return np.column_stack([v[0] - v[2] * y, v[1] + v[2] * x])


def forces_of(position, radius, v, rng):
    """Return ``m u/|u|``, and random forces in the disks of contacts that stand still."""
    u = velocities(position, v)
    speed = np.sqrt((u**2).sum(axis=1))
    still = speed == 0
    angle, part = rng.uniform(0, 2 * np.pi, len(u)), np.sqrt(rng.random(len(u)))
    chosen = part[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    speed[still] = 1
    return radius[:, None] * np.where(still[:, None], chosen, u / speed[:, None])


def about(point, w):
    """Return the rotation w about a point, exactly if w has few digits."""
    x, y = np.asarray(point).astype(Long)
    return w * np.array([y, -x, Long(1)])


def twists(rng, position, radius):
    """Yield name and twist; rotations about a contact are exact."""
    n, size = len(position), gyration(position, radius)
    middle = position.mean(axis=0) if n else np.zeros(2)
    w = float(rng.choice([-0.75, 0.5, 1.0, -1.25, 1.5]))
    dx, dy = rng.normal(size=2)
    yield "any", about(middle + size * rng.normal(size=2), w)
    yield "rotation about the middle", about(middle, w)
    yield "translation", np.array([dx, dy, 0.0]).astype(Long)
    yield "nearly a translation", np.array([dx, dy, 1e-9 / size]).astype(Long)
    yield "about a point far away", about(middle + 100 * size * rng.normal(size=2), w)
    if n:
        i, j = rng.integers(n, size=2)
        yield "about a contact", about(position[i], w)
        yield "about another contact", about(position[j], -w)
        yield "between two contacts", about((position[i] + position[j]) / 2, w)
        for power in (3, 6, 9, 12):
            near = position[i] + 10.0**-power * size * np.array([dx, dy])
            yield f"1e-{power} beside a contact", about(near, w)


def norm(W, e):
    """Return the lengths of the rows of e in the metric, in extended precision."""
    W = np.eye(3) if W is None else W
    e = np.atleast_2d(e)
    return np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", e, np.asarray(W).astype(Long), e), 0))


def cases(rng, position, radius, W):
    """Return loads of every kind: fast, slow, on the boundary to 1e-9, stuck."""
    Q = np.eye(3).astype(Long) if W is None else inverse(W)
    total = max(radius.sum(), 1e-300) if len(radius) else 1.0
    names, exact, closest = [], [], []

    def add(name, load, point):
        names.append(name)
        exact.append(load)
        closest.append(point)

    for name, v in twists(rng, position, radius):
        F = load_of(position, forces_of(position, radius, v, rng))
        Qv = Q @ v
        Qv *= total * norm(W, np.array([1.0, 0.0, 0.0]))[0] / norm(W, Qv)[0]
        for size in (30.0, 1.0, 1e-3, 1e-6, 1e-9):
            add(f"{name}, slides by {size:g}", F + Long(size) * Qv, F)
        for inside in (1e-9, 1e-6, 1e-2):
            add(f"{name}, inside by {inside:g}", (1 - Long(inside)) * F, (1 - Long(inside)) * F)
    for part in (0.0, 0.3, 0.9):
        angle = rng.uniform(0.0, 2 * np.pi, len(radius))
        forces = part * radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        F = load_of(position, forces)
        add(f"stuck at {part:g}", F, F)
    exact, closest = np.array(exact), np.array(closest)
    loads = exact.astype(np.float64)
    return Cases(names, loads, closest, norm(W, loads - exact))
