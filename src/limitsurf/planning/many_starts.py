"""Stationary poses of a potential from many starts, where nothing is known of its shape."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.potential_field import LoadField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part

__all__ = ["stationary_poses"]

Array = NDArray[np.float64]
Function = Callable[[Array], Array]

_STARTS = 400
_STEPS = 100
_GATHERING, _FIRST_STEP, _SHRINK = 40, 0.7, 0.88
_SEED = 7
_AT_REST = 1e-10  # of the loads that the starts feel
_SAME = 1e-6  # circumradii and radians


def stationary_poses(
    part: Part, field: LoadField, centers: Array, flat: Array
) -> tuple[Array, NDArray[np.int64]]:
    """Return distinct poses without load (k, 3), by orientation, and their indices (k,).

    The Levenberg-Marquardt method on the load from random poses near the hull of the centres, two
    thirds of which first go with or against the force in position, since loads often do not
    change where a part lies beside the borders of a field. Flat directions are left out.
    Degenerate families of equilibria come as many poses.
    """
    R = part.circumradius
    unit, across = np.array([R, R, 1.0]), np.eye(2) - flat.T @ flat
    project = np.block([[across, np.zeros((2, 1))], [np.zeros((1, 2)), np.ones((1, 1))]])

    def loads(q: Array) -> Array:
        return np.asarray(field.load(part, q) * unit @ project)

    def slopes(q: Array) -> Array:
        J = field.jacobian(part, q) * unit * unit[:, None]
        return np.asarray(project @ J @ project)

    starts = _starts(R, centers)
    scale = float(np.abs(loads(starts)).max())
    if not scale > 0.0:
        raise InputError("field", "does not push the part", remedy="give a density")
    starts = _gathered(loads, starts, R)
    q = _levenberg_marquardt(lambda q: loads(q) / scale, lambda q: slopes(q) / scale, starts, unit)
    rest = np.abs(field.load(part, q) * unit).max(axis=1) <= _AT_REST * scale
    found = _distinct(q[rest], unit, across)
    eigenvalues = np.linalg.eigvalsh(-slopes(found) / scale)
    return found, np.sum(eigenvalues < -1e-9, axis=1).astype(np.int64)


def _starts(R: float, centers: Array) -> Array:
    rng = np.random.default_rng(_SEED)
    hub = centers if len(centers) else np.zeros((1, 2))
    share = rng.dirichlet(np.ones(len(hub)), _STARTS)
    around = rng.uniform(-3.0 * R, 3.0 * R, (_STARTS, 2))
    return np.column_stack([share @ hub + around, rng.uniform(0.0, 2 * np.pi, _STARTS)])


def _gathered(loads: Function, q: Array, R: float) -> Array:
    """Return poses after ever shorter steps with the force, against it, or none."""
    q, sense = q.copy(), np.resize([1.0, -1.0, 0.0], len(q))
    for k in range(_GATHERING):
        F = loads(q)[:, :2]
        size = np.linalg.norm(F, axis=1, keepdims=True)
        way = np.divide(F, size, out=np.zeros_like(F), where=size > 0.0)
        q[:, :2] += (_FIRST_STEP * R * _SHRINK**k * sense)[:, None] * way
    return q


def _levenberg_marquardt(loads: Function, slopes: Function, q: Array, unit: Array) -> Array:
    q, damping = q.copy(), np.full(len(q), 1e-2)
    L = loads(q)
    for _ in range(_STEPS):
        J = slopes(q)
        normal = np.swapaxes(J, 1, 2) @ J + damping[:, None, None] * np.eye(3)
        step = np.linalg.solve(normal, -np.swapaxes(J, 1, 2) @ L[:, :, None])[:, :, 0]
        trial = q + step * unit
        there = loads(trial)
        better = np.linalg.norm(there, axis=1) < np.linalg.norm(L, axis=1)
        q[better], L[better] = trial[better], there[better]
        damping = np.clip(np.where(better, 0.2 * damping, 5.0 * damping), 1e-14, 1e3)
    return q


def _distinct(q: Array, unit: Array, across: Array) -> Array:
    """Return one pose of each cluster, reduced to orientations in [0, 2 pi)."""
    q = q.copy()
    q[:, 2] = np.mod(q[:, 2], 2 * np.pi)
    q[2 * np.pi - q[:, 2] < _SAME, 2] = 0.0
    kept: list[Array] = []
    for pose in q[np.argsort(q[:, 2], kind="stable")]:
        gaps = (np.array(kept).reshape(-1, 3) - pose) / unit
        gaps[:, :2] = gaps[:, :2] @ across
        if not (np.abs(gaps).max(axis=1) < _SAME).any():
            kept.append(pose)
    return np.array(kept).reshape(-1, 3)
