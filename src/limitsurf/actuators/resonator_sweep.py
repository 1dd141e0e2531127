"""Many resonator designs in one compiled pass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import epsilon_0

from limitsurf.actuators.grid_inertia import grid_inertia, pole_sides
from limitsurf.actuators.rod_torsion import rod_stiffness
from limitsurf.errors import InputError
from limitsurf.kernels.resonator_balance import OK, sweep_designs

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["ResonatorSweep", "sweep_resonators"]

Array = NDArray[np.float64]

_CONDITIONS = ("load", "voltage", "mu", "lag")


@dataclass(frozen=True, eq=False)
class ResonatorSweep:
    """What n designs do under their loads; NaN where `status` is not 0.

    Attributes
    ----------
    resonance : (n,) float
        Of the free, undriven grid [Hz].
    frequency, edge_amplitude, height : (n,) float
        Loaded resonance [Hz], amplitude of the farther edge [m], height of the part's underside
        above the rods [m].
    vertical_force : (n,) float
        At the voltage held constant [N].
    offset, offset_fraction : (n,) float
        Mean push along +x [N], and over mu times the load.
    status : (n,) int
        0 for good; else 1 edge hits, 2 stalled, 3 tip never leaves, 4 not converged, 5 too heavy.
    """

    resonance: Array
    frequency: Array
    edge_amplitude: Array
    height: Array
    vertical_force: Array
    offset: Array
    offset_fraction: Array
    status: NDArray[np.int64]


def sweep_resonators(
    resonator: TorsionalResonator,
    load: ArrayLike,
    voltage: ArrayLike,
    mu: ArrayLike,
    *,
    lag: ArrayLike = 0.5 * np.pi,
    **parameters: ArrayLike,
) -> ResonatorSweep:
    """Return the loaded oscillation of many designs.

    Parameters
    ----------
    resonator : TorsionalResonator
        Gives what does not vary.
    load, voltage, mu, lag : (n,) float or float
        As in `TorsionalResonator.floating`.
    **parameters : (n,) float or float
        Numeric fields of the resonator that vary, by name.

    Raises
    ------
    InputError
        Unknown or non-positive parameters; designs without a steady oscillation do not raise but
        say so in `status`.

    Examples
    --------
    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> base = TorsionalResonator.from_model("resonator1994")
    >>> sweep = sweep_resonators(base, 3.1e-8, 50.0, 0.3, rod_length=[25e-6, 30e-6, 35e-6])
    >>> bool(np.all(np.diff(sweep.resonance) < 0.0))
    True
    """
    conditions = {"load": load, "voltage": voltage, "mu": mu, "lag": lag}
    p = _columns(resonator, {**parameters, **conditions})
    designs, resonance = _designs(resonator, p)
    out = np.empty((len(designs), 9))
    sweep_designs(designs, out)
    status = out[:, 8].astype(np.int64)
    force = epsilon_0 * (p["grid_width"] + p["grid_length"]) * p["effective_width"]
    force = force * p["voltage"] ** 2 / p["clearance"] ** 2
    status[(status == OK) & (p["load"] > force)] = 5
    out[status != OK] = np.nan
    lever = np.maximum(designs[:, 3], designs[:, 6])
    return ResonatorSweep(
        resonance=resonance,
        frequency=out[:, 2] / (2 * np.pi),
        edge_amplitude=lever * out[:, 0],
        height=out[:, 3],
        vertical_force=force,
        offset=p["mu"] * out[:, 7],
        offset_fraction=out[:, 7] / out[:, 6],
        status=status,
    )


def _columns(resonator: TorsionalResonator, varied: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return every number of the resonator and the conditions, each of the same length."""
    base = {k: v for k, v in vars(resonator).items() if isinstance(v, int | float)}
    unknown = sorted(set(varied) - set(base) - set(_CONDITIONS))
    if unknown:
        raise InputError(unknown[0], "is no number of TorsionalResonator")
    merged = {**base, **varied}
    for name, value in merged.items():
        if np.ndim(value) > 1:
            raise InputError(name, "must be a number or one-dimensional", value=np.shape(value))
    arrays = np.broadcast_arrays(*(np.asarray(v, np.float64) for v in merged.values()))
    columns = dict(zip(merged, (np.atleast_1d(a) for a in arrays), strict=True))
    _check_columns(resonator, columns)
    return columns


def _check_columns(resonator: TorsionalResonator, columns: Mapping[str, Array]) -> None:
    """Hold every column's extremes to the rules of a single resonator."""
    for name, column in columns.items():
        for value in {float(column.min()), float(column.max()), float(column.sum() * 0.0)}:
            if not np.isfinite(value):
                raise InputError(name, "must be finite")
    for name in ("load", "voltage"):
        if columns[name].min() <= 0.0:
            raise InputError(name, "must be positive", value=float(columns[name].min()))
    if columns["mu"].min() < 0.0:
        raise InputError("mu", "must not be negative", value=float(columns["mu"].min()))
    if not (columns["lag"].min() > 0.0 and columns["lag"].max() < np.pi):
        raise InputError("lag", "must lie between 0 and pi")
    numbers = [n for n in columns if n not in _CONDITIONS]
    spread = [n for n in numbers if columns[n].min() != columns[n].max()]
    rows = {int(columns[n].argmin()) for n in spread} | {int(columns[n].argmax()) for n in spread}
    rows |= {int(np.argmax(np.abs(columns["rod_offset"]) / columns["grid_width"])), 0}
    rows.add(int(np.argmin(columns["beam_pitch"] / columns["beam_width"])))
    for row in rows:
        resonator.varied(**{n: float(columns[n][row]) for n in numbers})


def _designs(resonator: TorsionalResonator, p: Mapping[str, Array]) -> tuple[Array, Array]:
    """Return the kernel's columns, (n, 20), and the resonance [Hz]."""
    right, left = 0.5 * p["grid_width"] - p["rod_offset"], 0.5 * p["grid_width"] + p["rod_offset"]
    face, height = 0.5 * p["beam_height"], p["pole_height"]
    has_right, has_left = pole_sides(resonator.poles)
    stiffness = 2.0 * rod_stiffness(
        p["beam_width"],
        p["beam_height"],
        p["rod_length"],
        p["shear_modulus_tall"],
        p["shear_modulus_flat"],
    )
    inertia = np.asarray(grid_inertia(p, resonator.poles))
    strength = 0.5 * epsilon_0 * p["effective_width"] * p["voltage"] ** 2
    columns = [
        stiffness,
        inertia,
        np.sqrt(stiffness * inertia) / p["quality"],
        right,
        p["grid_length"],
        p["clearance"],
        left,
        strength * (resonator.driven in ("+x", "both")),
        strength * (resonator.driven in ("-x", "both")),
        np.full_like(right, resonator.drive == "biased"),
        right,
        -left,
        face + has_right * height,
        face + has_left * height,
        p["contact_stiffness"],
        p["contact_damping"] / p["contact_stiffness"],
        p["restitution"],
        p["load"],
        p["mu"],
        p["lag"],
    ]
    resonance = np.sqrt(stiffness / inertia) / (2 * np.pi)
    return np.ascontiguousarray(np.stack(columns, axis=-1)), resonance
