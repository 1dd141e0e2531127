r"""The programs behind `ContactModel`: first convex, in the loads, then with the motions added.

The unknowns are :math:`(m, c^+, c^-) \ge 0`: friction radii and, with an offset, both signs of the
load c that the contacts exert by themselves. The load that a motion v needs is
:math:`\sum m_k G_k e_k(v) - c`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.fitting.contact_slopes import load_slopes, motion_slopes
from limitsurf.fitting.nonnegative import Penalty, Residuals, least_squares, nonnegative_weights
from limitsurf.fitting.pressure_cells import PressureCells

__all__ = ["ContactFit", "Contacts"]

Array = NDArray[np.float64]

_BALANCE = 1e2  # weight of the centre of pressure against residuals of order 1
_STEPS, _SETTLED = 12, 1e-3  # Gauss-Newton steps, and the relative fall at which they end
_SHORTEST = 0.02  # share of a step below which none helps
_FREE = 0.1  # least share of the numbers measured that are taken to be free
_ROUNDING = 1e-14  # loss that is rounding: smoothing stays above it


@dataclass(frozen=True, eq=False)
class Contacts:
    """Places (N, 2) in rho, the shares (N,) of the area they stand for, and their cells, if any."""

    places: Array
    share: Array
    cells: PressureCells | None = None

    @classmethod
    def of_cells(cls, cells: PressureCells) -> Contacts:
        """Return the middles of cells."""
        return cls(cells.places, cells.area / cells.area.sum(), cells)

    def split(self, carries: NDArray[np.bool_]) -> Contacts:
        """Return finer contacts where some carry; given places stay."""
        return self if self.cells is None else self.of_cells(self.cells.split(carries))

    def __len__(self) -> int:
        """Return N."""
        return len(self.places)


@dataclass(frozen=True, eq=False)
class ContactFit:
    """Pairs, with loads of typical size 1, and what is asked of the fit; see `ContactModel`.

    Attributes
    ----------
    loads, motions : (n, 3) float
        Loads ``(fx, fy, m/rho)`` and unit motions ``(vx, vy, rho omega)``.
    weight : (n,) float
        Weights of sum 1.
    """

    loads: Array
    motions: Array
    weight: Array
    offset: bool
    balanced: bool
    motion_weight: float
    huber: tuple[float, float]
    smoothing: float
    width: float

    def in_loads(self, contacts: Contacts) -> Residuals:
        """Return the residuals of the loads."""
        X = load_slopes(self.motions, contacts.places, self.width)
        if self.offset:
            eye = np.broadcast_to(np.eye(3), (len(X), 3, 3))
            X = np.concatenate([X, -eye, eye], axis=2)
        return Residuals(X, self.loads, self.weight, self.huber[0])

    def in_motions(self, contacts: Contacts, m: Array) -> Residuals:
        """Return the residuals of the unit motions, linear around m."""
        N = len(contacts)
        pulls = self.loads + self.offset_of(m, N)
        unit, in_m, in_load = motion_slopes(pulls, contacts.places, m[:N], self.width)
        X = np.concatenate([in_m, in_load, -in_load], axis=2) if self.offset else in_m
        y = self.motions - unit + X @ m
        return Residuals(X, y, self.motion_weight * self.weight, self.huber[1])

    def offset_of(self, m: Array, count: int) -> Array:
        """Return the offset c (3,), zeros without one."""
        return m[count : count + 3] - m[count + 3 :] if self.offset else np.zeros(3)

    def penalty(self, contacts: Contacts, noise: float) -> Penalty:
        """Return the penalty on uneven pressure and on a centre of pressure off 0."""
        strength = np.sqrt((self.smoothing * noise + _ROUNDING) / contacts.share)
        balance = _BALANCE * contacts.places.T if self.balanced else np.empty((0, len(contacts)))
        more = 6 if self.offset else 0
        return Penalty(np.pad(strength, (0, more)), np.pad(balance, ((0, 0), (0, more))))

    def rough(self, contacts: Contacts) -> tuple[Array, float]:
        """Return the weights of least loss in the loads, hardly smoothed, and the noise left.

        The noise is the loss by the share of measured numbers that no weight in use takes up.
        """
        residuals = self.in_loads(contacts)
        m = nonnegative_weights(residuals, self.penalty(contacts, 0.0))
        free = 1.0 - np.count_nonzero(m) / self.loads.size
        return m, residuals.loss(m) / max(free, _FREE)

    def smooth(self, contacts: Contacts, rough: Array, noise: float) -> Array:
        """Return the weights of least loss in the loads and penalty: the convex problem."""
        return nonnegative_weights(self.in_loads(contacts), self.penalty(contacts, noise), rough)

    def with_motions(self, contacts: Contacts, m: Array, noise: float) -> Array:
        """Lower the loss of loads and motions together by Gauss-Newton steps from m."""
        in_loads, penalty = self.in_loads(contacts), self.penalty(contacts, noise)

        def value(m: Array) -> tuple[float, Residuals]:
            around = self.in_motions(contacts, m)
            return in_loads.loss(m) + around.loss(m) + penalty.loss(m), around

        lowest, around = value(m)
        for _ in range(_STEPS):
            rows = (
                np.concatenate(part) for part in zip(in_loads.rows(m), around.rows(m), strict=True)
            )
            step = least_squares(*penalty.added_to(*rows), m) - m
            before, share = lowest, 1.0
            while share > _SHORTEST:
                trial = m + share * step
                now, there = value(trial)
                if now < lowest:
                    m, lowest, around = trial, now, there
                    break
                share *= 0.5
            if before - lowest <= _SETTLED * before:
                break
        return m
