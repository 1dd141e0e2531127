"""Plates on feet for tests, and the slow twin of their motion."""

import numpy as np
import shapely
from scipy.integrate import solve_ivp

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.geometry.part import Part

PLATE = Part([(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)], 20.0)
GRIP = 0.3 * PLATE.mass * 9.81  # of all feet together
RHO = (PLATE.inertia / PLATE.mass) ** 0.5


def sunflower(n, radius):
    """Return n points spread evenly over a disk."""
    k = np.arange(n)
    r = radius * np.sqrt((k + 0.5) / n)
    turn = k * np.pi * (3 - 5**0.5)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn)])


def on_feet(n):
    """Return n equal feet about the centre of mass."""
    angle = np.pi / 2 + 2 * np.pi * np.arange(n) / n
    ring = 0.04 * np.column_stack([np.cos(angle), np.sin(angle)])
    place = ring if n == 3 else sunflower(n, 0.05)
    return ContactSet(place - place.mean(axis=0), GRIP / n)


def round_part(inner, outer, density=20.0):
    """Return a disk or ring."""
    disk = shapely.Point(0, 0).buffer(outer, quad_segs=64)
    hole = shapely.Point(0, 0).buffer(inner, quad_segs=64) if inner else shapely.Point()
    return Part(disk.difference(hole), density)


def twin(part, feet, duration, *, pose=(0, 0, 0), twist=(0, 0, 0), load=None, drag=(0, 0, 0), eps):
    """Return the final pose by the regularised law ``m S S u / sqrt(|S u|^2 + eps^2)``."""
    S = feet.ellipse if feet.ellipse is not None else np.tile(np.eye(2), (len(feet), 1, 1))
    mass = np.array([part.mass, part.mass, part.inertia])

    def rates(t, y):
        cos, sin = np.cos(y[2]), np.sin(y[2])
        R = np.array([[cos, -sin], [sin, cos]])
        r = feet.position @ R.T
        u = np.column_stack([y[3] - y[5] * r[:, 1], y[4] + y[5] * r[:, 0]])
        w = np.einsum("nji,nj->ni", S, u @ R)
        e = w / np.sqrt((w * w).sum(axis=1) + eps * eps)[:, None]
        f = feet.offset - feet.radius[:, None] * np.einsum("nij,nj->ni", S, e)
        f = f @ R.T
        F = np.array([*f.sum(axis=0), (r[:, 0] * f[:, 1] - r[:, 1] * f[:, 0]).sum()])
        F = F - np.asarray(drag) * y[3:] + (0.0 if load is None else np.asarray(load(t)))
        return np.concatenate([y[3:], F / mass])

    y0 = np.array([*pose, *twist], dtype=float)
    found = solve_ivp(rates, (0, duration), y0, "LSODA", rtol=1e-10, atol=1e-13)
    return found.y[:3, -1]
