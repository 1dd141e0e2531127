"""How long the stages of an alignment take: turn function, plan, simulated steps.

Usage: python benchmarks/bench_alignment.py
"""

import time

from timing import timed

import limitsurf as ls

PARTS = (
    ("paper_t", "resonator64", 50.0),
    ("wheel_7_of_8", "resonator64", 50.0),
    ("nano_sim", "resonator128", 75.0),
)


def main():
    """Print one row for each part."""
    start = time.perf_counter()
    for name, array_name, voltage in PARTS[:1]:
        part, array = ls.Part.from_file(name), ls.load_array(array_name, voltage=voltage)
        ls.turn_function(part)
        ls.simulate(part, ls.squeeze_activation(array, 0.3), duration=0.01)
    print(f"first calls (imports, kernels compiled or read): {time.perf_counter() - start:.1f} s\n")
    print("| part | vertices | turn function, ms | plan, ms | tips | one step, us |")
    print("|---|---|---|---|---|---|")
    for name, array_name, voltage in PARTS:
        part, array = ls.Part.from_file(name), ls.load_array(array_name, voltage=voltage)
        turn, _ = timed(lambda: ls.turn_function(part))
        plan, _ = timed(lambda: ls.plan_alignment(part))
        drive = ls.squeeze_activation(array, 0.3)
        step = 1e-4
        run, path = timed(lambda: ls.simulate(part, drive, (0, 1e-3, 0.5), 0.2, time_step=step))
        print(
            f"| {name} | {len(part.edges)} | {1e3 * turn:.1f} | {1e3 * plan:.1f} "
            f"| {path.tips[0]} | {1e6 * run / (path.duration / step):.1f} |"
        )


if __name__ == "__main__":
    main()
