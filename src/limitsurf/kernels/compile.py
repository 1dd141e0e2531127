"""How kernels are compiled: cached on disk, without the GIL, so that threads run side by side.

Sums may be reassociated (vectorised); NaN, infinities and signed zeros keep their IEEE meaning
except for the sign of zero.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Bools", "Floats", "Ints", "compiled", "inlined"]

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


def inlined(function: F) -> F:
    """Compile a plain function as part of each caller.

    For small functions on tuples of arrays: to pass these costs a count of references each.
    """
    return cast(F, njit(inline="always", error_model="numpy")(function))


def _changed_sources(sources: dict[str, str], before: dict[str, str]) -> set[str]:
    """Return the kernels that changed, or import one that did, however far down."""
    imports = {
        name: set(re.findall(r"limitsurf\.kernels\.(\w+)", text)) for name, text in sources.items()
    }
    stale = {name for name in sources if before.get(name) != _state(sources[name])}
    while True:
        above = {name for name, used in imports.items() if used & stale} | stale
        if above == stale:
            return stale
        stale = above


def _state(text: str) -> str:
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def drop_stale_caches(folder: Path) -> set[str]:
    """Delete compiled kernels of which a source changed; return the names of their files.

    Numba recompiles a function when its own file changes, but not when a function that it calls
    changed in another file.
    """
    cache = folder / "__pycache__"
    stamp = cache / "kernels.json"
    sources = {p.stem: p.read_text(encoding="utf-8") for p in sorted(folder.glob("*.py"))}
    before: dict[str, str] = {}
    with contextlib.suppress(OSError, ValueError):  # none yet, or half written by another process
        before = json.loads(stamp.read_text(encoding="utf-8"))
    now = {name: _state(text) for name, text in sources.items()}
    if before == now:
        return set()
    stale = _changed_sources(sources, before)
    with contextlib.suppress(OSError):  # a read-only folder holds no caches either
        cache.mkdir(exist_ok=True)
        for compiled_file in [*cache.glob("*.nbi"), *cache.glob("*.nbc")]:
            if compiled_file.name.split(".")[0] in stale | (before.keys() - now.keys()):
                compiled_file.unlink(missing_ok=True)
        stamp.write_text(json.dumps(now), encoding="utf-8")
    return stale


drop_stale_caches(Path(__file__).parent)
