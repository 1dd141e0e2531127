"""Radial loads beside quadrature, equilibria beside many starts, the range of the universal feeder.

Usage: python benchmarks/bench_equilibria.py

One thread. Loads: a unit radial field, centres within two circumradii. The twin spans triangles
between the centre and the edges and takes Gauss's rule with 64 nodes on each edge; it loses digits
where the centre is close to an edge. Equilibria: a radial field plus a squeeze of the same density
(isolated poses), and a radial plus a constant field; the twin is the Levenberg-Marquardt method
from 400 poses, which proves nothing. Feeder: the constant field over the radial one, and the number
of stable poses.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import shapely
from timing import timed

from limitsurf.actuators.density_field import DensityField
from limitsurf.actuators.radial_density import RadialField
from limitsurf.geometry.part import Part
from limitsurf.planning.equilibria import equilibria
from limitsurf.planning.many_starts import stationary_poses
from limitsurf.planning.universal_feeder import feeder_field, feeder_range

LOADS = 400
NODES, WEIGHTS = np.polynomial.legendre.leggauss(64)


def gon(corners, wave=0.0):
    turn = 2 * np.pi * np.arange(corners) / corners
    radius = 1.0 + wave * np.sin(2.0 * turn) + 0.5 * wave * np.sin(3.0 * turn + 1.0)
    return Part(np.column_stack([radius * np.cos(turn), radius * np.sin(turn)]))


PARTS = {
    "paper T": Part.from_file("paper_t"),
    "bracket": Part([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)]),
    "triangle": Part([(0, 0), (3, 0), (1, 1.5)]),
    "almost a square": Part([(0, 0), (1, 0), (1.02, 1), (0, 1)]),
    "square": Part([(0, 0), (1, 0), (1, 1), (0, 1)]),
    "plate with a hole": Part(shapely.box(0, 0, 3, 2) - shapely.box(0.4, 0.3, 1.2, 1.5)),
    "two pieces": Part(shapely.union_all([shapely.box(0, 0, 1, 1), shapely.box(3, 0.2, 4, 1.9)])),
    "blob of 200 corners": gon(200, 0.2),
}


def quadrature_load(part, pose):
    """Return the load of a unit push towards the origin, by Gauss's rule on the edges."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    ends = part.edges.reshape(-1, 2, 2) @ np.array([[c, s], [-s, c]]) + pose[:2]
    a, b = ends[:, 0], ends[:, 1]
    x = a[:, None] + 0.5 * (NODES[:, None] + 1.0) * (b - a)[:, None]
    weight = 0.5 * WEIGHTS * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])[:, None]
    half = 0.5 * weight[:, :, None] * -x / np.linalg.norm(x, axis=2, keepdims=True)
    force = half.sum(axis=(0, 1))
    return np.array([*force, force[0] * pose[1] - force[1] * pose[0]])


def loads():
    print("| part | one call, us | of many, us | quadrature, us | ratio | median difference |")
    print("|---|---|---|---|---|---|")
    rng, field = np.random.default_rng(0), RadialField(1.0)
    for name in ("paper T", "bracket", "blob of 200 corners"):
        part = PARTS[name]
        R = part.circumradius
        poses = rng.uniform(-2.0, 2.0, (LOADS, 3)) * [R, R, 2.0]
        field.load(part, poses)
        one, exact = timed(lambda: np.array([field.load(part, q) for q in poses]))
        many, _ = timed(lambda: field.load(part, poses))
        slow, twin = timed(lambda: np.array([quadrature_load(part, q) for q in poses]))
        off = np.abs(exact - twin) / (part.area * np.array([1.0, 1.0, R]))
        one, many, slow = (1e6 * t / LOADS for t in (one, many, slow))
        print(
            f"| {name} | {one:.1f} | {many:.2f} | {slow:.0f} | {slow / one:.0f} "
            f"| {np.median(off.max(axis=1)):.0e} |"
        )


def rest():
    print("\n| part | field | stable | proven | ms | many starts, ms | they find |")
    print("|---|---|---|---|---|---|---|")
    for name, part in PARTS.items():
        R = part.circumradius
        squeezed = RadialField(1.0, (R, 0.5 * R)) + DensityField.squeeze(0.3, 1.0)
        for kind, field in (("feeder 0.1", feeder_field(1.0, 0.1)), ("with squeeze", squeezed)):
            equilibria(part, field)
            fast, found = timed(lambda: equilibria(part, field), 3)
            slow, (poses, _) = timed(
                lambda: stationary_poses(part, field, field.centers, field.flat), 1
            )
            print(
                f"| {name} | {kind} | {len(found.stable)} | {'yes' if found.complete else 'no'} "
                f"| {1e3 * fast:.0f} | {1e3 * slow:.0f} | {len(poses)} of {len(found.poses)} |"
            )


def feeder():
    print("\n| part | pivot off the centroid, circumradii | one stable pose up to | then | ms |")
    print("|---|---|---|---|---|")
    for name, part in PARTS.items():
        time, found = timed(lambda: feeder_range(part), 1)
        off = np.hypot(*found.pivot) / part.circumradius
        then = found.counts.get(found.limit, found.reason)
        print(f"| {name} | {off:.1e} | {found.ratio:.4f} | {then} | {1e3 * time:.0f} |")
    square = [len(equilibria(PARTS["square"], feeder_field(1.0, r)).stable) for r in (0.1, 0.5)]
    print(f"\nThe square has {square[0]} and {square[1]} stable poses at ratios 0.1 and 0.5.")


if __name__ == "__main__":
    loads()
    rest()
    feeder()
