"""How actuators of an array differ from each other: strength, direction, dead ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_count, as_number

__all__ = ["SiteSpread", "draw_spread"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SiteSpread:
    """Deviations of every actuator; the arrays have the shape of the actuators.

    Attributes
    ----------
    strength : float
        Push over the nominal push.
    turn : float
        Angle of the push from its nominal direction [rad].
    dead : bool
        True for actuators that never run; like inactive ones they hang free below a lifted part.
    """

    strength: Array
    turn: Array
    dead: NDArray[np.bool_]

    def pushes(self, directions: Array) -> Array:
        """Return the pushes (..., 2) for nominal unit directions; zero for dead actuators."""
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        x, y = directions[..., 0], directions[..., 1]
        turned = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
        alive = np.where(self.dead, 0.0, self.strength)
        return np.asarray(alive[..., None] * turned)


def draw_spread(
    shape: tuple[int, ...],
    *,
    strength: float = 0.0,
    direction: float = 0.0,
    dead: float = 0.0,
    seed: int = 0,
) -> SiteSpread:
    """Return random deviations, the same for the same seed.

    Parameters
    ----------
    shape : tuple of int
        Of the actuators.
    strength : float
        Standard deviation of the push over its mean; log-normal with mean 1, so never negative.
    direction : float
        Standard deviation of the direction, normal [rad].
    dead : float
        Share of dead actuators, between 0 and 1; each fails on its own.
    seed : int
        Seed.

    Examples
    --------
    >>> spread = draw_spread((200, 200), strength=0.1, dead=0.02, seed=1)
    >>> round(float(spread.strength.std()), 2), round(float(spread.dead.mean()), 2)
    (0.1, 0.02)
    """
    for name, value in (("strength", strength), ("direction", direction)):
        if not (np.isfinite(as_number(name, value)) and value >= 0.0):
            raise InputError(name, "must be finite and not negative", value=value)
    if not 0.0 <= as_number("dead", dead) <= 1.0:
        raise InputError("dead", "must lie between 0 and 1", value=dead)
    rng = np.random.default_rng(as_count("seed", seed, 0))
    width = np.sqrt(np.log1p(strength**2))
    return SiteSpread(
        strength=rng.lognormal(-0.5 * width**2, width, shape),
        turn=rng.normal(0.0, direction, shape),
        dead=rng.random(shape) < dead,
    )
