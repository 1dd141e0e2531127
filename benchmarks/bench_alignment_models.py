"""How plans fare in the ideal squeeze field: under their own models, 2PHASE ones under full motion.

Usage: python benchmarks/bench_alignment_models.py [starts]
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

from limitsurf.errors import NoPlan
from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.separatrices import boundary_shift, separatrices
from limitsurf.planning.verification import verify_alignment

CASES = Path(__file__).parent.parent / "tests/reference/alignment_cases.json"
RATIOS = (0.1, 1.0, 10.0)
MODELS = ("centred", "push-squeeze", "unknown-offset")
SEED = 1


def main():
    """Print three tables."""
    starts = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    cases = json.loads(CASES.read_text())
    parts = [Part(np.array(case["vertices"]), name=case["name"]) for case in cases]
    IdealSqueeze().rest(parts[0], 0.1, 0.3)  # compile
    separatrices(parts[0])
    print(f"\n## Plans under their own model, {starts} starts: steps, share aligned\n")
    _own_models(parts, starts)
    print(f"\n## 2PHASE plans under full motion from random offsets, {starts} starts\n")
    _two_phase(parts, starts)
    print("\n## Times\n")
    _times(parts, starts)


def _own_models(parts, starts):
    columns = [f"{model}, {ratio:g}" for model in MODELS for ratio in RATIOS]
    print("| part | 2PHASE |", " | ".join(columns), "|")
    print("|" + "---|" * (len(columns) + 2))
    for part in parts:
        cells = [_cell(part, "squeeze", 1.0, IdealSqueeze(0.0), starts)]
        cells += [_cell(part, m, r, IdealSqueeze(r), starts) for m in MODELS for r in RATIOS]
        print(f"| {part.name} |", " | ".join(cells), "|", flush=True)


def _cell(part, model, ratio, drive, starts):
    try:
        plan = plan_alignment(part, model=model, mobility_ratio=ratio)
    except NoPlan:
        return "no plan"
    result = verify_alignment(plan, part, drive, starts, SEED)
    return f"{len(plan.lines)}: {_percent(result.rate)}"


def _percent(rate):
    return "100 %" if rate == 1.0 else f"{min(100 * rate, 99.9):.1f} %"


def _two_phase(parts, starts):
    print("| part | least margin, deg |", end="")
    print("".join(f" border moves, deg, {r:g} | aligned, {r:g} |" for r in RATIOS))
    print("|" + "---|" * (2 * len(RATIOS) + 2))
    rates = []
    for part in parts:
        plan = plan_alignment(part)
        results = [verify_alignment(plan, part, IdealSqueeze(r), starts, SEED) for r in RATIOS]
        rates.append([result.rate for result in results])
        margin = np.degrees(plan.least_margin)
        row = f"| {part.name} | {margin:.2f} |" if np.isfinite(margin) else f"| {part.name} | any |"
        for ratio, result in zip(RATIOS, results, strict=True):
            row += f" {np.degrees(boundary_shift(part, ratio)):.2f} | {_percent(result.rate)} |"
        print(row, flush=True)
    several = np.array(rates)[[len(plan_alignment(part).lines) > 1 for part in parts]]
    for name, table in (("mean", np.array(rates)), ("mean of those of several lines", several)):
        print(f"| {name} | |", "".join(f" | {_percent(r)} |" for r in table.mean(axis=0)))


def _times(parts, starts):
    print("| part | vertices | separatrices, ms | plan, ms | one run to rest, us |")
    print("|---|---|---|---|---|")
    for part in parts:
        curves, plan = _timed(separatrices, part), _timed(plan_alignment, part, model="centred")
        rng = np.random.default_rng(SEED)
        phi = rng.uniform(0, np.pi, starts)
        z = part.circumradius * rng.uniform(-0.5, 0.5, starts)
        rest = _timed(IdealSqueeze().rest, part, z, phi) / starts
        print(
            f"| {part.name} | {len(part.edges)} | {1e3 * curves:.0f} | {1e3 * plan:.0f} "
            f"| {1e6 * rest:.0f} |",
            flush=True,
        )


def _timed(call, *arguments, **options):
    start = time.perf_counter()
    call(*arguments, **options)
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
