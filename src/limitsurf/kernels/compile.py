"""How kernels are compiled: cached on disk, without the GIL, so that threads run side by side.

Sums may be reassociated (vectorised); NaN, infinities and signed zeros keep their IEEE meaning
except for the sign of zero.
"""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Bools", "Floats", "Ints", "compiled"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]

# kernels that start threads say so in Python, on purpose
warnings.filterwarnings("ignore", message="Code running in object mode")

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a plain function on arrays and floats."""
    flags = {"reassoc", "contract", "nsz"}
    return cast(F, njit(cache=True, nogil=True, error_model="numpy", fastmath=flags)(function))


def drop_stale_caches(folder: Path) -> bool:
    """Delete the compiled kernels of a folder if any of its sources changed; return whether.

    Numba recompiles a function when its own file changes, but not when a function that it calls
    changed in another file.
    """
    cache = folder / "__pycache__"
    stamp = cache / "kernels.stamp"
    sources = sorted(folder.glob("*.py"))
    state = "\n".join(f"{p.name} {p.stat().st_mtime_ns} {p.stat().st_size}" for p in sources)
    if stamp.exists() and stamp.read_text(encoding="utf-8") == state:
        return False
    with contextlib.suppress(OSError):  # a read-only folder holds no caches either
        cache.mkdir(exist_ok=True)
        for compiled_file in [*cache.glob("*.nbi"), *cache.glob("*.nbc")]:
            compiled_file.unlink(missing_ok=True)
        stamp.write_text(state, encoding="utf-8")
    return True


drop_stale_caches(Path(__file__).parent)
