"""Sweep over resonator designs: one compiled pass, beside one design at a time in Python.

Usage: python benchmarks/bench_resonator.py
"One by one in Python" is the slow twin of the tests: NumPy for the torque, Gauss points for the
contact, SciPy for the roots. "One by one, compiled" calls `TorsionalResonator.floating` for each.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.actuators.resonator_twin import twin_floating
from timing import timed

from limitsurf.actuators.resonator_sweep import sweep_resonators
from limitsurf.actuators.torsional_resonator import TorsionalResonator

COUNT, FEW = 1000, 100
LOAD, VOLTAGE, MU = 3.1e-8, 50.0, 0.3


def main():
    base = TorsionalResonator.from_model("resonator1994")
    rng = np.random.default_rng(1)
    varied = {
        "rod_length": rng.uniform(25e-6, 31e-6, COUNT),
        "quality": rng.uniform(40.0, 65.0, COUNT),
        "contact_damping": rng.uniform(5e-8, 3e-7, COUNT),
        "pole_height": rng.uniform(1e-6, 6e-6, COUNT),
    }
    designs = [base.varied(**{k: float(v[i]) for k, v in varied.items()}) for i in range(COUNT)]
    sweep_resonators(base, LOAD, VOLTAGE, MU)
    fast, sweep = timed(lambda: sweep_resonators(base, LOAD, VOLTAGE, MU, **varied))
    assert np.all(sweep.status == 0)
    each, parts = timed(lambda: [d.floating(LOAD, VOLTAGE, MU) for d in designs], repeats=3)
    slow, twins = timed(
        lambda: [twin_floating(d, LOAD, VOLTAGE, MU) for d in designs[:FEW]], repeats=3
    )
    pushes = np.array([t[4] for t in twins])
    error = np.abs(sweep.offset_fraction[:FEW] / pushes - 1.0).max()
    same = np.abs(sweep.offset / [p.offset for p in parts] - 1.0).max()
    slow *= COUNT / FEW
    print(f"| {COUNT} designs | s | ratio | largest difference of the push |")
    print("|---|---|---|---|")
    print(f"| one pass | {fast:.3f} | 1 | |")
    print(f"| one by one, compiled | {each:.3f} | {each / fast:.1f} | {same:.0e} |")
    print(f"| one by one in Python ({FEW} timed) | {slow:.1f} | {slow / fast:.0f} | {error:.0e} |")


if __name__ == "__main__":
    main()
