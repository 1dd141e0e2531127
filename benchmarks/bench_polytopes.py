"""Closest points of polytopes in space: two kernels beside the solvers a user would pick.

Usage: python benchmarks/bench_polytopes.py

One thread, 200 points from just outside to four sizes away, half of them close to the surface of
flat bodies. Kernels take all points in one call;
the others take one point per call, set up beforehand as far as their interface allows. Errors are
against all faces in long doubles, relative to the larger of |point| and the size of the body.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time
import warnings
from importlib import import_module
from statistics import median

import clarabel
import cvxpy as cp
import numpy as np
from scipy import sparse
from scipy.spatial import ConvexHull

from limitsurf.kernels.closest_on_vertices import closest_on_vertices
from limitsurf.kernels.dual_active_set import closest_on_facets
from limitsurf.kernels.hill_climbing import direction_cells, vertex_graph
from limitsurf.kernels.surface_walk import triangle_surface
from limitsurf.sets.h_polytope import HPolytope
from limitsurf.sets.hulls import convex_hull
from limitsurf.sets.v_polytope import VPolytope

BODIES = ((20, 1.0), (200, 1.0), (2000, 1.0), (20, 1e-6), (200, 1e-6), (2000, 1e-6))
N_POINTS = 200
TIGHT = {"tol_gap_abs": 1e-12, "tol_gap_rel": 1e-12, "tol_feas": 1e-12}


class Body:
    """Random vertices on an ellipsoid, its hull, and points around it."""

    def __init__(self, facets, flatness):
        rng = np.random.default_rng(1)
        V = rng.normal(size=(facets // 2 + 2, 3))
        self.V = V / np.linalg.norm(V, axis=1)[:, None] * (1.0, 0.7, 0.4 * flatness)
        hull = ConvexHull(self.V)
        self.triangles = hull.simplices
        self.A = np.ascontiguousarray(hull.equations[:, :3])
        self.b = np.max(self.V @ self.A.T, axis=0)
        d = rng.normal(size=(N_POINTS, 3)) * (1.0, 1.0, flatness)
        boundary = 1 / np.max(d @ self.A.T / self.b, axis=1)
        factor = np.exp(rng.uniform(np.log(1.001), np.log(4), N_POINTS))
        self.points = d * (boundary * factor)[:, None]
        if flatness < 1.0:  # half of them close to the body, half anywhere
            self.points[::2] = rng.normal(size=(N_POINTS // 2, 3)) * (2.0, 2.0, 1.0)
        self.exact = np.array(
            [closest_by_force(p, V=self.V, t=hull.simplices) for p in self.points]
        )

    def error(self, x):
        """Return the largest relative error of the first len(x) answers, and what has none."""
        n = len(x)
        size = np.linalg.norm(self.V, axis=1).max()
        scale = np.maximum(np.linalg.norm(self.points[:n], axis=1), size)
        errors = np.linalg.norm(x - self.exact[:n], axis=1) / scale
        failed = np.isnan(errors).sum()
        return f"{np.nanmax(errors):.0e}" + (f", {failed} of {n} failed" if failed else "")


def closest_by_force(p, V, t):
    """Return the nearest of the closest points of all edges and faces, in long doubles."""
    p, corners = p.astype(np.longdouble), V.astype(np.longdouble)[t]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    candidates = []
    for u, v in ((a, b), (b, c), (c, a)):
        along = ((p - u) * (v - u)).sum(axis=1) / ((v - u) ** 2).sum(axis=1)
        candidates.append(u + np.clip(along, 0, 1)[:, None] * (v - u))
    normal = np.cross(b - a, c - a)
    lift = ((p - a) * normal).sum(axis=1) / (normal**2).sum(axis=1)
    x = p - lift[:, None] * normal
    inside = np.ones(len(a), dtype=bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(v - u, x - u) * normal).sum(axis=1) >= 0
    candidates.append(x[inside])
    every = np.concatenate(candidates)
    return every[((every - p) ** 2).sum(axis=1).argmin()].astype(float)


def facets_kernel(body):
    return lambda points: closest_on_facets(points, body.A, body.b)[0]


def vertices_kernel(body):
    outwards = convex_hull(body.V).triangles
    graph = vertex_graph(len(body.V), outwards)
    cells, surface = direction_cells(body.V, graph), triangle_surface(outwards, graph)
    return lambda points: closest_on_vertices(points, body.V, graph, cells, surface)[0]


def one_by_one(call):
    return lambda points: np.array([call(p) for p in points])


def daqp_peer(body):
    daqp = import_module("daqp")
    model = daqp.Model()
    m = len(body.b)
    lower, sense = np.full(m, -1e30), np.zeros(m, dtype=np.int32)
    model.setup(np.eye(3), -body.points[0], body.A, body.b, lower, sense)
    model.settings = {"primal_tol": 1e-12}

    def call(p):
        model.update(f=-p)
        return np.array(model.solve()[0])

    return one_by_one(call)


def coal_peer(body):
    coal = import_module("coal")
    corners = coal.StdVec_Vec3s()
    for v in body.V:
        corners.append(v.copy())
    hull, point = coal.Convex.convexHull(corners, True, "Qt"), coal.Sphere(0.0)
    here, axes = coal.Transform3s.Identity(), np.eye(3)
    request, result = coal.DistanceRequest(True, 0.0, 0.0), coal.DistanceResult()
    request.gjk_tolerance, request.gjk_max_iterations = 1e-12, 1000

    def call(p):
        result.clear()
        coal.distance(hull, here, point, coal.Transform3s(axes, p), request, result)
        return np.array(result.getNearestPoint1()).ravel()

    return one_by_one(call)


def clarabel_peer(body):
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.presolve_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    P, A = sparse.csc_matrix(np.eye(3)), sparse.csc_matrix(body.A)
    cones = [clarabel.NonnegativeConeT(len(body.b))]

    def call(p):
        return np.array(clarabel.DefaultSolver(P, -p, A, body.b, cones, settings).solve().x)

    return one_by_one(call)


def cvxpy_peer(body):
    x, p = cp.Variable(3), cp.Parameter(3)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(x - p)), [body.A @ x <= body.b])

    def call(value):
        p.value = value
        try:
            problem.solve(solver=cp.CLARABEL, **TIGHT)
        except cp.error.SolverError:
            return np.full(3, np.nan)
        return x.value

    return one_by_one(call)


def facets_set(body):
    polytope = HPolytope(body.A, body.b)
    return lambda points: polytope.project(points).point


def vertices_set(body):
    polytope = VPolytope(body.V)
    return lambda points: polytope.project(points).point


METHODS = {  # name: how to set it up, points per run, runs
    "HPolytope": (facets_set, N_POINTS, 15),
    "VPolytope": (vertices_set, N_POINTS, 15),
    "facets kernel": (facets_kernel, N_POINTS, 15),
    "vertices kernel": (vertices_kernel, N_POINTS, 15),
    "daqp": (daqp_peer, N_POINTS, 5),
    "coal GJK": (coal_peer, N_POINTS, 5),
    "Clarabel": (clarabel_peer, 20, 3),
    "cvxpy, parametrised": (cvxpy_peer, 10, 3),
}


OURS = ("HPolytope", "VPolytope", "facets kernel", "vertices kernel")


def measure(body, name):
    """Return the median time for one point [s] and the error."""
    set_up, n, runs = METHODS[name]
    solve = set_up(body)
    points = body.points[:n]
    x = solve(points)
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        solve(points)
        times.append((time.perf_counter() - start) / n)
    return median(times), body.error(x)


def available():
    """Return the methods that are installed; note the others."""
    names = []
    for name in METHODS:
        try:
            METHODS[name][0](Body(20, 1.0))
            names.append(name)
        except ImportError as missing:
            print(f"{name} left out: {missing}")
    return names


def main():
    """Print the first calls, then one table of times and errors and one of ratios."""
    warnings.filterwarnings("ignore", message="Solution may be inaccurate")
    body = Body(20, 1.0)
    for name in OURS:
        start = time.perf_counter()
        METHODS[name][0](body)(body.points)
        print(f"first call, {name} (compiled or read from the cache): ", end="")
        print(f"{time.perf_counter() - start:.2f} s")
    names = available()
    peers = [name for name in names if name not in OURS]
    head = [*names, *(f"{name} / ours" for name in peers)]
    print("\nmicroseconds for one point (relative error)\n")
    print("| facets | flatness | " + " | ".join(head) + " |")
    print("|" + "---|" * (len(head) + 2))
    for facets, flatness in BODIES:
        body = Body(facets, flatness)
        found = {name: measure(body, name) for name in names}
        best = min(found["HPolytope"][0], found["VPolytope"][0])
        cells = [f"{1e6 * t:.3g} ({error})" for t, error in found.values()]
        cells += [f"{found[name][0] / best:.1f}" for name in peers]
        print(f"| {facets} | {flatness:g} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
