"""Implicit steps on arrays beside one warm-started solve, cvxpy, and themselves on two cores.

Usage: python benchmarks/bench_motion.py [steps] [book] [cvxpy] [many]

Without arguments all four run; `many` takes a quarter of an hour and wants two idle cores.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
import time
from dataclasses import replace
from statistics import median

import cvxpy as cp
import numpy as np
from numba import njit
from scipy.constants import g
from timing import timed

import limitsurf as ls
from limitsurf.kernels.contact_pass import Contacts
from limitsurf.kernels.contact_problem import Problem, new_best, new_setting, second_moments
from limitsurf.kernels.contact_sum import solve_contact_sum
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.row_spans import no_spans
from limitsurf.kernels.tip_list import new_tips
from limitsurf.kernels.tips import move_tips
from limitsurf.motion.array_steps import ground_of
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.starts import random_starts
from limitsurf.motion.time_scales import time_scales
from limitsurf.motion.trajectory import Outcome
from limitsurf.tolerances import CONTACT_STEP

GRIP = 0.05


def scene(tips, across):
    """Return a square over so many active tips of an array, all of which push one way."""
    array = ls.load_array("resonator64")
    pixel = replace(array.pixel, residual_fraction=GRIP)
    array = replace(array, pixel=pixel, rows=across, columns=across)
    side = np.sqrt(tips) * pixel.pitch
    part = ls.Part([(0, 0), (side, 0), (side, side), (0, side)], "80 g/m^2")
    drive = ls.Activation(array, array.site_directions @ np.array([0.0, 1.0]) > 0.5)
    return part, drive


def contacts_at(part, drive, pose):
    """Return a `ContactSet` of the tips at a pose, shares included, by the library's own list."""
    lattice, part_edges = ground_of(drive).lattice, part.edges
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[c, s], [-s, c]])
    edges = np.hstack([part_edges[:, :2] @ turn, part_edges[:, 2:] @ turn]) + np.tile(pose[:2], 2)
    tips = new_tips(lattice, part.circumradius)
    move_tips(lattice, edges, pose[0], pose[1], tips, no_spans())
    n = tips.numbers[0]
    data = tips.buffer[: 3 * tips.numbers[1]].reshape(3, -1)[:, :n]
    rows, columns = tips.rows[:n], tips.columns[:n]
    pixel, share = drive.array.pixel, data[2]
    normal = part.mass * g * share / share.sum()
    push = pixel.friction * pixel.offset_fraction * normal[:, None]
    return ls.ContactSet(
        data[:2].T,
        pixel.friction * pixel.residual_fraction * normal,
        push * lattice.directions[rows, columns],
    )


@njit
def solve_again(data, C, c, unit, tol, v, eps, repeats):
    """Solve the same contact sum so many times from the same start; return what the last found."""
    best, none = new_best(), np.empty((0, 2))
    n = data.shape[1]
    table, contacts = new_table(n), Contacts(data, 1, None)
    for _ in range(repeats):
        setting = new_setting(n, second_moments(contacts), C, c, unit, tol)
        solve_contact_sum(Problem(contacts, table, setting), best, v, eps, none)
    return best


def warm_solves(part, drive, path, dt):
    """Return the time of a warm-started compiled solve at each pose of a path [s]."""
    mass = np.array([part.mass, part.mass, part.inertia])
    root = 1.0 / np.sqrt(mass / dt + air_film_drag(part, drive.array))
    C = (root[0], 0.0, 0.0), (0.0, root[1], 0.0), (0.0, 0.0, root[2])
    best, times = None, []
    for pose, v0 in zip(path.poses[1:-1], path.twists[:-2], strict=True):
        contacts = contacts_at(part, drive, pose)
        data = np.ascontiguousarray(np.vstack([contacts.position.T, contacts.radius]))
        c = tuple((contacts.offset_load + mass * v0 / dt).tolist())
        v, eps = ((0.0, 0.0, 0.0), -1.0) if best is None else (tuple(best[7:10].tolist()), best[10])
        repeats = max(1, 20_000 // len(contacts))
        call = (data, C, c, float(root[0]), CONTACT_STEP, v, float(eps), repeats)
        solve_again(*call[:-1], 1)
        begin = time.perf_counter()
        best = solve_again(*call)
        times.append((time.perf_counter() - begin) / repeats)
    return times[1:]


def steps():
    """Print the cost of a step beside one warm-started solve of the same contacts."""
    print("| tips | step, us | one warm solve, us | ratio |")
    print("|---|---|---|---|")
    for tips, across, count in (
        (100, 60, 300),
        (1000, 100, 300),
        (10_000, 200, 200),
        (100_000, 480, 60),
        (950_000, 1300, 16),
    ):
        part, drive = scene(tips, across)
        dt = time_scales(part, drive.array).step
        twist = (2e-3, -1e-3, 1e-3 / part.circumradius)

        def run(number, frames):
            path = ls.simulate(
                part,
                drive,
                (1e-5, 2e-5, 0.3),
                number * dt,
                twist=twist,
                time_step=dt,
                frames=frames,
            )
            assert path.outcome is Outcome.TIME_LIMIT
            return path

        path = run(count, count)
        short, _ = timed(lambda: run(1, 1), 5)
        long, _ = timed(lambda: run(count + 1, 1), 5)
        step, solve = (long - short) / count, float(np.mean(warm_solves(part, drive, path, dt)))
        print(f"| {path.tips[-1]} | {1e6 * step:.1f} | {1e6 * solve:.1f} | {step / solve:.2f} |")


def book():
    """Print the share of bookkeeping in a step on 1000 x 1000 pixels."""
    part, drive = scene(950_000, 1000)
    dt = time_scales(part, drive.array).step
    twist, start = np.array([2e-3, -1e-3, 1e-3 / part.circumradius]), (1e-5, 2e-5, 0.0)

    def run(count):
        return ls.simulate(part, drive, start, count * dt, twist=twist, time_step=dt, frames=1)

    run(2)
    short, _ = timed(lambda: run(1), 3)
    long, path = timed(lambda: run(17), 3)
    step = (long - short) / 16
    lattice, tips, spans = ground_of(drive).lattice, None, no_spans()
    tips, times, pose = new_tips(lattice, part.circumradius), [], np.array(start)
    for _ in range(18):
        c, s = np.cos(pose[2]), np.sin(pose[2])
        turn = np.array([[c, s], [-s, c]])
        edges = np.hstack([part.edges[:, :2] @ turn, part.edges[:, 2:] @ turn])
        edges += np.tile(pose[:2], 2)
        begin = time.perf_counter()
        spans = move_tips(lattice, edges, pose[0], pose[1], tips, spans)
        times.append(time.perf_counter() - begin)
        pose = pose + dt * twist
    first, later = times[0], median(times[2:])
    print(f"{path.tips[-1]} tips: step {1e3 * step:.2f} ms, of it bookkeeping {1e3 * later:.3f} ms")
    print(f"({100 * later / step:.1f} %); listing all tips once takes {1e3 * first:.1f} ms")


class ConicStep:
    """The same implicit step as a parametrised cvxpy problem."""

    def __init__(self, part, array, n, dt):
        self.mass = np.array([part.mass, part.mass, part.inertia])
        self.rho = np.sqrt(part.inertia / part.mass)
        q = (self.mass / dt + air_film_drag(part, array)) / [1, 1, self.rho**2]
        self.dt, self.unit, self.v = dt, part.mass * g, cp.Variable(3)
        self.speed = 1e-2
        self.m, self.mx, self.my, self.c = (cp.Parameter(k) for k in (n, n, n, 3))
        u = cp.vstack(
            [self.m * self.v[0] - self.my * self.v[2], self.m * self.v[1] + self.mx * self.v[2]]
        )
        smooth = 0.5 * cp.sum_squares(cp.multiply(np.sqrt(q * self.speed / self.unit), self.v))
        friction = cp.sum(cp.norm(u, 2, axis=0))
        self.problem = cp.Problem(cp.Minimize(smooth + friction - self.c @ self.v))
        assert self.problem.is_dpp()

    def __call__(self, contacts, v0):
        """Return the twist after a step."""
        m, (x, y) = contacts.radius / self.unit, contacts.position.T / self.rho
        for parameter, values in ((self.m, m), (self.mx, m * x), (self.my, m * y)):
            parameter.value = np.pad(values, (0, parameter.size - len(contacts)))
        load = contacts.offset_load + self.mass * v0 / self.dt
        self.c.value = load / self.unit / [1, 1, self.rho]
        self.problem.solve(solver=cp.CLARABEL)
        return self.speed * self.v.value / [1, 1, self.rho]


def conic_run(part, drive, step, pose, twist, count):
    """Return the end of so many steps by cvxpy, and the time of one [s], with and without contacts.

    Contacts are found by the library; to find them in Python takes longer.
    """
    pose, times = np.array(pose, float), []
    for _ in range(count):
        begin = time.perf_counter()
        contacts = contacts_at(part, drive, pose)
        middle = time.perf_counter()
        twist = step(contacts, twist)
        end = time.perf_counter()
        times.append((end - begin, end - middle))
        pose = pose + step.dt * twist
    return pose, *np.median(times, axis=0)


def against_cvxpy():
    """Print the time of a step at N = 100 beside the parametrised cvxpy problem."""
    part, drive = scene(100, 40)
    dt, count = time_scales(part, drive.array).step, 100
    start, twist = (1e-5, 2e-5, 0.3), np.array([2e-3, -1e-3, 1e-3 / part.circumradius])
    conic = ConicStep(part, drive.array, 120, dt)
    conic_run(part, drive, conic, start, twist, 2)
    end, slow, solve = conic_run(part, drive, conic, start, twist, count)

    def run(count):
        return ls.simulate(part, drive, start, count * dt, twist=twist, time_step=dt, frames=1)

    path = run(count)
    short, long = timed(lambda: run(1), 9)[0], timed(lambda: run(count + 1), 9)[0]
    fast = (long - short) / count
    apart = np.abs((path.final_pose - end) / [part.circumradius, part.circumradius, 1]).max()
    print(f"N = {path.tips[-1]}: {1e6 * fast:.1f} us a step, cvxpy {1e6 * slow:.0f} us, ", end="")
    print(f"{slow / fast:.0f}x, of it solving {1e6 * solve:.0f} us, {solve / fast:.0f}x;")
    print(f"poses after {count} steps differ by {apart:.0e} (circumradii, rad)")


def many(count=10_000):
    """Print the time of many starts on one and two cores, and of cvxpy, extrapolated."""
    part, array = ls.Part.from_file("paper_t"), ls.load_array("resonator64")
    drive, dt = ls.squeeze_activation(array, 0.0), time_scales(part, array).step
    starts = random_starts(count, 1, 0.5 * part.circumradius)
    ls.simulate_many(part, drive, starts[:4])
    for options, what in (({}, "fixed steps"), ({"tolerance": 1e-4}, "adaptive steps, 1e-4")):
        times = []
        for jobs in (1, 2):
            begin = time.perf_counter()
            runs = ls.simulate_many(part, drive, starts, jobs=jobs, **options)
            times.append(time.perf_counter() - begin)
        print(f"{what}: {runs}; one core {times[0]:.0f} s, two {times[1]:.0f} s: ", end="")
        print(f"{times[0] / times[1]:.2f}x")
        if not options:
            steps_taken, base = runs.durations.mean() / dt, times[1]
    conic = ConicStep(part, array, 300, dt)
    each = [conic_run(part, drive, conic, s, np.zeros(3), 12)[2] for s in starts[:20]]
    whole = median(each) * steps_taken * count
    print(f"cvxpy, extrapolated from 12 steps of 20 starts: {whole / 3600:.1f} h, ", end="")
    print(f"{whole / base:.0f}x the fixed steps on two cores")


if __name__ == "__main__":
    tasks = {"steps": steps, "book": book, "cvxpy": against_cvxpy, "many": many}
    for name in sys.argv[1:] or tasks:
        print(f"## {name}")
        tasks[name]()
