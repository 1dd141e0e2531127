"""Continuum fields: exact loads beside shapely, uniform friction beside many contacts.

Usage: python benchmarks/bench_fields.py

One thread. Loads: a squeeze field on the paper T and on a 200-gon; the twin clips with shapely and
integrates over a triangulation. Friction: the paper T; contacts are those of a patch of uniform
pressure, cut finer and finer; errors are distances from the exact answer over the size of the load.
Arrays: `resonator64` with pixels of other pitch, point tips and no grip, squeezing the paper T
towards a line at 0.3 rad; root mean squares of the differences from the density, loads in units of
push and circumradius; powers from the three finest pitches. Then random parts: hard closest points,
and what rises on the way to rest.
"""

import os
from dataclasses import replace
from functools import partial

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import shapely
from scipy.interpolate import PchipInterpolator
from timing import timed

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.actuators.density_field import DensityField, push_density
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.field_motion import field_motion
from limitsurf.motion.simulate import simulate
from limitsurf.planning.turn_function import turn_function

LOADS = 200
ARRAY = load_array("resonator64")


def shapely_load(part, pose, line):
    """Return the load of a squeeze of unit density towards a line through the origin."""
    outline, load = part.at(pose), np.zeros(3)
    along, n = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    reach = 10.0 * (part.circumradius + np.hypot(pose[0], pose[1]))
    for side in (1.0, -1.0):
        ends = [-reach * along, reach * along]
        half = shapely.Polygon([*ends, ends[1] + side * reach * n, ends[0] + side * reach * n])
        clipped = shapely.intersection(outline, half)
        if clipped.is_empty:
            continue
        area, force = clipped.area, -side * n
        r = shapely.get_coordinates(clipped.centroid)[0] - pose[:2]
        load += area * np.array([*force, r[0] * force[1] - r[1] * force[0]])
    return load


def gon(corners):
    turn = 2 * np.pi * np.arange(corners) / corners
    return Part(1e-3 * np.column_stack([np.cos(turn), np.sin(turn)]), "80 g/m^2")


def loads():
    print("| part | one call, us | of many, us | shapely, us | ratio | largest difference |")
    print("|---|---|---|---|---|---|")
    rng, field = np.random.default_rng(0), DensityField.squeeze(0.3, 1.0)
    for name, part in (("paper T", Part.from_file("paper_t")), ("200-gon", gon(200))):
        R = part.circumradius
        poses = rng.normal(size=(LOADS, 3)) * [0.3 * R, 0.3 * R, 2.0]
        field.load(part, poses)
        one, exact = timed(lambda: np.array([field.load(part, q) for q in poses]))
        many, _ = timed(lambda: field.load(part, poses))
        slow, twin = timed(lambda: np.array([shapely_load(part, q, 0.3) for q in poses]))
        off = np.abs(exact - twin).max(axis=0) / (part.area * np.array([1.0, 1.0, R]))
        one, many, slow = (1e6 * t / LOADS for t in (one, many, slow))
        row = f"{one:.1f} | {many:.2f} | {slow:.0f} | {slow / one:.0f} | {off.max():.0e}"
        print(f"| {name} | {row} |")


def friction():
    print("\n| friction | contacts | a load, us | largest error |")
    print("|---|---|---|---|")
    rng, part = np.random.default_rng(0), Part.from_file("paper_t")
    S = UniformFriction(part, 1.0)
    arm = np.sqrt(part.polar_moment / part.area)
    W = np.array([1.0, 1.0, 1.0 / arm**2])
    p = S.support_point(rng.normal(size=(LOADS, 3)) / [1, 1, arm])
    p *= rng.choice([0.5, 0.9, 1.1, 2.0, 5.0], size=(LOADS, 1))
    S.project(p, W)
    one, _ = timed(lambda: [S.project(q, W) for q in p])
    many, exact = timed(lambda: S.project(p, W))
    size = np.sqrt((p**2) @ W) + part.area
    print(f"| exact, one call each | - | {1e6 * one / LOADS:.1f} | - |")
    bound = (exact.error_bound / size).max()
    print(f"| exact, many | - | {1e6 * many / LOADS:.2f} | {bound:.0e} (certified) |")
    for share in (0.3, 0.1, 0.03, 0.01):
        contacts, _ = S.contact_set(share * part.circumradius)
        contacts.project(p[:2], W)
        few = p[:20] if len(contacts) > 50_000 else p
        time, found = timed(lambda: contacts.project(few, W), repeats=3)
        off = np.sqrt(((found.point - exact.point[: len(few)]) ** 2) @ W) / size[: len(few)]
        print(f"| contacts | {len(contacts)} | {1e6 * time / len(few):.0f} | {off.max():.0e} |")


def motions():
    print("\n| motion of the 200-gon, 60 circumradii | ms |")
    print("|---|---|")
    part = gon(200)
    R = part.circumradius
    field, S = DensityField.squeeze(0.3, 0.1), UniformFriction(part, 0.02)
    drag = 45.0 * np.array([part.mass, part.mass, part.inertia])
    kinds = {
        "quasi-static": {"mode": "quasi-static", "drag": drag},
        "damped": {"drag": drag},
        "rubbing": {"friction": S},
    }
    for name, kind in kinds.items():
        for method in ("events", "steps"):
            start = (0.0, 0.5 * R, 0.3)
            field_motion(part, field, start, method=method, **kind)
            time, path = timed(
                lambda: field_motion(part, field, start, method=method, **kind), repeats=3
            )
            what = f"{path.outcome} after {path.duration:.3g} s"
            print(f"| {name}, {method}: {what} | {1e3 * time:.1f} |")


def arrays():
    """Print how an array of point tips differs from its density, pitch by pitch."""
    print("\n| pitch, um | load | rest, rad | path, rad |")
    print("|---|---|---|---|")
    rng, line, part, base = np.random.default_rng(0), 0.3, Part.from_file("paper_t"), ARRAY
    density, R = push_density(part, base), part.circumradius
    field = DensityField.squeeze(line, density / (np.cos(line) + np.sin(line)))
    drag = air_film_drag(part, base)
    poses = np.column_stack([rng.uniform(-2e-3, 2e-3, (24, 2)), rng.uniform(0, 6.28, 24)])
    starts = np.column_stack([rng.uniform(-5e-4, 5e-4, (6, 2)), rng.uniform(0, 6.28, 6)])
    unit, exact = density * part.area * np.array([1, 1, R]), field.load(part, poses)
    still = {"mode": "quasi-static", "drag": drag, "frames": 1000}
    rows = []
    for pitch in (4e-4, 2e-4, 1e-4, 5e-5):
        count = round(base.width / pitch)
        pixel = replace(base.pixel, pitch=pitch, tip_width=0.0, residual_fraction=0.0)
        drive = squeeze_activation(replace(base, pixel=pixel, rows=count, columns=count), line)
        move = partial(simulate, part, drive, mode="quasi-static", frames=1000)
        loads = np.array([move(q, 1e-9, time_step=1e-9).loads[0] for q in poses])
        ends, apart = [], []
        for q in starts:
            path = move(q, 12.0, time_step=2.5 * pitch)
            limit = field_motion(part, field, q, path.duration, **still)
            ends.append(path.final_pose[2] - limit.final_pose[2])
            t = np.linspace(0.0, min(path.duration, limit.duration), 50)
            a, b = (PchipInterpolator(m.times, m.poses[:, 2])(t) for m in (path, limit))
            apart.append(a - b)
        rows.append([np.sqrt(np.mean(np.square(e))) for e in ((loads - exact) / unit, ends, apart)])
        print(f"| {1e6 * pitch:.0f} | " + " | ".join(f"{e:.1e}" for e in rows[-1]) + " |")
    rates = np.polyfit(np.log([2e-4, 1e-4, 5e-5]), np.log(rows[1:]), 1)[0]
    print("| power of the pitch | " + " | ".join(f"{r:.2f}" for r in rates) + " |")


def star(rng, thin=1.0):
    """Return a random part, hardly ever convex."""
    n = rng.integers(4, 40)
    angle = 2 * np.pi / n * (np.arange(n) + rng.uniform(0.0, 0.8, n))
    radius = rng.uniform(0.3, 2.0, n)
    return Part(np.column_stack([radius * np.cos(angle), thin * radius * np.sin(angle)]), 1.0)


def hard_loads():
    """Print how closest points fare on slender parts, in stretched metrics, near the boundary."""
    rng, counts, worst, most, wrong = np.random.default_rng(1), np.zeros(4, int), 0.0, 0, 0
    for _ in range(150):
        S = UniformFriction(star(rng, 10 ** rng.uniform(-1.7, 0)), 10 ** rng.uniform(-3, 3))
        boundary = S.support_point(rng.normal(size=(200, 3)) * [1, 1, 10 ** rng.uniform(-2, 2)])
        near = 1 + rng.choice([-1, 1], 50) * 10 ** rng.uniform(-14, -2, 50)
        share = np.concatenate([rng.choice([0.01, 0.5, 0.99, 1.01, 2, 100, 1e6], 150), near])
        turn, stretch = np.linalg.qr(rng.normal(size=(3, 3)))[0], 10 ** rng.uniform(0, 8)
        root = np.diag([1, stretch**0.25, stretch**0.5]) @ turn.T
        p = boundary * share[:, None]
        found = S.project(p, root.T @ root, throw=False)
        size = np.linalg.norm(p @ root.T, axis=1) + np.linalg.norm(boundary @ root.T, axis=1)
        counts += np.bincount(found.status, minlength=4)
        worst, most = (
            max(worst, (found.error_bound / size).max()),
            max(most, found.iterations.max()),
        )
        wrong += np.sum((found.inside != (share < 1)) & (abs(share - 1) > 1e-10))
    print(
        f"\n30000 hard loads: status outside, inside, failed, loose {counts}; {wrong} on the wrong"
    )
    print(f"side; at most {most} iterations; largest bound {worst:.1e} of the load")


def uphill():
    """Print how often the reduced potential rises on the way to rest in a squeeze field."""
    rng, field = np.random.default_rng(5), DensityField.squeeze(0.0, 1.0)
    for where in ("anywhere", "on the median"):
        rises, own = [], []
        for _ in range(40):
            part = star(rng)
            turn, drag = turn_function(part), (part.area, part.area, part.polar_moment)
            for phi in rng.uniform(0.0, 2 * np.pi, 3):
                y = part.circumradius * rng.uniform(-1, 1)
                y = y if where == "anywhere" else -turn.median(phi)[0]
                path = field_motion(part, field, (0, y, phi), 1e4, mode="quasi-static", drag=drag)
                U, V = turn.potential(path.poses[:, 2]), field.potential(part, path.poses)
                rises.append((U - np.minimum.accumulate(U)).max() / U[0])
                own.append(np.diff(V).max() / V[0])
        count, most = np.sum(np.array(rises) > 1e-9), max(rises)
        print(f"starts {where}: reduced U rises in {count} of 120, by up to {most:.1e};")
        print(f"the potential in {np.sum(np.array(own) > 1e-12)}")


if __name__ == "__main__":
    loads()
    friction()
    motions()
    arrays()
    hard_loads()
    uphill()
