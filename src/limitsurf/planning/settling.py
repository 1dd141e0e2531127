"""How long a part takes to settle in a squeeze field: many starts at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from limitsurf.errors import SolveFailed
from limitsurf.kernels.squeeze_energy import squeeze_loads
from limitsurf.planning.turn_function import TurnFunction
from limitsurf.sets.arguments import writable

__all__ = ["Settled", "settle"]

Array = NDArray[np.float64]

_ACCURACY = 1e-5
_LONGEST = 500.0  # time limit, over the slowest time constant about a stable orientation
_FRAMES = 1000  # instants at which the motion is looked at


@dataclass(frozen=True, eq=False)
class Settled:
    """Where parts came to rest, and when.

    Attributes
    ----------
    times : (n,) float
        Until the part stays within the tolerance of its rest [s].
    phi, offset : (n,) float
        Orientation at rest, not reduced [rad], and offset of the centroid from the line [m].
    """

    times: Array
    phi: Array
    offset: Array


def settle(
    turn: TurnFunction, density: float, drag: Array, phi: Array, offset: Array, tolerance: float
) -> Settled:
    r"""Let parts go from rest at orientations (n,) and offsets (n,) from a line at angle 0.

    Full motion :math:`M \dot v = F(z, \phi) - D v` in the continuum, the same for every place along
    the line. A part has settled when its orientation stays within `tolerance` [rad] of where it
    comes to rest, and its offset within that times the radius of gyration.

    Parameters
    ----------
    turn : TurnFunction
        Of a part with areal density.
    density : float
        Push per area [N/m^2].
    drag : (3,) float
        Viscous drag [kg/s, kg/s, kg m^2/s].
    """
    part, n = turn.part, len(phi)
    edges = writable(part.edges)
    mass, damping = np.array([part.mass, part.inertia]), drag[1:]
    unit = np.array([np.sqrt(part.polar_moment / part.area), 1.0])[:, None]  # of offset and angle
    medians = np.array([turn.median(float(s))[0] for s in turn.stable])

    def split(state: Array) -> tuple[Array, Array]:
        """Return positions and velocities (2, n): parts one after the other, for the band."""
        columns = state.reshape(n, 4).T
        return columns[:2], columns[2:]

    def load(q: Array) -> Array:
        loads = squeeze_loads(edges, part.area, -q[1], -q[0] * unit[0])
        return np.asarray(density * loads.T)

    def rates(_: float, state: Array) -> Array:
        q, v = split(state)
        return np.concatenate(
            [v, (load(q) / unit - damping[:, None] * v) / mass[:, None]]
        ).T.ravel()

    def rest(q: Array) -> Array:
        """Return the rests (2, n) nearest in orientation."""
        gaps = turn.stable[:, None] - q[1]
        turns = np.round(gaps / np.pi)
        gaps = gaps - np.pi * turns
        k = np.abs(gaps).argmin(axis=0)
        at = np.take_along_axis(gaps, k[None], axis=0)[0]
        half_turns = -np.take_along_axis(turns, k[None], axis=0)[0]
        side = np.where(np.mod(half_turns, 2) == 1, 1.0, -1.0)
        return np.array([side * medians[k] / unit[0], q[1] + at])

    slowest = _slowest(turn, density, mass, damping)

    def excess(_: float, state: Array) -> float:
        q, v = split(state)
        return float(max(np.abs(q - rest(q)).max(), slowest * np.abs(v).max()) - 0.5 * tolerance)

    excess.terminal = True  # type: ignore[attr-defined]
    start = np.column_stack([offset / unit[0], phi, np.zeros((n, 2))]).ravel()
    path = solve_ivp(
        rates,
        (0.0, _LONGEST * slowest),
        start,
        method="LSODA",
        lband=3,
        uband=3,
        rtol=_ACCURACY,
        atol=_ACCURACY * tolerance,
        events=excess,
        dense_output=True,
    )
    if path.status != 1 and excess(0.0, path.y[:, -1]) > 0.0:
        raise SolveFailed(f"parts have not settled after {path.t[-1]:.3g} s", path)
    end = rest(split(path.y[:, -1])[0])
    times = np.linspace(0.0, path.t[-1], _FRAMES)
    ways = path.sol(times).reshape(n, 4, -1)[:, :2]
    far = np.abs(ways - end.T[..., None]).max(axis=1)
    return Settled(_last_above(times, far, tolerance), end[1], end[0] * unit[0, 0])


def _slowest(turn: TurnFunction, density: float, mass: Array, damping: Array) -> float:
    """Return the longest time constant about the stable orientations [s]."""
    stiffness = density * float(np.min(turn.curvature(turn.stable)))
    return float(damping[1] / stiffness + np.sqrt(mass[1] / stiffness))


def _last_above(times: Array, values: Array, level: float) -> Array:
    """Return when rows of values (n, t) are above a level for the last time, interpolated."""
    above = values > level
    last = above.shape[1] - 1 - above[:, ::-1].argmax(axis=1)
    rows, after = np.arange(len(values)), np.minimum(last + 1, len(times) - 1)
    a, b = values[rows, last], values[rows, after]
    share = np.clip((a - level) / np.where(a > b, a - b, 1.0), 0.0, 1.0)
    found = times[last] + share * (times[after] - times[last])
    return np.where(above.any(axis=1), found, 0.0)
