"""Closest points of many small contact sets at once."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError, SolveFailed
from limitsurf.kernels.project_loads import (
    BOUNDS,
    COLUMNS,
    COUNTS,
    DISTANCES,
    NORMALS,
    POINTS,
    STATUSES,
    TWISTS,
)
from limitsurf.kernels.project_ragged import project_ragged
from limitsurf.sets.arguments import as_array, as_points, check_effort, read_metric
from limitsurf.sets.projection import Projection, Status
from limitsurf.tolerances import CONTACT_SUM

__all__ = ["project_many"]

Array = NDArray[np.float64]
_ARRAYS = "give (position, radius, counts[, offset])"
Ragged = tuple[Array, Array, Array, Array]  # positions, radii, offsets or none, counts


def project_many(
    contacts: Sequence[ContactSet] | tuple[Any, ...],
    loads: ArrayLike,
    metric: ArrayLike | None = None,
    *,
    tol: float = CONTACT_SUM,
    threads: int = 1,
    throw: bool = True,
) -> Projection:
    """Return the closest point of each of K limit surfaces to its load.

    Parameters
    ----------
    contacts : sequence of K ContactSets, or ``(position, radius, counts[, offset])``
        Disks only. As arrays: contacts of all problems one after the other, (M, 2) [m] and (M,)
        [N], the number of contacts of each problem (K,), and offsets (M, 2) [N].
    loads : (K, 3) float
        A load for each problem [N, N, N m].
    metric : (3, 3) or (3,) float, optional
        W, the same for all.
    tol : float
        Error bound asked for, as in `ContactSum.project`.
    threads : int
        Threads to use; answers do not depend on it.
    throw : bool
        Raise `SolveFailed` if a problem failed; False marks it with `Status.FAILED`.

    Examples
    --------
    >>> pair = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.5)
    >>> project_many([pair, pair], [[0.0, 0.0, 3.0], [0.2, 0.0, 0.0]]).distance.round(12)
    array([2., 0.])
    >>> project_many(([[1.0, 0.0], [-1.0, 0.0]], [0.5, 0.5], [2]), [[0.0, 0.0, 3.0]]).inside
    array([False])
    """
    check_effort(tol, threads)
    try:
        given = list(contacts)
    except TypeError as error:
        raise InputError("contacts", "are neither ContactSets nor arrays") from error
    sets = [c for c in given if isinstance(c, ContactSet)]
    if len(sets) == len(given):
        position, radius, offset, counts = _from_sets(sets)
    elif not sets and 3 <= len(given) <= 4:
        position, radius, offset, counts = _from_arrays(*given)
    else:
        raise InputError("contacts", "are neither ContactSets nor arrays", remedy=_ARRAYS)
    points, shape = as_points("loads", loads, 3)
    if shape != (len(counts),):
        raise InputError("loads", f"has shape {np.shape(loads)}, not ({len(counts)}, 3)")
    x, y = np.array(position.T)
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    answers, C = np.empty((len(points), COLUMNS)), read_metric(metric, 3).C

    def solve(first: int, last: int) -> None:
        project_ragged(x, y, radius, offset, start, points, C, tol, first, last, answers)

    shares = np.linspace(0, len(points), threads + 1).astype(int).tolist()
    if threads > 1:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(solve, shares[:-1], shares[1:]))
    else:
        solve(0, len(points))
    status = answers[:, STATUSES].astype(np.int64)
    projection = Projection(
        point=answers[:, POINTS],
        distance=answers[:, DISTANCES],
        normal=answers[:, NORMALS],
        twist=answers[:, TWISTS],
        error_bound=answers[:, BOUNDS],
        iterations=answers[:, COUNTS].astype(np.int64),
        status=status,
    )
    if throw and (failed := int((status == Status.FAILED).sum())):
        raise SolveFailed(
            f"project_many: {failed} of {len(status)} problems {Status.FAILED!s}", best=projection
        )
    return projection


def _from_arrays(
    position: ArrayLike, radius: ArrayLike, counts: ArrayLike, offset: ArrayLike | None = None
) -> Ragged:
    places = as_array("position", position, None, 2)
    n = len(places)
    m = np.array(as_array("radius", radius, n))
    push = np.array(as_array("offset", np.empty((0, 2)) if offset is None else offset, None, 2))
    number = as_array("counts", counts, None)
    if offset is not None and len(push) != n:
        raise InputError("offset", f"has shape {push.shape}, not ({n}, 2)")
    if (number != number.astype(np.int64)).any() or (number < 0).any() or number.sum() != n:
        raise InputError("counts", f"must be whole numbers >= 0 that add up to {n}")
    if (m < 0.0).any():
        raise InputError("radius", "has negative entries", remedy="friction radii are >= 0")
    return places, m, push, number.astype(np.int64)


def _from_sets(contacts: Sequence[ContactSet]) -> Ragged:
    for i, c in enumerate(contacts):
        if c.ellipse is not None or c.sides is not None:
            raise InputError(f"contacts[{i}]", "are no disks", remedy="call its project()")
    if not contacts:
        return np.empty((0, 2)), np.empty(0), np.empty((0, 2)), np.empty(0, dtype=np.int64)
    active = any(c.active for c in contacts)
    return (
        np.concatenate([c.position for c in contacts]),
        np.concatenate([c.radius for c in contacts]),
        np.concatenate([c.offset for c in contacts]) if active else np.empty((0, 2)),
        np.array([len(c) for c in contacts]),
    )
