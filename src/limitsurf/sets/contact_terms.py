r"""Sums of flat ellipsoids are sums of planar contacts.

A flat ellipsoid ``{c + A u : |u| <= 1}`` of loads, A of rank at most two, lies in a plane
``m = x f_y - y f_x`` unless that plane holds the moment axis: it is the load of an elliptic contact
at (x, y) with ``S^2 = A_f A_f'``, A_f the rows of forces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from limitsurf.sets.contact_sum import ContactSum
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid

__all__ = ["sum_of_contacts"]

Array = NDArray[np.float64]

_ROUNDING = 8 * float(np.finfo(np.float64).eps)


def sum_of_contacts(terms: Sequence[ConvexSet]) -> ContactSum | None:
    """Return the sum of flat ellipsoids and contact sums as one contact sum, None if it is none."""
    contacts = [_contacts_of(term) for term in terms]
    found = [c for c in contacts if c is not None]
    if len(found) < len(terms):
        return None
    radius = np.concatenate([c.radius for c in found])
    stretch = np.concatenate([_stretch_of(c) for c in found])
    disks = np.array_equal(stretch, np.tile([1.0, 0.0, 1.0], (len(radius), 1)))
    return ContactSum(
        np.concatenate([c.position for c in found]),
        radius,
        np.sum([c.center for c in found], axis=0),
        None if disks else stretch,
    )


def _stretch_of(contacts: ContactSum) -> Array:
    if contacts.stretch is None:
        return np.tile([1.0, 0.0, 1.0], (contacts.count, 1))
    return contacts.stretch


def _contacts_of(term: ConvexSet) -> ContactSum | None:
    if isinstance(term, ContactSum):
        return term
    if not isinstance(term, Ellipsoid) or term.dim != 3 or term.rank > 2:
        return None
    if term.rank == 0:
        return ContactSum(np.empty((0, 2)), np.empty(0), term.center)
    force, moment = term.axes[:2], term.axes[2]
    U, s, Vt = np.linalg.svd(force, full_matrices=False)
    kept = s > _ROUNDING * s[0]
    place = U[:, kept] @ ((Vt[kept] @ moment) / s[kept])  # least |(-y, x)| with its moments
    if np.abs(place @ force - moment).max() > _ROUNDING * np.abs(term.axes).max():
        return None
    S = (U * s) @ U.T
    radius = float(s[0])
    if np.abs(S - radius * np.eye(2)).max() <= _ROUNDING * radius:
        S = radius * np.eye(2)
    entries = np.array([[S[0, 0], S[0, 1], S[1, 1]]]) / radius
    return ContactSum([[place[1], -place[0]]], [radius], term.center, entries)
