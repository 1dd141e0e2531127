"""Plates that slide, stick and slip on supports: limitsurf beside integrators and simulators.

Usage: python benchmarks/bench_stick_slip.py

A square plate of 0.1 m and 0.2 kg on N supports that share its weight, mu = 0.3. SLIDE TO REST:
from (0.3, 0.1) m/s and 4 rad/s. DRIVEN: 20 cycles of a sinusoidal load, in each of which it slides
and rests. STICK: how far it creeps in 10 s under a load just below the limit. Each method runs at
the cheapest setting tried with which the final pose is right to 1e-4 of the distance travelled
(angles times the radius of gyration), against limitsurf at tolerance 1e-11; its distance from
LSODA at 1e-11 with eps = 1e-8, which creeps a little, is printed. Times are medians, in one run.

SciPy's LSODA integrates the regularised law ``m u / sqrt(u^2 + eps^2)`` with a compiled right-hand
side. Drake is run at two time steps and extrapolated to step zero. The simulators solve more: three
dimensions, collisions, loads that nobody gave them.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import logging
import math
import time
import warnings

import numpy as np
from numba import njit
from scipy.integrate import odeint, solve_ivp
from timing import timed

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.geometry.part import Part
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.load_table import LoadTable

MU, G, GOAL, COUNTS = 0.3, 9.81, 1e-4, (3, 10, 100)
START, SLIDING = (0.3, 0.1, 4.0), 0.2
PLATE = Part([(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)], 20.0)
WEIGHT = PLATE.mass * G
RHO = math.sqrt(PLATE.inertia / PLATE.mass)
CYCLES, RATE = 20, 2 * math.pi * 5.0
DRIVEN = CYCLES * 2 * math.pi / RATE


def supports(n):
    """Return n supports with equal loads, their centroid under the centre of mass."""
    k = np.arange(n)
    r = 0.05 * np.sqrt((k + 0.5) / n)
    place = np.column_stack([r * np.cos(2.4 * k), r * np.sin(2.4 * k)])
    if n == 3:
        angle = np.pi / 2 + 2 * np.pi * k / 3
        place = 0.04 * np.column_stack([np.cos(angle), np.sin(angle)])
    return ContactSet(place - place.mean(axis=0), MU * WEIGHT / n)


@njit
def load(t):
    """Return the driving load: a push that overcomes friction for a part of each cycle."""
    s = math.sin(RATE * t)
    f = MU * WEIGHT
    return f * (0.5 + 0.8 * s), 0.3 * f * s, 0.01 * f * s


@njit(fastmath=True, error_model="numpy")
def rates(t, y, x0, y0, m, mass, inertia, eps, driven):
    """Return the rates of pose and twist under the regularised law."""
    cos, sin = math.cos(y[2]), math.sin(y[2])
    fx = fy = moment = 0.0
    for i in range(len(m)):
        rx, ry = cos * x0[i] - sin * y0[i], sin * x0[i] + cos * y0[i]
        ux, uy = y[3] - y[5] * ry, y[4] + y[5] * rx
        k = m[i] / math.sqrt(ux * ux + uy * uy + eps * eps)
        fx -= k * ux
        fy -= k * uy
        moment -= k * (rx * uy - ry * ux)
    if driven:
        a, b, c = load(t)
        fx, fy, moment = fx + a, fy + b, moment + c
    out = np.empty(6)
    out[:3] = y[3:]
    out[3], out[4], out[5] = fx / mass, fy / mass, moment / inertia
    return out


def error(pose, reference):
    """Return the error of a pose over the distance travelled."""
    far = max(np.hypot(*(pose - reference)[:2]), RHO * abs(pose - reference)[2])
    return far / np.hypot(*reference[:2])


def cheapest(name, calls, reference):
    """Return name, setting, median time and error of the fastest call that is right enough."""
    best = (name, "none", math.inf, math.inf)
    for setting, call in calls:
        start = time.perf_counter()
        wrong = error(call(), reference)
        if wrong <= GOAL and time.perf_counter() - start < 3.0 * best[2]:
            seconds, pose = timed(call, 15)
            if seconds < best[2]:
                best = (name, setting, seconds, error(pose, reference))
    return best


def lsoda_arguments(contacts, eps, driven):
    """Return what `rates` takes after time and state."""
    x, y = contacts.position.T.copy()
    return x, y, contacts.radius.copy(), PLATE.mass, PLATE.inertia, eps, driven


def by_odeint(contacts, driven, eps, rtol, atol):
    """Return the final pose by the Fortran LSODA."""
    start, end = (np.zeros(3), DRIVEN) if driven else (START, SLIDING)
    y = odeint(
        rates,
        [0.0, 0.0, 0.0, *start],
        [0.0, end],
        lsoda_arguments(contacts, eps, driven),
        tfirst=True,
        rtol=rtol,
        atol=atol,
        mxstep=10_000_000,
    )
    return y[-1, :3]


def by_solve_ivp(contacts, driven, eps, rtol, atol):
    """Return the final pose by the LSODA of solve_ivp."""
    start, end = (np.zeros(3), DRIVEN) if driven else (START, SLIDING)
    arguments = lsoda_arguments(contacts, eps, driven)
    found = solve_ivp(
        rates,
        (0.0, end),
        [0.0, 0.0, 0.0, *start],
        "LSODA",
        t_eval=[end],
        args=arguments,
        rtol=rtol,
        atol=atol,
    )
    return found.y[:3, -1] if found.success else np.full(3, np.nan)


def by_events(contacts, driven, tolerance):
    """Return the final pose by limitsurf, the sampling of the load included."""
    start, end = (np.zeros(3), DRIVEN) if driven else (START, SLIDING)
    drive = (lambda t: load(t)) if driven else None
    path = feet_motion(
        PLATE, contacts, duration=end, twist=start, load=drive, tolerance=tolerance, frames=1
    )
    return path.final_pose


def by_drake(contacts, approximation, step):
    """Return the final pose by two runs of a plate that slides in three dimensions, and the time.

    Its centre of mass is at the height of the ground, so that the loads of the supports stay equal.
    """
    import pydrake.all as drake

    def run(dt):
        builder = drake.DiagramBuilder()
        config = drake.MultibodyPlantConfig(
            time_step=dt, discrete_contact_approximation=approximation
        )
        plant, _ = drake.AddMultibodyPlant(config, builder)
        gyration = PLATE.inertia / PLATE.mass
        inertia = drake.UnitInertia(gyration / 2, gyration / 2, gyration)
        body = plant.AddRigidBody("plate", drake.SpatialInertia(PLATE.mass, [0, 0, 0], inertia))
        stiffness, radius = 1e5, 1e-3
        surface = drake.ProximityProperties()
        drake.AddContactMaterial(0.0, 2 * stiffness, drake.CoulombFriction(MU, MU), surface)
        for i, (x, y) in enumerate(contacts.position):
            at = drake.RigidTransform([x, y, radius])
            plant.RegisterCollisionGeometry(body, at, drake.Sphere(radius), f"{i}", surface)
        plant.RegisterCollisionGeometry(
            plant.world_body(), drake.RigidTransform(), drake.HalfSpace(), "ground", surface
        )
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        plant.Finalize()
        simulator = drake.Simulator(builder.Build())
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        height = -WEIGHT / (len(contacts) * stiffness)
        plant.SetFreeBodyPose(context, body, drake.RigidTransform([0, 0, height]))
        velocity = drake.SpatialVelocity([0, 0, START[2]], [*START[:2], 0])
        plant.SetFreeBodySpatialVelocity(context, body, velocity)
        simulator.Initialize()
        begin = time.perf_counter()
        simulator.AdvanceTo(SLIDING)
        seconds = time.perf_counter() - begin
        pose = plant.EvalBodyPoseInWorld(context, body)
        turn = pose.rotation().matrix()
        at = pose.translation()
        return np.array([at[0], at[1], math.atan2(turn[1, 0], turn[0, 0])]), seconds

    (coarse, one), (fine, two) = run(step), run(0.5 * step)
    return 2.0 * fine - coarse, one + two


def drake_row(contacts, reference):
    """Return the row of Drake: time to advance only, without building the model."""
    best = ("Drake, extrapolated", "none", math.inf, math.inf)
    for approximation in ("lagged", "similar", "sap"):
        for step in (0.02, 0.01, 0.004, 0.002, 0.001):
            runs = [by_drake(contacts, approximation, step) for _ in range(3)]
            wrong, seconds = error(runs[0][0], reference), np.median([s for _, s in runs])
            if wrong <= GOAL and seconds < best[2]:
                best = (best[0], f"{approximation}, {step:g} s and half", seconds, wrong)
    return best


def compare(contacts, driven):
    """Return rows of one problem, and how far the two references are apart."""
    reference = by_events(contacts, driven, 1e-11)
    apart = error(by_odeint(contacts, driven, 1e-8, 1e-11, 1e-13), reference)
    tolerances = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
    ours = [(f"{tol:g}", lambda tol=tol: by_events(contacts, driven, tol)) for tol in tolerances]
    rows = [cheapest("limitsurf, events", ours, reference)]
    for name, method in (("odeint", by_odeint), ("solve_ivp LSODA", by_solve_ivp)):
        grid = [
            (f"eps {eps:g}, rtol {rtol:g}", eps, rtol, share * rtol)
            for eps in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
            for rtol in (1e-3, 1e-4, 1e-5, 1e-6)
            for share in (1e-2, 1e-3)
        ]
        calls = [(s, lambda a=a: method(contacts, driven, *a)) for s, *a in grid]
        rows.append(cheapest(name, calls, reference))
    if not driven:
        try:
            logging.getLogger("drake").setLevel(logging.ERROR)
            rows.append(drake_row(contacts, reference))
        except ImportError:
            print("pydrake is not installed\n")
    return rows, apart


def print_comparison(driven):
    """Print the table of one problem."""
    print("\n## " + (f"Driven, {CYCLES} cycles\n" if driven else "Slide to rest\n"))
    print("| N | method | setting | time, us | error | times ours | references apart |")
    print("|---|---|---|---|---|---|---|")
    for n in COUNTS:
        rows, apart = compare(supports(n), driven)
        for name, setting, seconds, wrong in rows:
            ratio = seconds / rows[0][2]
            print(
                f"| {n} | {name} | {setting} | {1e6 * seconds:.0f} | {wrong:.0e} | {ratio:.1f} "
                f"| {apart:.0e} |"
            )
    if driven:
        table, _ = timed(lambda: LoadTable(lambda t: load(t), DRIVEN))
        print(
            f"\nof ours, sampling the load, which several motions can share: {1e6 * table:.0f} us"
        )


def mujoco_creep(contacts, share):
    """Return how far MuJoCo's plate moves in 10 s under a share of the limit, default settings."""
    import mujoco

    feet = "".join(
        f'<geom type="sphere" size="0.001" pos="{x} {y} 0.001" friction="{MU} 0 0" condim="3"/>'
        for x, y in contacts.position
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 0 -{G}"/><worldbody>'
        f'<geom type="plane" size="1 1 1" friction="{MU} 0 0" condim="3"/>'
        f'<body><freejoint/><inertial mass="{PLATE.mass}" pos="0 0 0" diaginertia="'
        f'{PLATE.inertia / 2} {PLATE.inertia / 2} {PLATE.inertia}"/>{feet}</body>'
        "</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    for _ in range(int(1.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    before = data.qpos[:2].copy()
    data.xfrc_applied[1, 0] = share * MU * WEIGHT
    for _ in range(int(10.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return float(np.hypot(*(data.qpos[:2] - before)))


def pymunk_creep(contacts, share):
    """Return the same for pymunk: a top view, friction by a pivot joint of limited force a foot."""
    import pymunk

    space = pymunk.Space()
    space.gravity = (0, 0)
    body = pymunk.Body(PLATE.mass, PLATE.inertia)
    space.add(body)
    for (x, y), m in zip(contacts.position.tolist(), contacts.radius.tolist(), strict=True):
        joint = pymunk.PivotJoint(space.static_body, body, (x, y), (x, y))
        joint.max_force, joint.max_bias = m, 0.0
        space.add(joint)
    for _ in range(600):
        body.apply_force_at_world_point((share * MU * WEIGHT, 0.0), body.position)
        space.step(1.0 / 60.0)
    return float(np.hypot(*body.position))


def our_creep(contacts, share, method):
    """Return the same for limitsurf."""
    push = np.array([share * MU * WEIGHT, 0.0, 0.0])
    path = feet_motion(PLATE, contacts, duration=10.0, load=push, method=method, frames=1)
    return float(np.hypot(*path.final_pose[:2]))


def print_creep():
    """Print how far plates move under loads near the limit."""
    print("\n## Stick: distance in 10 s, m\n")
    print("| N | load / limit | ours, events | ours, steps | MuJoCo | pymunk |")
    print("|---|---|---|---|---|---|")
    for n in COUNTS:
        contacts = supports(n)
        for share in (0.5, 0.99, 1.0 - 1e-4):
            cells = [our_creep(contacts, share, method) for method in ("events", "steps")]
            for other in (mujoco_creep, pymunk_creep):
                try:
                    cells.append(other(contacts, share))
                except ImportError:
                    cells.append(math.nan)
            print(f"| {n} | {share:g} | " + " | ".join(f"{c:.1e}" for c in cells) + " |")


def main():
    """Print the tables."""
    warnings.filterwarnings("ignore", message=".*[Rr]epeated")  # LSODA, at settings that fail
    begin = time.perf_counter()
    by_events(supports(3), False, 1e-4)
    print(f"first call: {time.perf_counter() - begin:.1f} s, compiled or loaded from the cache")
    by_events(supports(3), True, 1e-4)
    rates(0.0, np.ones(6), *lsoda_arguments(supports(3), 1e-3, True))
    print_comparison(driven=False)
    print_comparison(driven=True)
    print_creep()


if __name__ == "__main__":
    main()
