"""All roots of a piecewise analytic function, by Chebyshev interpolation on its pieces.

A function that is analytic on an interval is resolved to rounding by a Chebyshev interpolant of
moderate degree; the eigenvalues of its colleague matrix are then all the roots, multiple ones
included. Intervals that are not resolved are halved. (Boyd, SIAM J. Numer. Anal. 40, 2002.)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

__all__ = ["analytic_roots"]

_DEGREES = (12, 24, 48)
_RESOLVED = 1e-14
_ZERO = 2e-15
_MAX_HALVINGS = 40

Array = NDArray[np.float64]


def analytic_roots(function: Callable[[Array], Array], left: float, right: float) -> list[float]:
    """Return the roots of `function` on ``[left, right]``, ascending.

    Parameters
    ----------
    function : callable
        Maps an array of abscissae to values of size about 1; analytic on the interval. Its values
        are taken to be exact to about 1e-15.
    left, right : float
        The interval.

    Returns
    -------
    list of float
        Candidates for roots: a double root may come twice or, split into a complex pair by
        rounding, with its real part. An identically zero function returns both ends.
    """
    roots: list[float] = []
    stack = [(left, right, 0)]
    while stack:
        a, b, halvings = stack.pop()
        coefficients = _resolve(function, a, b)
        if coefficients is not None:
            roots += _interpolant_roots(coefficients, a, b)
        elif halvings == _MAX_HALVINGS:  # a singular end: nothing of any width is left
            roots += [a, b]
        else:
            middle = 0.5 * (a + b)
            stack += [(a, middle, halvings + 1), (middle, b, halvings + 1)]
    return sorted(roots)


def _resolve(function: Callable[[Array], Array], a: float, b: float) -> Array | None:
    for degree in _DEGREES:
        nodes = chebyshev.chebpts1(degree + 1)
        values = function(0.5 * (a + b) + 0.5 * (b - a) * nodes)
        coefficients = np.asarray(chebyshev.chebfit(nodes, values, degree), dtype=np.float64)
        if np.max(np.abs(coefficients[-3:])) <= _RESOLVED:
            return coefficients
    return None


def _interpolant_roots(coefficients: Array, a: float, b: float) -> list[float]:
    trimmed = chebyshev.chebtrim(coefficients, _ZERO)
    if len(trimmed) == 1:
        return [a, b] if abs(trimmed[0]) <= _ZERO else []
    found = chebyshev.chebroots(trimmed)
    near = (np.abs(found.imag) <= 1e-5) & (np.abs(found.real) <= 1.0 + 1e-7)
    return [0.5 * (a + b) + 0.5 * (b - a) * x for x in np.clip(found[near].real, -1.0, 1.0)]
