"""Tips that shake under a part: their mean friction, and the push that is left of it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.reach import reach_outline
from limitsurf.contacts.waveforms import Waveform, read_waveforms
from limitsurf.errors import InputError
from limitsurf.kernels.drift import drift_speeds
from limitsurf.kernels.oscillating import SUMS, tip_sums
from limitsurf.sets.arguments import as_number, as_points
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.tolerances import TIP_AT_REST, TIP_WIDTH

__all__ = ["OscillatingContact"]

Array = NDArray[np.float64]


class OscillatingContact:
    r"""One tip that oscillates along a line while it presses, or an array of them. Immutable.

    Its friction on a part whose contact velocity is u, averaged over a period, is
    :math:`-\nabla\Phi(u)`,

    .. math:: \Phi(u) = \frac1T \int_0^T \mu N(t)\, |u - w(t) e| \,dt

    Parameters
    ----------
    mu : (...,) float
        Coefficients of friction.
    direction : (..., 2) float
        Directions e of the tips' motion; made unit vectors.
    tip_velocity : (..., K) float, or callable
        Velocities w(t) along e [m/s]: samples uniform in time over one period, joined linearly, the
        last with the first. The tip rests between two samples that are exactly 0. A function gets
        phases t/T and returns as many values along its last axis.
    normal_force : (..., K) float, one number, or callable
        Normal forces N(t) >= 0 [N] at the same times.
    samples : int
        K for functions; see `sampling_error`.

    Raises
    ------
    InputError
        A waveform that is not periodic, not finite or of another length, N < 0, mu < 0, no
        direction; names it.

    Notes
    -----
    `shape` is the common leading shape of the arguments, () for one tip. Velocities broadcast
    against it: ``u`` (..., 2) gives answers of shape (...). All answers are exact for the joined
    samples, to rounding, but for the smoothing of the Hessian, see `hessian`. With `radius` > 0
    Phi has a kink at u = 0, with rest phases of the slip elsewhere also at these speeds; there
    `gradient` gives the middle of the sub-gradients.

    Examples
    --------
    A tip that goes forwards slowly and back fast drags the part along:

    >>> tip = OscillatingContact(0.5, [1.0, 0.0], [1.0, 1.0, 1.0, -3.0], 2.0)
    >>> tip.offset.round(12)
    array([0.25, 0.  ])
    >>> tip.drift_velocity
    array([1., 0.])
    >>> tip.gradient([100.0, 0.0]).round(12)  # mu mean(N), far away
    array([1., 0.])

    Half of the cycle at rest leaves half of the static friction:

    >>> OscillatingContact(0.5, [1.0, 0.0], [0.0, 0.0, 0.0, 3.0, 0.0, -3.0], 2.0).radius.round(12)
    np.float64(0.333333333333)
    """

    def __init__(
        self,
        mu: ArrayLike,
        direction: ArrayLike,
        tip_velocity: Waveform,
        normal_force: Waveform,
        *,
        samples: int = 64,
    ) -> None:
        w, N, self.sampling_error = read_waveforms(tip_velocity, normal_force, samples)
        friction, e = _read_friction(mu), _read_direction(direction)
        shapes = [friction.shape, e.shape[:-1], w.shape[:-1], N.shape[:-1]]
        try:
            self.shape = np.broadcast_shapes(*shapes)
        except ValueError as error:
            names = ("mu", "direction", "tip_velocity", "normal_force")
            parts = ", ".join(f"{k} {s}" for k, s in zip(names, shapes, strict=True))
            raise InputError("contacts", f"have different shapes: {parts}") from error
        self._mu = np.broadcast_to(friction, self.shape)
        self._e, self._w, self._N = (
            np.broadcast_to(a, (*self.shape, a.shape[-1])) for a in (e, w, N)
        )

    @property
    def mu(self) -> Array:
        """Coefficients of friction (...)."""
        return self._mu

    @property
    def direction(self) -> Array:
        """Unit vectors e (..., 2)."""
        return self._e

    @property
    def tip_velocity(self) -> Array:
        """Tip velocities at the samples (..., K) [m/s]."""
        return self._w

    @property
    def normal_force(self) -> Array:
        """Normal forces at the samples (..., K) [N]."""
        return self._N

    def potential(self, u: ArrayLike) -> Array:
        """Return the mean dissipated power Phi (...) [W] seen from the tips, u (..., 2) [m/s]."""
        potential: Array = self._sums(u)[..., 0]
        return potential

    def gradient(self, u: ArrayLike) -> Array:
        """Return the gradient of Phi (..., 2) [N]: minus the mean friction on the part."""
        gradient: Array = self._sums(u)[..., 1:3]
        return gradient

    def hessian(self, u: ArrayLike, width: float | None = None) -> Array:
        """Return the Hessian of Phi (..., 2, 2) [N s/m].

        It grows without bound where u nears the tip's own segment ``{s e : min w <= s <= max w}``.
        Within `width` [m/s] of the line of e it is smoothed: that at this distance, the entry
        across raised by the share ``1 - (q/width)^2`` of the one along, q the distance; positive
        semi-definite and continuous. By default 1e-6 of the largest tip speed; 1e-12 m/s if no
        tip moves.
        """
        sums = self._sums(u, width)
        return np.stack([sums[..., [3, 4]], sums[..., [4, 5]]], axis=-2)

    @cached_property
    def offset(self) -> Array:
        """Active offset ``mean(mu N sign(w)) e`` (..., 2) [N]: the push on a resting part."""
        return 0.0 - self.moving_sums(np.zeros(2))[..., 1:3]  # no negative zeros

    @cached_property
    def radius(self) -> Array:
        """Radius ``mu mean(N [w = 0])`` (...) [N] of the friction left by the rest phases."""
        rests = (self._w == 0.0) & (np.roll(self._w, -1, axis=-1) == 0.0)
        halfway = 0.5 * (self._N + np.roll(self._N, -1, axis=-1))
        return np.asarray(self._mu * (halfway * rests).mean(axis=-1))

    @cached_property
    def passive_radius(self) -> Array:
        """Radius ``mu mean(N)`` (...) [N] of the friction disk of the same tips at rest."""
        return np.asarray(self._mu * self._N.mean(axis=-1))

    @cached_property
    def drift_velocity(self) -> Array:
        """Velocity (..., 2) [m/s] at which the mean friction vanishes, where Phi is least.

        The median of w weighted by N, along e; of several the slowest, and 0 for tips that never
        touch. A part moved by this tip alone ends up drifting at it.
        """
        _, w, N = self._rows
        speed = np.empty(len(w))
        drift_speeds(w, N, speed)
        return np.asarray(speed.reshape(*self.shape, 1) * self._e)

    def active_set(self) -> Ellipsoid:
        """Return the forces that one tip can exert on a resting part (Definition 9).

        A disk of radius `radius` about `offset`; a point if the tip never rests.
        """
        self._check_single("active_set")
        return Ellipsoid(self.offset, float(self.radius) * np.eye(2))

    def passive_set(self) -> Ellipsoid:
        """Return the friction disk ``mu mean(N)`` of one tip that does not move."""
        self._check_single("passive_set")
        return Ellipsoid(np.zeros(2), float(self.passive_radius) * np.eye(2))

    def reach(self, speed: float, tol: float = 1e-4) -> shapely.Geometry:
        """Return the mean frictions ``{-grad Phi(u) : |u| <= speed}`` of one tip.

        Parameters
        ----------
        speed : float
            Largest contact speed U [m/s]; 0 gives the outline of `active_set`.
        tol : float
            Chord error of the polygon, relative to ``mu mean(N)``.

        Returns
        -------
        shapely Polygon; a Point or LineString where the set has no area. Not always convex.
        """
        self._check_single("reach")
        return reach_outline(self, speed, tol)

    def contact_set(self, position: ArrayLike) -> ContactSet:
        """Return the tips at `position` (n, 2) [m] as contacts of a resting part.

        Their limit surface is the active limit surface of the part: what the tips can exert on it
        without resulting in motion. See `TipDissipation` for a part that moves.
        """
        return ContactSet(position, self.radius.reshape(-1), self.offset.reshape(-1, 2))

    def __getitem__(self, index: Any) -> OscillatingContact:
        """Return some of the tips."""
        key = (*index, ...) if isinstance(index, tuple) else (index, ...)
        return OscillatingContact(
            self._mu[key], self._e[(*key, slice(None))], self._w[key], self._N[key]
        )

    def __len__(self) -> int:
        """Return the number of tips along the first axis."""
        if not self.shape:
            raise TypeError("one tip has no length")
        return int(self.shape[0])

    def __repr__(self) -> str:
        """Return the number of tips and of samples."""
        count = f"{self._mu.size} tips" if self.shape else "1 tip"
        return f"OscillatingContact({count}, {self._w.shape[-1]} samples a period)"

    @cached_property
    def _rows(self) -> tuple[Array, Array, Array]:
        """Directions, velocities and friction radii, one tip a row."""
        K = self._w.shape[-1]
        radii = self._mu[..., None] * self._N
        rows = (self._e.reshape(-1, 2), self._w.reshape(-1, K), radii.reshape(-1, K))
        e, w, N = (np.array(a, order="C") for a in rows)
        return e, w, N

    def moving_sums(self, u: ArrayLike, blur: float = 0.0) -> Array:
        """Return Phi, its gradient and its Hessian's xx, xy, yy (..., 6) without rest phases.

        With `blur` > 0 [m/s] all are those of ``mean(mu N sqrt(|u - w e|^2 + blur^2))``.
        """
        return self._sums(u, blur=blur, moving_only=True)

    def _sums(
        self,
        u: ArrayLike,
        width: float | None = None,
        *,
        blur: float = 0.0,
        moving_only: bool = False,
    ) -> Array:
        """Return (..., 6): Phi, gradient and Hessian entries xx, xy, yy."""
        rows, leading = as_points("u", u, 2)
        try:
            shape = np.broadcast_shapes(leading, self.shape)
        except ValueError as error:
            raise InputError("u", f"has shape {(*leading, 2)}, the tips {self.shape}") from error
        velocities = np.array(np.broadcast_to(rows.reshape(*leading, 2), (*shape, 2)))
        number = np.arange(self._mu.size, dtype=np.int32).reshape(self.shape)
        which = np.array(np.broadcast_to(number, shape)).reshape(-1)
        e, w, N = self._rows
        out = np.empty((len(which), SUMS))
        tip_sums(
            velocities.reshape(-1, 2), which, e, w, N, self._width(width), blur, moving_only, out
        )
        return out.reshape(*shape, SUMS)

    @cached_property
    def fastest(self) -> float:
        """Largest tip speed [m/s]."""
        return float(np.abs(self._w).max(initial=0.0))

    def _width(self, width: float | None) -> float:
        if width is None:
            return TIP_WIDTH * self.fastest if self.fastest > 0.0 else TIP_AT_REST
        if not (np.isfinite(as_number("width", width)) and width > 0.0):
            raise InputError("width", "must be positive", value=width)
        return float(width)

    def _check_single(self, query: str) -> None:
        if self.shape:
            raise InputError(
                query, f"is for one tip, not for {self.shape}", remedy="take one: tips[i]"
            )


def _read_friction(mu: ArrayLike) -> Array:
    try:
        friction = np.asarray(mu, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("mu", "is no array of numbers", remedy="check its entries") from error
    if not (np.isfinite(friction).all() and (friction >= 0.0).all()):
        raise InputError("mu", "must be at least 0", value=mu)
    return friction


def _read_direction(direction: ArrayLike) -> Array:
    rows, shape = as_points("direction", direction, 2)
    length = np.hypot(rows[:, 0], rows[:, 1])
    if not (length > 0.0).all():
        raise InputError("direction", "is zero", remedy="say along which line the tip moves")
    return np.asarray((rows / length[:, None]).reshape(*shape, 2))
