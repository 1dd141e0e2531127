r"""The limit surface of contacts with unknown friction, fitted to loads and motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.fitting.base import LimitSurfaceModel
from limitsurf.fitting.contact_fit import ContactFit, Contacts
from limitsurf.fitting.contact_slopes import motions_under
from limitsurf.fitting.pairs import Pairs
from limitsurf.fitting.pressure_cells import polar_cells
from limitsurf.sets.arguments import as_array, as_count, as_number
from limitsurf.sets.contact_sum import ContactSum

__all__ = ["ContactModel"]

Array = NDArray[np.float64]

_REACH = 3.0  # radius of the grid in rho: feet of a part are seldom farther out
_GAIN, _SHARPEN = 0.9, 0.25  # finer cells and a lower width must bring the noise below _GAIN
_ENOUGH = 1e-9  # noise, a relative error of 0.003 % squared, below which nothing is refined
_NOTHING = 1e-9  # weights below this, relative to the largest, carry nothing


class ContactModel(LimitSurfaceModel):
    r"""Friction of contacts: on given feet, or on a grid for an unknown distribution of pressure.

    .. math:: B = \{-c + \sum_k G_k f_k : |f_k| \le m_k\}, \qquad m \ge 0

    The load that a motion v needs is linear in the friction radii m, so that the loss in the loads,
    with a penalty on uneven pressure, is a convex problem. From its solution the loss in the
    motions is added, and lowered by Gauss-Newton steps on ``m >= 0``.

    Parameters
    ----------
    rho : float
        Length that makes moments forces [m].
    positions : (N, 2) float, optional
        Feet, or grid points under the outline, from the reference point [m]. Without them, the
        cells of a disk of radius ``3 rho``, split where they carry.
    offset : bool
        Also fit the load c that active contacts exert by themselves.
    balanced : bool
        The centre of pressure is the reference point, as under a part's own weight with one
        friction coefficient, about its centre of mass.
    motion_weight : float
        Weight of the loss in unit motions, against that in loads of typical size 1; 0 leaves the
        convex problem alone.
    huber : (2,) float, optional
        Errors of loads, relative to their typical size, and of motions [rad] from which the loss
        grows linearly; None for squares.
    smoothing : float
        Penalty ``sum m_k^2 / a_k``, a_k the area shares, relative to the noise of the loads.
    width : float
        Speed, relative to the motion's, below which a contact's slip has no sharp direction.
    rings : int
        Rings of the grid.
    refine : int
        Times that cells may be split; they are while it lowers the noise.

    Attributes
    ----------
    surface_ : ContactSum
        What the contacts exert on the part.
    positions_ : (K, 2) float
        Contacts that carry [m].
    radii_ : (K,) float
        Their friction radii [N].
    carries_ : (N,) bool
        Which of the feet given, or of the grid's cells, carry.
    offset_ : (3,) float
        The load c [N, N, N m].
    noise_ : float
        Estimated loss per pair of the loads alone, relative to their typical size squared.

    Notes
    -----
    Weights of pairs are relative: they do not tell how many pairs there are, of which the estimated
    noise, and so the smoothing, depends.

    Examples
    --------
    >>> v = np.random.default_rng(0).normal(size=(40, 3))
    >>> feet = ContactSum([[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]], [2.0, 1.0, 1.0])
    >>> model = ContactModel(1.0, [[1, 0], [-1, 1], [-1, -1], [0, 0]]).fit(feet.support_point(v), v)
    >>> model.radii_.round(3)
    array([2., 1., 1.])
    """

    def __init__(
        self,
        rho: float = 0.05,
        positions: ArrayLike | None = None,
        *,
        offset: bool = False,
        balanced: bool = False,
        motion_weight: float = 3.0,
        huber: tuple[float, float] | None = (0.1, 0.15),
        smoothing: float = 0.005,
        width: float = 0.1,
        rings: int = 8,
        refine: int = 4,
    ) -> None:
        self.rho = rho
        self.positions = positions
        self.offset = offset
        self.balanced = balanced
        self.motion_weight = motion_weight
        self.huber = huber
        self.smoothing = smoothing
        self.width = width
        self.rings = rings
        self.refine = refine

    @property
    def _least_pairs(self) -> int:
        return 3

    @property
    def _passive(self) -> bool:
        return not self.offset

    def _fit(self, pairs: Pairs) -> ContactSum:
        size = pairs.force
        fit = self._program(pairs, size)
        fit, contacts, m = self._convex(fit)
        if fit.motion_weight > 0.0:
            m = fit.with_motions(contacts, m, self.noise_)
        radii = m[: len(contacts)]
        self.carries_ = radii > _NOTHING * radii.max(initial=0.0)
        self.positions_ = contacts.places[self.carries_] * pairs.rho
        self.radii_ = radii[self.carries_] * size
        self.offset_ = fit.offset_of(m, len(contacts)) * size * [1.0, 1.0, pairs.rho]
        return ContactSum(self.positions_, self.radii_, self.offset_)

    def _program(self, pairs: Pairs, size: float) -> ContactFit:
        """Return the fit to pairs, loads by their typical size, with checked options."""
        load, motion = (np.inf, np.inf) if self.huber is None else self.huber
        return ContactFit(
            pairs.loads / size,
            pairs.motions,
            pairs.weight / pairs.weight.sum(),
            offset=bool(self.offset),
            balanced=bool(self.balanced),
            motion_weight=_at_least_0("motion_weight", self.motion_weight),
            huber=(_at_least_0("huber", load), _at_least_0("huber", motion)),
            smoothing=_at_least_0("smoothing", self.smoothing),
            width=_at_least_0("width", self.width),
        )

    def _convex(self, fit: ContactFit) -> tuple[ContactFit, Contacts, Array]:
        """Return the fit, contacts and weights of least loss in the loads.

        Cells are split, and the width lowered, while that lowers the noise.
        """
        contacts = self._contacts()
        m, noise = fit.rough(contacts)
        for _ in range(as_count("refine", self.refine, 0)):
            if noise < _ENOUGH:
                break
            sharper = replace(fit, width=_SHARPEN * fit.width)
            finer = contacts.split(m[: len(contacts)] > 0.0)
            n, left = sharper.rough(finer)
            if left > _GAIN * noise:
                break
            fit, contacts, m, noise = sharper, finer, n, left
        self.noise_ = noise
        return fit, contacts, fit.smooth(contacts, m, noise)

    def _contacts(self) -> Contacts:
        if self.positions is None:
            return Contacts.of_cells(polar_cells(_REACH, as_count("rings", self.rings)))
        places = as_array("positions", self.positions, None, 2) / self.rho
        if len(places) == 0:
            raise InputError("positions", "are missing", remedy="give feet, or None for a grid")
        return Contacts(places, np.full(len(places), 1.0 / len(places)))

    def _directions(self, loads: Array) -> Array:
        offset = self.offset_ / [1.0, 1.0, self.rho]
        return motions_under(loads + offset, self.positions_ / self.rho, self.radii_)


def _at_least_0(name: str, value: float) -> float:
    number = as_number(name, value)
    if not number >= 0.0:
        raise InputError(name, "must be at least 0", value=value)
    return number
