"""Realise a field on a lattice: which actuator of each pixel runs, for how much of the time.

In each pixel one actuator runs at a time, so that the weight on a running tip is known. The ideal
push of a pixel is a combination of at most two of its actuators with shares of time >= 0, whose
sum is least (a linear program in the plane; its vertices are the pairs).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.actuators.activation import Activation
from limitsurf.actuators.actuator_array import ActuatorArray
from limitsurf.actuators.force_fields import Field
from limitsurf.actuators.pixel_lattice import PixelLattice, by_site
from limitsurf.errors import InputError

__all__ = ["RealisedField", "activate", "realise", "time_shares"]

Array = NDArray[np.float64]
Realisation = Literal["dither", "duty", "nearest"]


# Fractional parts of i/p^2 + j/p, p the plastic number, fill [0, 1) evenly over blocks of pixels,
# as in `activation`. Error diffusion was no better: between 1.5 times worse and better, by field.
_PATTERN = (1 / 1.324717957244746**2, 1 / 1.324717957244746)


@dataclass(frozen=True, eq=False)
class RealisedField:
    """Actuators of a lattice, with the share of time that each runs.

    Attributes
    ----------
    lattice : PixelLattice
        The lattice.
    field : callable
        The ideal field.
    duty : (n, m) float
        Share of time of every actuator; a pixel's sum is at most 1.
    scale : float
        The realised field is this times the ideal one, but for the error.
    """

    lattice: PixelLattice
    field: Field
    duty: Array
    scale: float

    @property
    def forces(self) -> Array:
        """Mean push of every actuator, (n, m, 2), over the nominal push."""
        return np.asarray(self.duty[..., None] * self.lattice.pushes)

    def __repr__(self) -> str:
        """Return how many actuators run."""
        return f"RealisedField({int((self.duty > 0).sum())} of {self.duty.size} actuators)"


def time_shares(pushes: Array, wanted: Array) -> Array:
    """Return shares (n, m) >= 0 of least sum with ``sum share_k push_k = wanted``.

    Parameters
    ----------
    pushes : (n, m, 2) float
        Pushes of the actuators, zero for dead ones.
    wanted : (n, 2) float
        Ideal pushes. Where no combination gives one, the nearest that one actuator gives.
    """
    n, m = pushes.shape[:2]
    best = np.full(n, np.inf)
    shares = np.zeros((n, m))
    size = np.linalg.norm(wanted, axis=-1)
    for k, j in combinations(range(m), 2):
        a, b = pushes[:, k], pushes[:, j]
        det = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            s = (wanted[:, 0] * b[:, 1] - wanted[:, 1] * b[:, 0]) / det
            t = (a[:, 0] * wanted[:, 1] - a[:, 1] * wanted[:, 0]) / det
        slack = 1e-12 * (1.0 + size)
        better = (np.abs(det) > 1e-9) & (s >= -slack) & (t >= -slack) & (s + t < best - slack)
        shares[better] = 0.0
        shares[better, k], shares[better, j] = (np.maximum(x[better], 0.0) for x in (s, t))
        best[better] = (s + t)[better]
    alone = ~np.isfinite(best)
    shares[alone] = _nearest_alone(pushes[alone], wanted[alone])
    return shares


def _nearest_alone(pushes: Array, wanted: Array) -> Array:
    """Return the shares of the single actuators whose multiples come nearest."""
    square = np.einsum("nmi,nmi->nm", pushes, pushes)
    along = np.einsum("nmi,ni->nm", pushes, wanted)
    share = np.divide(np.maximum(along, 0.0), square, out=np.zeros_like(along), where=square > 0.0)
    gain = share * along  # |wanted|^2 - |wanted - share push|^2
    chosen = np.arange(pushes.shape[1]) == gain.argmax(axis=1)[:, None]
    return np.asarray(np.where(chosen, share, 0.0))


def realise(lattice: PixelLattice, field: Field, method: Realisation = "dither") -> RealisedField:
    """Return which actuators run so that the lattice pushes like a field.

    Parameters
    ----------
    lattice : PixelLattice
        The lattice.
    field : callable
        Points (n, 2) [m] to forces (n, 2) in units of one actuator's push; see `force_fields`.
    method : {"dither", "duty", "nearest"}
        ``"duty"`` runs the actuators of a pixel in turn, for the shares of time that give the ideal
        push exactly. ``"dither"`` runs at most one, all the time, chosen by a fixed low-discrepancy
        pattern, so that neighbourhoods have the shares; weak pushes need large ones. ``"nearest"``
        runs the actuator nearest to the ideal direction where the push is at least half of its own:
        off by up to half the angle between directions.

    Notes
    -----
    Two directions at an angle give less between them than along them. The whole field is scaled by
    one factor, `scale`, so that every pixel can follow. The choice knows which actuators are dead,
    but not the strengths and directions of the others; a pixel whose dead actuator is needed does
    what the rest of it can.

    Examples
    --------
    >>> from limitsurf.actuators.force_fields import radial_field
    >>> from limitsurf.actuators.pixel_lattice import headings
    >>> lattice = PixelLattice.hexagonal(30, 30, 200e-6, headings(6))
    >>> realise(lattice, radial_field())
    RealisedField(867 of 5400 actuators)
    """
    if method not in ("dither", "duty", "nearest"):
        raise InputError("method", "is unknown", value=method, remedy="use dither, duty or nearest")
    wanted = np.asarray(field(lattice.pixel_centers), np.float64)
    if wanted.shape != lattice.pixel_centers.shape or not np.isfinite(wanted).all():
        raise InputError("field", "must give finite forces, as many as points", value=wanted.shape)
    shape = (len(wanted), *lattice.directions.shape)
    nominal = np.broadcast_to(lattice.directions, shape)
    running = np.where(lattice.spread.dead[..., None], 0.0, nominal)
    if method == "nearest":
        return RealisedField(lattice, field, _nearest(running, wanted), 1.0)
    most = float(time_shares(nominal, wanted).sum(axis=1).max())
    scale = 1.0 if most <= 1.0 else 1.0 / most
    shares = time_shares(running, scale * wanted)
    duty = shares / np.maximum(shares.sum(axis=1, keepdims=True), 1.0)
    if method == "dither":
        duty = _dithered(duty, lattice.index)
    return RealisedField(lattice, field, duty, scale)


def _nearest(pushes: Array, wanted: Array) -> Array:
    """Return a duty of 1 for the actuator nearest in direction, where the push is half of its."""
    size = np.linalg.norm(pushes, axis=-1)
    along = np.einsum("nmi,ni->nm", pushes, wanted)
    cosine = np.divide(along, size, out=np.full_like(along, -np.inf), where=size > 0.0)
    chosen = np.arange(pushes.shape[1]) == cosine.argmax(axis=1)[:, None]
    runs = chosen & (size > 0.0) & (along >= 0.5 * size**2) & (along > 0.0)
    return np.asarray(runs, np.float64)


def _dithered(shares: Array, index: NDArray[np.int64]) -> Array:
    """Return a duty of 1 for one actuator of each pixel or none, with the shares on average."""
    threshold = np.mod(0.5 + index @ np.array(_PATTERN), 1.0)
    upto = np.cumsum(shares, axis=1)
    before = upto - shares
    runs = (before <= threshold[:, None]) & (threshold[:, None] < upto)
    return np.asarray(runs, np.float64)


def activate(
    array: ActuatorArray, field: Field, method: Literal["dither", "nearest"] = "dither"
) -> Activation:
    """Return the activation of an array that pushes like a field, for `simulate`.

    Duty cycles need `realise`: an `Activation` runs all the time or not at all.

    Examples
    --------
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> from limitsurf.actuators.force_fields import uniform_field
    >>> activate(load_array("resonator32"), uniform_field(0.0))
    Activation(1024 of 4096 actuators)
    """
    if method not in ("dither", "nearest"):
        raise InputError("method", "is unknown", value=method, remedy="use dither or nearest")
    duty = realise(PixelLattice.from_array(array), field, method).duty
    return Activation(array, by_site(duty, array) > 0.5)
