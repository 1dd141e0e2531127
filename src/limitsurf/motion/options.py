"""The options of `simulate`, checked as far as they stand alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.motion.load_table import LoadLike
from limitsurf.sets.arguments import as_array, as_count, as_positive

__all__ = ["Method", "Mode", "Options", "check_choice", "checked_drag"]

Array = NDArray[np.float64]
Mode = Literal["inertial", "quasi-static"]
Method = Literal["steps", "events"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Options:
    """Options of `simulate`, which explains them."""

    method: Method | None = None
    mode: Mode = "inertial"
    load: LoadLike = None
    tilt: ArrayLike = (0.0, 0.0)
    drag: ArrayLike | None = None
    tip: OscillatingContact | None = None
    friction: UniformFriction | None = None
    time_step: float | None = None
    tolerance: float | None = None
    frames: int = 200

    def __post_init__(self) -> None:
        """Check what needs nothing else."""
        if self.method is not None:
            check_choice("method", self.method, get_args(Method))
        check_choice("mode", self.mode, get_args(Mode))
        as_count("frames", self.frames)
        for name in ("time_step", "tolerance"):
            if getattr(self, name) is not None:
                as_positive(name, getattr(self, name))
        if self.time_step is not None and self.method == "events":
            raise InputError("time_step", "is for steps", remedy="leave it out or use steps")

    def refuse(self, what: str, *names: str) -> None:
        """Raise InputError for options that make no sense for what is simulated."""
        for name in names:
            if getattr(self, name) is not None:
                raise InputError(name, f"is not for {what}", remedy="leave it out")


def checked_drag(given: ArrayLike, mode: Mode) -> Array:
    """Return viscous drag (3,), positive in quasi-static mode."""
    drag = np.array(as_array("drag", given, 3))  # kernels are compiled anew for read-only arrays
    if (drag < 0.0).any():
        raise InputError("drag", "must be at least 0", value=tuple(drag.tolist()))
    if mode == "quasi-static" and not drag.all():
        raise InputError(
            "drag",
            "must be positive in quasi-static mode, where it alone limits the speed",
            value=tuple(drag.tolist()),
            remedy="use mode='inertial' or give all three",
        )
    return drag


def check_choice(name: str, value: str, known: tuple[str, ...]) -> None:
    """Raise InputError unless a value is one of those known."""
    if value not in known:
        raise InputError(name, "is unknown", value=value, remedy=f"use {' or '.join(known)}")
