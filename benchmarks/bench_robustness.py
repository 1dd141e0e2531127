"""What robustness predicts for plans on arrays, beside simulations contact by contact.

Usage: python benchmarks/bench_robustness.py

One thread. `resonator64` with pixels of other pitch on the same 12.8 mm, tips a twentieth of a
pitch wide, no grip unless said; parts of 80 g/m^2, those of the reference scaled to a circumradius
of 2.4 mm. Predicted: the status, the share of starts at risk, and the width of the final
orientations, likely and worst; sigmas is the multiple of the root mean square up to which the plan
is not lost. Simulated: 40 starts with their centres on the array's centre (centred) or within half
a circumradius, line after line, adaptive steps of tolerance 3e-4; aligned is within 6 degrees of
the plan's end, and the spread that of those aligned. Then durations: quadrature in the continuum,
settled to one degree, beside runs of `verify_alignment`, those that align.
"""

import json
import os
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from timing import timed

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.geometry.part import Part
from limitsurf.motion.simulate_many import simulate_many
from limitsurf.motion.starts import random_starts
from limitsurf.motion.trajectory import Outcome
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.duration import line_durations
from limitsurf.planning.field_errors import FieldErrors
from limitsurf.planning.robustness import robustness
from limitsurf.planning.verification import verify_alignment

BASE = load_array("resonator64")
RUNS = 40
ALIGNED = 6.0
CASES = Path(__file__).parents[1] / "tests/reference/alignment_cases.json"


def with_pitch(pitch, grip=0.0):
    count = round(BASE.width / pitch)
    pixel = replace(
        BASE.pixel,
        pitch=pitch,
        tip_width=pitch / 20,
        residual_fraction=grip * BASE.pixel.offset_fraction,
    )
    return replace(BASE, pixel=pixel, rows=count, columns=count)


def reference_part(name):
    cases = json.loads(CASES.read_text(encoding="utf-8"))
    vertices = np.array(next(c["vertices"] for c in cases if c["name"] == name))
    return Part(2.4e-3 * vertices / Part(vertices).circumradius, "80 g/m^2", name=name)


def errors_of_runs(plan, array, offset, method):
    """Return errors of the final orientations in degrees, modulo the plan's period.

    Infinite for parts that left the array.
    """
    poses = random_starts(RUNS, 1, offset)
    on = np.full(RUNS, True)
    for line in plan.lines:
        drive = squeeze_activation(array, line, method=method)
        runs = simulate_many(plan.part, drive, poses[on], tolerance=3e-4, jobs=1)
        poses[on] = runs.finals
        on[on] = runs.outcomes != Outcome.LEFT_ARRAY
    half = plan.period / 2
    errors = np.degrees(np.mod(poses[:, 2] - plan.final + half, plan.period) - half)
    return np.where(on, errors, np.inf)


def reachable_sigmas(plan, errors):
    """Return up to how many root mean squares the plan is not lost, at most eight."""
    loose = [replace(e, pixels_worst=1e6, spread_worst=1e6) for e in errors]
    low, high = 0.0, 8.0
    for _ in range(8):
        middle = 0.5 * (low + high)
        found = robustness(plan, loose, sigmas=middle).status != "lost"
        low, high = (middle, high) if found else (low, middle)
    return low


def row(what, plan, array, method="dither"):
    seconds, found = timed(lambda: robustness(plan, array, method=method), repeats=1)
    centred, offset = (
        errors_of_runs(plan, array, r, method) for r in (0.0, 0.5 * plan.part.circumradius)
    )
    good = np.abs(centred) < ALIGNED
    spread = f"{np.ptp(centred[good]):.2f}" if good.any() else "-"
    pixels = np.degrees(np.arctan(max(e.pixels for e in found.errors)))
    likely, worst = (np.degrees(p.final_width) for p in (found.likely, found.worst))
    print(
        f"| {plan.part.name} | {what} | {pixels:.1f} | {found.status} "
        f"| {reachable_sigmas(plan, found.errors):.1f} | {100 * found.likely.at_risk:.0f} "
        f"| {likely:.2f} | {worst:.2f} | {100 * good.mean():.0f} "
        f"| {100 * (np.abs(offset) < ALIGNED).mean():.0f} | {spread} | {seconds:.2f} |",
        flush=True,
    )


def predictions():
    print(
        "| part | array | pixels rms, deg | predicted | sigmas | at risk, % | width likely, deg "
        "| worst | aligned centred, % | offset, % | spread, deg | time, s |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    parts = [Part.from_file("paper_t"), Part.from_file("wheel_7_of_8")]
    parts += [reference_part(name) for name in ("T", "U_sym", "simple_16", "blob_m3")]
    for part in parts:
        plan = plan_alignment(part)
        for pitch in (4e-4, 2e-4, 1e-4):
            row(f"{1e6 * pitch:.0f} um", plan, with_pitch(pitch))
    plan = plan_alignment(parts[0])
    row("100 um, nearest axis", plan, with_pitch(1e-4), "nearest")
    for share in (0.05, 0.2):
        row(f"100 um, {100 * share:.0f} % dead", plan, with_pitch(1e-4).with_spread(dead=share))
    for grip in (0.01, 0.1, 0.5):
        row(f"100 um, grip {grip:g} of push", plan, with_pitch(1e-4, grip))


def sources():
    print("\n| paper T on 100 um, 5 % dead: line, deg | source | rest, deg | break, deg | lost |")
    print("|---|---|---|---|---|")
    plan = plan_alignment(Part.from_file("paper_t"))
    array = with_pitch(1e-4, 0.01).with_spread(dead=0.05)
    for r in robustness(plan, array).table():
        print(
            f"| {r['line_deg']:.1f} | {r['source']} | {r['rest_deg']:.2f} | {r['break_deg']:.2f} "
            f"| {r['lost']} |"
        )


def critical_angles():
    print("\n| part | loses its equilibria at a direction error of, deg |")
    print("|---|---|")
    corners = 2 * np.pi * np.arange(5) / 5
    shapes = {
        "square": [(0, 0), (1, 0), (1, 1), (0, 1)],
        "regular pentagon": np.column_stack([np.cos(corners), np.sin(corners)]),
        "rectangle 2:1": [(0, 0), (2, 0), (2, 1), (0, 1)],
    }
    for name, vertices in shapes.items():
        plan = plan_alignment(Part(vertices))
        low, high = 0.0, 80.0
        for _ in range(20):
            middle = 0.5 * (low + high)
            held = robustness(plan, FieldErrors(direction=np.radians(middle))).status != "lost"
            low, high = (middle, high) if held else (low, middle)
        print(f"| {name} | {low:.3f} |")


def settled(trajectory):
    off = np.abs(trajectory.poses[:, 2] - trajectory.final_pose[2]) > np.radians(1.0)
    return trajectory.times[np.flatnonzero(off)[-1]] if off.any() else 0.0


def durations():
    print(
        "\n| part | pitch, um | runs | expected, s | simulated, s | ratio | verify's, s | time, s |"
    )
    print("|---|---|---|---|---|---|---|---|")
    rows = (("paper_t", 2e-4, 100), ("wheel_7_of_8", 2e-4, 40), ("wheel_7_of_8", 1e-4, 40))
    for name, pitch, count in (*rows, ("wheel_7_of_8", 5e-5, 16)):
        plan, array = plan_alignment(Part.from_file(name)), with_pitch(pitch)
        seconds, found = timed(lambda: line_durations(plan, array), repeats=3)
        runs = verify_alignment(plan, plan.part, array, samples=count, seed=0, jobs=1)
        kept = np.flatnonzero(np.abs(runs.errors) < np.radians(ALIGNED))
        times = np.mean([sum(settled(t) for t in runs.replay(int(k), frames=300)) for k in kept])
        print(
            f"| {name} | {1e6 * pitch:.0f} | {len(kept)} | {found.sum():.2f} | {times:.2f} "
            f"| {found.sum() / times:.2f} | {runs.durations[kept].sum(axis=1).mean():.2f} "
            f"| {seconds:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    predictions()
    sources()
    critical_angles()
    durations()
