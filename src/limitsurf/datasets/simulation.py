"""Simulated pairs of load and motion, from any limit surface, with a stated noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from limitsurf.datasets.sliding_data import SlidingData
from limitsurf.errors import InputError
from limitsurf.sets.arguments import as_count, as_number, as_positive
from limitsurf.sets.convex_set import ConvexSet

__all__ = ["ZHOU2016_NOISE", "SlidingNoise", "make_sliding_data"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlidingNoise:
    """Gaussian noise, independent and equal in all components of scaled loads and motions.

    Attributes
    ----------
    load : float
        Standard deviation of each of ``fx, fy, m/rho``, relative to the root mean square of the
        loads' norms.
    motion : float
        Standard deviation of each component of the unit vector along ``(vx, vy, rho omega)``, whose
        length is then restored: for small noise the angle [rad] in each of two directions.
    """

    load: float
    motion: float

    def __post_init__(self) -> None:
        """Check that both are finite and at least 0."""
        for name in ("load", "motion"):
            size = as_number(name, getattr(self, name))
            if not (np.isfinite(size) and size >= 0.0):
                raise InputError(name, "must be at least 0", value=size)


#: Noise like that of the measured pushes of Zhou et al. (ICRA 2016). On their four supports of
#: three feet the exact limit surface then misses the motion by 7.7, 7.3, 12.2 and 7.2 degrees in
#: the mean; measured 7.2, 6.6, 11.9 and 10.8. Each component of load scatters by 0.05 within a
#: push; 0.02 is assumed for its mean.
ZHOU2016_NOISE: Final = SlidingNoise(load=0.02, motion=0.09)


def make_sliding_data(
    surface: ConvexSet,
    n: int,
    noise: SlidingNoise | float = 0.0,
    seed: int = 0,
    *,
    rho: float,
    distance: float = 0.01,
) -> SlidingData:
    r"""Simulate pairs of an applied load and the motion under it.

    .. math:: F = -\operatorname{argmax}_{L} \; (-v) \cdot l, \qquad
              (v_x, v_y, \rho \omega) \text{ uniform on a sphere}

    Parameters
    ----------
    surface : ConvexSet
        Loads L that the contacts can exert ON the part; the loads of the data are applied ones, so
        on the boundary of -L.
    n : int
        Number of pairs.
    noise : SlidingNoise or float
        Noise of loads and motions; a number stands for both. Without noise, loads lie on the
        boundary to rounding.
    seed : int
        The same seed gives the same pairs, and the same motions and loads before noise.
    rho : float
        Length that makes moments forces [m].
    distance : float
        Length of the displacements ``(dx, dy, rho dtheta)`` [m].

    Raises
    ------
    InputError
        A set of other than three dimensions; a number or length that is not positive.

    Examples
    --------
    >>> from limitsurf.contacts.contact_set import ContactSet
    >>> bar = ContactSet([[0.05, 0.0], [-0.05, 0.0]], 1.0).limit_surface()
    >>> data = make_sliding_data(bar, 50, 0.03, rho=0.05)
    >>> data.loads.shape
    (50, 3)
    """
    if not isinstance(surface, ConvexSet) or surface.dim != 3:
        raise InputError("surface", "is no convex set in three dimensions", value=surface)
    count, arm, way = as_count("n", n), as_positive("rho", rho), as_positive("distance", distance)
    sd = noise if isinstance(noise, SlidingNoise) else SlidingNoise(noise, noise)
    rng = np.random.default_rng(as_count("seed", seed, 0))
    scale = np.array([1.0, 1.0, arm])
    motions = _unit(rng.normal(size=(count, 3)))
    loads = -surface.support_point(-motions / scale) / scale
    size = float(np.sqrt((loads**2).sum(axis=1).mean()))
    loads += sd.load * size * rng.normal(size=loads.shape)
    motions = _unit(motions + sd.motion * rng.normal(size=motions.shape))
    return SlidingData(
        loads * scale,
        way * motions / scale,
        arm,
        load_deviations=sd.load * size * scale if sd.load else None,
        twist_deviations=sd.motion * way / scale if sd.motion else None,
        name="simulated",
    )


def _unit(rows: Array) -> Array:
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))
