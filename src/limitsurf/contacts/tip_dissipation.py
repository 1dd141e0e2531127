"""Oscillating tips under a rigid part: the mean friction as a potential of the part's twist."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_array
from limitsurf.tolerances import TIP_WIDTH

__all__ = ["TipDissipation"]

Array = NDArray[np.float64]


class TipDissipation:
    r"""``sum_i Phi_i(G_i' v)`` over tips at r_i, without what they do while they rest.

    The rest phases leave friction disks, which have a kink and hold a part: `resting` gives them as
    contacts. Together they are the whole mean friction of the tips:
    ``friction_load(d.resting, F, W, dissipation=d)``. A `Dissipation`.

    Parameters
    ----------
    position : (n, 2) float
        Tips, from the part's reference point [m].
    tips : OscillatingContact
        n tips.
    blur : float, optional
        Speed [m/s] below which slip is smoothed, ``sqrt(|u - w e|^2 + blur^2)`` for ``|u - w e|``,
        except in rest phases; loads change by about its ratio to the tips' speeds. By default 1e-6
        of the largest tip speed. With 0 the potential is exact, but has a kink where the part
        moves just as a tip that keeps a constant speed for a while, and `friction_load` may fail.

    Examples
    --------
    >>> tips = OscillatingContact(0.5, [[1, 0], [1, 0]], [0.0, 2.0, 1.0, -3.0], 1.0)
    >>> d = TipDissipation([[0.0, 0.1], [0.0, -0.1]], tips)
    >>> d.gradient(np.zeros(3)).round(6)  # minus their load: they push along x
    array([-0.125,  0.   ,  0.   ])
    >>> d.potential(np.array([5.0, 0.0, 0.0])).round(6)
    np.float64(5.0)
    """

    def __init__(
        self, position: ArrayLike, tips: OscillatingContact, *, blur: float | None = None
    ) -> None:
        self._position = as_array("position", position, None, 2)
        if tips.shape != (len(self._position),):
            raise InputError("tips", f"have shape {tips.shape}, not ({len(self._position)},)")
        blur = TIP_WIDTH * tips.fastest if blur is None else blur
        if not (np.isfinite(blur) and blur >= 0.0):
            raise InputError("blur", "must be at least 0", value=blur)
        self._tips, self._blur = tips, float(blur)
        self._last: tuple[bytes, float, Array, Array] | None = None

    @property
    def position(self) -> Array:
        """Tips (n, 2) [m]."""
        return self._position

    @property
    def tips(self) -> OscillatingContact:
        """The tips."""
        return self._tips

    @property
    def blur(self) -> float:
        """Speed below which slip is smoothed [m/s]."""
        return self._blur

    @property
    def resting(self) -> ContactSet:
        """Friction disks that the rest phases leave."""
        return ContactSet(self._position, self._tips.radius)

    def potential(self, v: ArrayLike) -> np.float64:
        """Return the potential [W] at a twist v (3,)."""
        return np.float64(self._at(v)[1])

    def gradient(self, v: ArrayLike) -> Array:
        """Return its gradient (3,): minus the load of the moving tips [N, N, N m]."""
        return self._at(v)[2]

    def hessian(self, v: ArrayLike) -> Array:
        """Return its Hessian (3, 3), smoothed as `OscillatingContact.hessian`."""
        return self._at(v)[3]

    def _at(self, v: ArrayLike) -> tuple[bytes, float, Array, Array]:
        """Return all three; those of the last twist are remembered."""
        twist = as_array("v", v, 3)
        key = twist.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = (key, *self._sum(twist))
        return self._last

    def _sum(self, v: Array) -> tuple[float, Array, Array]:
        x, y = self._position.T
        u = np.column_stack([v[0] - v[2] * y, v[1] + v[2] * x])
        phi, gx, gy, xx, xy, yy = self._tips.moving_sums(u, self._blur).T
        gradient = np.array([gx.sum(), gy.sum(), x @ gy - y @ gx])
        px, py = x * xy - y * xx, x * yy - y * xy  # the force that a turn adds
        hessian = np.array(
            [
                [xx.sum(), xy.sum(), px.sum()],
                [xy.sum(), yy.sum(), py.sum()],
                [px.sum(), py.sum(), x @ py - y @ px],
            ]
        )
        return float(phi.sum()), gradient, hessian
