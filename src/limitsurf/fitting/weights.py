"""Weights of pairs from the measured noise of their loads and motions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError
from limitsurf.fitting.columns import named_rows
from limitsurf.sets.arguments import as_positive

__all__ = ["weights_from_noise"]

Array = NDArray[np.float64]


def weights_from_noise(
    loads: Any, deviations: ArrayLike, rho: float, *, floor: float = 0.15
) -> Array:
    r"""Return weights (n,), at most 1, of pairs whose loads scatter.

    .. math:: w_i = \sigma_0^2 / (\sigma_0^2 + |s_i|^2 / |F_i|^2)

    The floor :math:`\sigma_0` stands for all errors that the scatter does not show, such as those
    of the model; without it one quiet push would outweigh all others.

    Parameters
    ----------
    loads : (n, 3) array, data frame or xarray
        Applied loads F [N, N, N m].
    deviations : (n, 3) float
        Standard deviations s of their components [N, N, N m]; those of the mean if the loads are
        means. NaN, for unknown, gives weight 1.
    rho : float
        Length that makes moments forces [m].
    floor : float
        Relative error of a load without scatter.

    Examples
    --------
    >>> weights_from_noise([[4.0, 0.0, 0.0]] * 2, [[0, 0, 0], [0.6, 0, 0]], 0.05)
    array([1. , 0.5])
    """
    scale = np.array([1.0, 1.0, 1.0 / as_positive("rho", rho)])
    F, s = named_rows("loads", loads) * scale, np.asarray(deviations, dtype=np.float64)
    if s.shape != F.shape:
        raise InputError("deviations", f"has shape {s.shape}, not {F.shape}")
    if (s < 0.0).any():
        raise InputError("deviations", "has negative entries", remedy="give standard deviations")
    size = np.linalg.norm(F, axis=1)
    scatter = np.linalg.norm(np.nan_to_num(s) * scale, axis=1)
    base = as_positive("floor", floor) * size
    total = base**2 + scatter**2
    return np.asarray(np.divide(base**2, total, out=np.ones_like(size), where=total > 0.0))
