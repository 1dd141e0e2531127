"""Errors of limitsurf: one base, few children, each carrying its data."""

from __future__ import annotations

from typing import Any

__all__ = [
    "AmplitudeBeyondClearance",
    "BeyondPullIn",
    "DataError",
    "InputError",
    "LimitSurfError",
    "ModelError",
    "NoPlan",
    "OutsideSupports",
    "PartTooHeavy",
    "SolveFailed",
    "TipStalled",
    "TooManyEvents",
]


class LimitSurfError(Exception):
    """Base of every error that limitsurf raises on purpose."""


class InputError(LimitSurfError, ValueError):
    """An argument has a value that cannot be used.

    Parameters
    ----------
    argument : str
        Name of the argument, option or field.
    problem : str
        What is wrong with it.
    value : object, optional
        The offending value; shown when it is short.
    remedy : str, optional
        What to do about it.
    """

    def __init__(self, argument: str, problem: str, *, value: Any = None, remedy: str = "") -> None:
        self.argument, self.problem, self.value, self.remedy = argument, problem, value, remedy
        got = "" if value is None or len(repr(value)) > 60 else f" (got {value!r})"
        super().__init__(f"{argument}: {problem}{got}" + (f"; {remedy}" if remedy else ""))


class ModelError(InputError):
    """A model or outline file cannot be used; `file` and `argument` (the field) say where."""

    def __init__(
        self, file: object, field: str, problem: str, *, value: Any = None, remedy: str = ""
    ) -> None:
        self.file, self.field = str(file), field
        where = f"{file}: {field}" if field else str(file)
        super().__init__(where, problem, value=value, remedy=remedy)


class DataError(InputError):
    """A data file cannot be used; `file`, `line` (from 1) and `column` say where, if known."""

    def __init__(
        self,
        file: object,
        problem: str,
        *,
        line: int | None = None,
        column: str = "",
        value: Any = None,
        remedy: str = "",
    ) -> None:
        self.file, self.line, self.column = str(file), line, column
        places = (str(file), "" if line is None else f"line {line}", column)
        super().__init__(": ".join(filter(None, places)), problem, value=value, remedy=remedy)


class PartTooHeavy(LimitSurfError):
    """The active tips cannot carry the part at this voltage.

    Parameters
    ----------
    weight_per_tip : float
        Share of the part's weight on one active tip [N].
    vertical_force : float
        What one tip lifts at `voltage` [N].
    voltage, lifting_voltage : float
        The voltage in use and the one that would carry the part [V].
    """

    def __init__(
        self, weight_per_tip: float, vertical_force: float, voltage: float, lifting_voltage: float
    ) -> None:
        self.weight_per_tip, self.vertical_force = weight_per_tip, vertical_force
        self.voltage, self.lifting_voltage = voltage, lifting_voltage
        super().__init__(
            f"voltage: {voltage:g} V lifts {vertical_force:.3g} N per active tip, but the part "
            f"puts {weight_per_tip:.3g} N on each; {lifting_voltage:.3g} V would lift it"
        )


class BeyondPullIn(LimitSurfError):
    """A constant voltage at or above `pull_in` [V]: the grid snaps to its electrode."""

    def __init__(self, voltage: float, pull_in: float) -> None:
        self.voltage, self.pull_in = voltage, pull_in
        super().__init__(
            f"voltage: {voltage:g} V pulls the grid onto its electrode, which happens at "
            f"{pull_in:.4g} V; stay below"
        )


class AmplitudeBeyondClearance(LimitSurfError):
    """The edge would swing as far as its electrode, `clearance` [m] away."""

    def __init__(self, voltage: float, amplitude: float, clearance: float) -> None:
        self.voltage, self.amplitude, self.clearance = voltage, amplitude, clearance
        super().__init__(
            f"voltage: at {voltage:g} V the edge would swing {1e6 * amplitude:.3g} um, at or "
            f"beyond the clearance of {1e6 * clearance:.3g} um; lower the voltage or the "
            "quality factor"
        )


class TipStalled(LimitSurfError):
    """Under `load` [N] the resonator at `voltage` [V] cannot keep swinging free of the part."""

    def __init__(self, load: float, voltage: float, reason: str) -> None:
        self.load, self.voltage = load, voltage
        super().__init__(
            f"load: {load:.3g} N at {voltage:g} V: {reason}; raise the voltage or lower the load"
        )


class OutsideSupports(LimitSurfError):
    """No supports that only push can carry a part whose centre of mass they do not surround.

    Parameters
    ----------
    center_of_mass : (2,) float
        Where it is [m].
    distance : float
        How far outside the convex hull of the supports [m].
    """

    def __init__(self, center_of_mass: tuple[float, ...], distance: float) -> None:
        self.center_of_mass, self.distance = center_of_mass, distance
        where = ", ".join(f"{c:.4g}" for c in center_of_mass)
        super().__init__(
            f"the centre of mass is outside the supports: ({where}) m lies {distance:.3g} m beyond "
            "their convex hull; add a support there or move the part"
        )


class NoPlan(LimitSurfError):
    """No sequence of lines meets the request.

    Parameters
    ----------
    reason : str
        Why, with angles in degrees.
    reachable_margin : float
        The largest margin of any plan [rad]; 0 if there is no plan.
    plan : LinePlan, optional
        The plan that comes closest to the request, if there is one.
    """

    def __init__(self, reason: str, reachable_margin: float, plan: Any = None) -> None:
        self.reason, self.reachable_margin, self.plan = reason, reachable_margin, plan
        super().__init__(reason)


class SolveFailed(LimitSurfError):
    """A solver stopped before its certificate met the tolerance; `best` is what it had."""

    def __init__(self, message: str, best: Any = None) -> None:
        self.best = best
        super().__init__(message)


class TooManyEvents(LimitSurfError):
    """A motion had `max_events` events when it was at `time` [s]."""

    def __init__(self, max_events: int, time: float) -> None:
        self.max_events, self.time = max_events, time
        super().__init__(
            f"max_events: {max_events} events until {time:.6g} s; raise it, or give a shorter "
            "duration"
        )
