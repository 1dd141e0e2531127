"""How kernels are compiled: cached on disk, without the GIL, so that threads run side by side.

Sums may be reassociated (vectorised); NaN, infinities and signed zeros keep their IEEE meaning
except for the sign of zero.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from numba import njit

__all__ = ["compiled"]

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a plain function on arrays and floats."""
    kernel: F = njit(
        cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"}
    )(function)
    return kernel
