"""Compile all kernels once, so that no later call has to wait for the compiler."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Annotated, Any

import numpy as np
import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

__all__ = ["GROUPS", "warm_up"]


def _sets() -> None:
    """Use every kind of set once."""
    import limitsurf as ls

    cloud = np.random.default_rng(0).normal(size=(40, 3))
    p = [9.0, 8.0, 7.0]
    hull = ls.VPolytope(cloud)
    box = ls.HPolytope(np.vstack([np.eye(3), -np.eye(3)]), np.ones(6))
    quartic = ls.PolynomialSet([[4, 0, 0], [0, 4, 0], [0, 0, 4], [2, 0, 0]], [1.0, 1.0, 1.0, 1.0])
    for s in (ls.Ellipsoid([0, 0, 0], np.eye(3)), hull, box, hull.to_h(), quartic):
        s.project(p)
        s.support_point(p)
    ls.MinkowskiSum(hull, ls.VPolytope(cloud + cloud[::-1])).project(p)
    ls.Zonotope([0, 0, 0], cloud[:5]).project(p)


def _contacts() -> None:
    """Use sums of few, many and ragged contacts, a lattice, a plan and a simulation once."""
    import limitsurf as ls

    rng = np.random.default_rng(0)
    position, load = rng.normal(size=(5000, 2)), [3.0, 2.0, 1.0]
    ls.ContactSum(position[:20], np.ones(20)).project(load).contact_forces()
    ls.ContactSum(position, np.ones(5000)).project(load, sublinear=True)
    ls.project_many((position[:20], np.ones(20), [10, 10]), [load, load])
    part = ls.Part.from_file("paper_t")
    drive = ls.squeeze_activation(ls.load_array("resonator32"), 0.0)
    ls.simulate(part, drive, duration=1e-3)
    for mode in ("inertial", "quasi-static"):
        ls.simulate(part, drive, duration=1e-3, mode=mode, method="events")
    ls.LatticeContacts(part, 1e-4, (0.0, 0.0)).move((0.0, 0.0, 0.1))


def _motion() -> None:
    """Move a part on feet and in a field, push and walk once."""
    import limitsurf as ls

    part = ls.Part([(0, 0), (1, 0), (1, 1), (0, 1)], 1.0)
    corners = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]]
    feet = ls.ContactSet(corners, 0.5)
    ovals = ls.ContactSet(corners, 0.5, ellipse=[[[1.0, 0.0], [0.0, 0.5]]] * 4)
    start: dict[str, Any] = {"pose": (0, 0.1, 0.2), "duration": 0.1, "twist": (1.0, 0.5, 1.0)}
    ways: list[dict[str, Any]] = [{}, {"method": "steps"}, {"mode": "quasi-static"}]
    for contacts in (feet, ovals):
        for way in ways:
            ls.simulate(part, contacts, load=(1.5, 0.5, 0.2), drag=(1, 1, 1), **start, **way)
    friction = ls.UniformFriction.under_weight(part, 0.1)
    for way in ways[:2]:
        field = ls.DensityField.squeeze(0.0, 1.0)
        ls.simulate(part, field, friction=friction, **start, **way)
    ls.push(feet, [1, 0], [0, 1])
    ls.push_along(feet, [[0.5, 0.0], [0.5, 0.1]])
    ls.walk(feet, 0.1, drag=(1, 1, 1))


def _resonators() -> None:
    """Float a part on a resonator once."""
    from limitsurf.actuators.resonator_sweep import sweep_resonators
    from limitsurf.actuators.torsional_resonator import TorsionalResonator

    resonator = TorsionalResonator.from_model("resonator1994")
    resonator.floating(3e-8, 50.0, 0.3).waveforms(16)
    resonator.static_tilt(50.0)
    sweep_resonators(resonator, 3e-8, 50.0, 0.3)


def _planning() -> None:
    """Plan and verify an alignment in the ideal field, and look for equilibria once."""
    import limitsurf as ls

    part = ls.Part.from_file("paper_t")
    turn = ls.turn_function(part)
    turn.critical_angle, turn.pieces, turn.certificate, turn.moment(0.0)
    plan = ls.plan_alignment(part, model="centred")
    ls.verify_alignment(plan, part, ls.IdealSqueeze(1.0), samples=2)
    ls.expected_duration(plan, ls.load_array("resonator64"))
    for far in (0.0, 10.0):
        ls.RadialField(1.0).load(part, (far * part.circumradius, 0.0, 0.0))


#: What is compiled side by side, the longest first: groups that share few kernels.
GROUPS: dict[str, Callable[[], None]] = {
    "contacts and arrays": _contacts,
    "motion": _motion,
    "planning": _planning,
    "convex sets": _sets,
    "resonators": _resonators,
}


def _timed(name: str) -> tuple[str, float]:
    start = time.perf_counter()
    GROUPS[name]()
    return name, time.perf_counter() - start


def warm_up(
    processes: Annotated[int, typer.Option(min=1, help="Processes to compile in.")] = 2,
) -> None:
    """Compile all kernels once; some minutes after installation, a second later on."""
    import limitsurf.kernels.compile  # noqa: F401 - drops stale caches before processes start

    columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
    with (
        Progress(*columns) as progress,
        ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool,
    ):
        task = progress.add_task("compiling kernels", total=len(GROUPS))
        for future in as_completed([pool.submit(_timed, name) for name in GROUPS]):
            name, seconds = future.result()
            progress.console.print(f"{name}: {seconds:.1f} s")
            progress.advance(task)
