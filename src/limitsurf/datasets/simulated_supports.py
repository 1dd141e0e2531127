"""Supports to test fits on: contacts of known friction under a part."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_count, as_positive

__all__ = ["SUPPORT_KINDS", "SupportKind", "make_support"]

Array = NDArray[np.float64]

SupportKind = Literal["ring", "square", "three points", "ten points", "bar"]
SUPPORT_KINDS: tuple[str, ...] = get_args(SupportKind)

_RING, _BAR, _SIDE = 60, 30, 12  # contacts of a ring, of a bar, along the side of a square


def make_support(
    kind: SupportKind,
    seed: int = 0,
    *,
    size: float = 0.05,
    friction: float = 1.0,
) -> ContactSet:
    """Return contacts about their centre of friction.

    Parameters
    ----------
    kind : {"ring", "square", "three points", "ten points", "bar"}
        A circle of radius `size`; a square of half side `size`, uniformly loaded; points anywhere
        in that square with random shares; a straight bar of half length `size`, turned at random.
    seed : int
        For points and the bar's direction.
    size : float
        Length [m].
    friction : float
        Sum of the friction radii [N].

    Notes
    -----
    Ring, bar and square are 60, 30 and 12 x 12 equal contacts: the limit surface is exactly that of
    these contacts. The shares of points are uniform between 0 and 1 before they are scaled. The
    reference point, origin of the positions, is where ``sum m r = 0``: the contacts' loads are in
    balance with a weight there if they share one friction coefficient.

    Examples
    --------
    >>> contacts = make_support("three points", seed=3, friction=2.0)
    >>> len(contacts), round(float(contacts.radius.sum()), 12)
    (3, 2.0)
    """
    if kind not in SUPPORT_KINDS:
        raise InputError("kind", "is unknown", value=kind, remedy=", ".join(SUPPORT_KINDS))
    total, half = as_positive("friction", friction), as_positive("size", size)
    places, share = _contacts(kind, np.random.default_rng(as_count("seed", seed, 0)))
    share = np.asarray(share / share.sum())
    return ContactSet(half * (places - share @ places), total * share)


def _contacts(kind: str, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return places and shares of contacts of size 1."""
    if kind == "ring":
        around = 2.0 * np.pi * np.arange(_RING) / _RING
        return np.column_stack([np.cos(around), np.sin(around)]), np.ones(_RING)
    if kind == "bar":
        angle = rng.uniform(0.0, np.pi)
        return np.outer(_midpoints(_BAR), [np.cos(angle), np.sin(angle)]), np.ones(_BAR)
    if kind == "square":
        x, y = np.meshgrid(_midpoints(_SIDE), _midpoints(_SIDE))
        return np.column_stack([x.ravel(), y.ravel()]), np.ones(_SIDE**2)
    count = 3 if kind == "three points" else 10
    return rng.uniform(-1.0, 1.0, size=(count, 2)), rng.uniform(0.0, 1.0, size=count)


def _midpoints(count: int) -> Array:
    """Return the midpoints of equal pieces of [-1, 1]."""
    return (2.0 * np.arange(count) + 1.0) / count - 1.0
