"""How much the numbers that a resonator model assumes matter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from limitsurf.actuators.resonator_sweep import sweep_resonators
from limitsurf.errors import InputError

if TYPE_CHECKING:
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

__all__ = ["sensitivity"]

_STEP = 1e-4  # relative, of central differences: error 1e-8, rounding 1e-9 of the balance's 1e-13


def sensitivity(
    resonator: TorsionalResonator,
    load: float,
    voltage: float,
    mu: float,
    parameters: tuple[str, ...] | None = None,
) -> dict[str, dict[str, float]]:
    """Return relative sensitivities ``d log(result) / d log(parameter)``.

    Parameters
    ----------
    resonator : TorsionalResonator
        The design.
    load, voltage, mu : float
        As in `TorsionalResonator.floating`.
    parameters : tuple of str, optional
        By default the assumed numbers that are not zero, and mu.

    Returns
    -------
    dict
        By parameter, then by result: resonance, edge_amplitude, offset.

    Examples
    --------
    The resonance falls as the square root of the rods' length, whatever else was assumed:

    >>> from limitsurf.actuators.torsional_resonator import TorsionalResonator
    >>> base = TorsionalResonator.from_model("resonator1994")
    >>> round(sensitivity(base, 3.1e-8, 50.0, 0.3)["rod_length"]["resonance"], 4)
    -0.5
    """
    if parameters is None:
        given = tuple(n for n in resonator.assumed if getattr(resonator, n) not in (0.0, 1.0))
        parameters = (*given, "mu")
    base = {**vars(resonator), "load": load, "voltage": voltage, "mu": mu}
    for name in parameters:
        if not isinstance(base.get(name), int | float) or base[name] == 0.0:
            raise InputError(
                name, "has no relative sensitivity", remedy="it must be a number, not 0"
            )
    factors = np.ones((len(parameters), 2, len(parameters)))
    rows = np.arange(len(parameters))
    factors[rows, 0, rows], factors[rows, 1, rows] = 1.0 - _STEP, 1.0 + _STEP
    flat = factors.reshape(-1, len(parameters))
    varied = {name: base[name] * flat[:, i] for i, name in enumerate(parameters)}
    conditions = {"load": load, "voltage": voltage, "mu": mu, **varied}
    sweep = sweep_resonators(resonator, **conditions)
    width = np.log1p(_STEP) - np.log1p(-_STEP)
    result: dict[str, dict[str, float]] = {name: {} for name in parameters}
    for quantity in ("resonance", "edge_amplitude", "offset"):
        logs = np.log(np.abs(getattr(sweep, quantity))).reshape(-1, 2)
        for name, (low, high) in zip(parameters, logs, strict=True):
            result[name][quantity] = float((high - low) / width)
    return result
