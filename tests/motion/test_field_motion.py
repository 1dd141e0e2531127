"""Motion in force densities: closed forms, energy, rest, friction, and the limit of arrays."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.actuators.density_field import DensityField, push_density
from limitsurf.contacts.friction_load import friction_load
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.field_motion import field_motion
from limitsurf.motion.load_table import LoadTable
from limitsurf.motion.simulate import simulate
from limitsurf.motion.trajectory import EventKind, Outcome
from limitsurf.planning.turn_function import turn_function

CARD = Part([(0, 0), (2, 0), (2, 1), (0, 1)], 1.5)
NOTHING = DensityField.uniform(0.0, 0.0)
SQUEEZE = DensityField.squeeze(0.2, 1.0)
METHODS = ("events", "steps")
#: Every combination of mass, drag and friction that comes to rest.
KINDS = {
    "quasi-static": {"mode": "quasi-static", "drag": (2.0, 2.0, 0.8)},
    "damped": {"drag": (2.0, 2.0, 0.8)},
    "rubbing": {"friction": UniformFriction(CARD, 0.2)},
    "rubbing off its centre": {
        "friction": UniformFriction([(0.2, -0.3), (0.9, -0.3), (0.9, 0.4)], 0.9)
    },
    "rubbing and damped": {"friction": UniformFriction(CARD, 0.2), "drag": (0.5, 0.5, 0.2)},
    "quasi-static and rubbing": {
        "mode": "quasi-static",
        "drag": (2.0, 2.0, 0.8),
        "friction": UniformFriction(CARD, 0.2),
    },
}


def star(rng, n):
    """Return a random part that can be seen as a whole from the origin."""
    angle = 2 * np.pi / n * (np.arange(n) + rng.uniform(0.0, 0.8, n))
    radius = rng.uniform(0.4, 2.0, n)
    return Part(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), 1.0)


def gon(n, radius=1.0):
    """Return a regular polygon of areal density 1."""
    t = 2 * np.pi * np.arange(n) / n
    return Part(radius * np.column_stack([np.cos(t), np.sin(t)]), 1.0)


@pytest.mark.parametrize("method", METHODS)
def test_a_uniform_density_moves_a_part_at_load_over_drag(method):
    field, drag = DensityField.uniform(0.5, 3.0), (4.0, 4.0, 1.0)
    path = field_motion(
        CARD, field, (1.0, 2.0, 0.3), 2.0, mode="quasi-static", drag=drag, method=method
    )
    speed = 3.0 * CARD.area / 4.0 * np.array([np.cos(0.5), np.sin(0.5), 0.0])
    assert path.outcome is Outcome.TIME_LIMIT
    assert path.duration == pytest.approx(2.0)
    assert path.twists == pytest.approx(np.tile(speed, (len(path.times), 1)), abs=1e-12)
    assert path.final_pose == pytest.approx([1.0, 2.0, 0.3] + 2.0 * speed, abs=1e-9)


def test_a_mass_approaches_its_terminal_speed_exponentially():
    field, d = DensityField.uniform(0.0, 3.0), 4.0
    path = field_motion(CARD, field, duration=2.0, drag=(d, d, d))
    rate, terminal = d / CARD.mass, 3.0 * CARD.area / d
    t = path.times
    assert path.twists[:, 0] == pytest.approx(terminal * (1 - np.exp(-rate * t)), abs=1e-7)
    x = terminal * (t - (1 - np.exp(-rate * t)) / rate)
    assert path.poses[:, 0] == pytest.approx(x, abs=1e-7)


def test_a_linear_density_makes_an_oscillator():
    """A part swings about the centre with sqrt(k / areal density), whatever its shape."""
    path = field_motion(CARD, DensityField.linear(6.0), (1.0, 0.0, 0.4), 10.0, tolerance=1e-11)
    assert path.poses[:, 0] == pytest.approx(np.cos(2.0 * path.times), abs=1e-7)
    assert np.ptp(path.poses[:, 2]) < 1e-9
    energy = path.energy.kinetic + DensityField.linear(6.0).potential(CARD, path.poses)
    assert energy == pytest.approx(np.full(len(energy), energy[0]), rel=1e-8)
    assert path.outcome is Outcome.TIME_LIMIT


@pytest.mark.parametrize("method", METHODS)
def test_a_sliding_block_stops_where_coulomb_says(method):
    """Translation: v / (mu g) and v^2 / (2 mu g), where mu g is traction over areal density."""
    errors = []
    for step in (2e-3, 1e-3):
        path = field_motion(
            CARD,
            NOTHING,
            duration=10.0,
            twist=(0.6, 0.8, 0.0),
            friction=UniformFriction(CARD, 0.75),
            method=method,
            time_step=step,
        )
        assert path.outcome is Outcome.REST
        assert not path.twists[-1].any()
        assert [e.kind for e in path.events] == [EventKind.REST]
        errors.append(
            [path.duration - 2.0, np.hypot(*path.final_pose[:2]) - 1.0, path.final_pose[2]]
        )
    if method == "events":
        assert np.abs(errors).max() < 1e-6
    else:
        assert np.abs(errors).max() < 5e-3
        assert errors[0][1] / errors[1][1] == pytest.approx(2.0, rel=0.2)


def test_a_spinning_disk_stops_after_its_torque():
    disk = gon(400)
    path = field_motion(
        disk, NOTHING, duration=10.0, twist=(0, 0, 3.0), friction=UniformFriction(disk, 2.0)
    )
    torque = 2.0 * 2 * np.pi / 3
    assert path.duration == pytest.approx(3.0 * disk.inertia / torque, rel=1e-4)
    assert np.abs(path.poses[:, :2]).max() < 1e-9


@pytest.mark.parametrize("twist", [(1.0, 0.0, 0.2), (1.0, 0.0, 3.0), (0.3, 0.0, 1.0)])
def test_sliding_and_spinning_of_a_disk_end_together(twist):
    """v / (R omega) -> 0.653 (Z. Farkas et al., Phys. Rev. Lett. 90, 248302, 2003)."""
    disk = gon(400)
    path = field_motion(disk, NOTHING, twist=twist, friction=UniformFriction(disk, 1.0))
    assert path.outcome is Outcome.REST
    vx, vy, w = path.twists[-2]
    assert np.hypot(vx, vy) < 1e-4
    assert np.hypot(vx, vy) / abs(w) == pytest.approx(0.653, abs=0.0015)


def test_that_ratio_is_kept():
    disk = gon(400)
    path = field_motion(disk, NOTHING, twist=(0.653, 0, 1), friction=UniformFriction(disk, 1.0))
    ratios = path.twists[:-1, 0] / path.twists[:-1, 2]
    assert np.abs(ratios - 0.653).max() < 1e-4


@pytest.mark.parametrize("kind", KINDS)
def test_steps_approach_the_smooth_motion_at_first_order(kind):
    def position(method, step=None):
        path = field_motion(
            CARD, SQUEEZE, (0.0, 0.2, 0.4), 1.0, method=method, time_step=step, **KINDS[kind]
        )
        return PchipInterpolator(path.times, path.poses)(0.9)

    exact = position("events")
    errors = [np.abs(position("steps", step) - exact).max() for step in (4e-3, 2e-3, 1e-3)]
    assert errors[-1] < 2e-3
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert order == pytest.approx([1.0, 1.0], abs=0.25)


def lost(field, path):
    """Return how much less the potential is at the end."""
    before, after = field.potential(CARD, path.poses[[0, -1]])
    return before - after


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tolerance", [1e-7, 1e-10])
def test_energy_adds_up_to_the_tolerance(kind, tolerance):
    """Errors of the sums are some ten times those allowed in a step, at any tolerance."""
    path = field_motion(CARD, SQUEEZE, (0.0, 0.2, 0.4), 40.0, tolerance=tolerance, **KINDS[kind])
    assert path.outcome is Outcome.REST
    allowed = 50.0 * tolerance * CARD.area * CARD.circumradius
    assert np.abs(path.energy.residual).max() < allowed
    assert path.energy.work[-1] == pytest.approx(lost(SQUEEZE, path), abs=allowed)


@pytest.mark.parametrize("kind", KINDS)
def test_energy_of_steps_adds_up_to_rounding(kind):
    path = field_motion(CARD, SQUEEZE, (0.0, 0.2, 0.4), 40.0, method="steps", **KINDS[kind])
    assert path.outcome is Outcome.REST
    size = path.energy.work[-1]
    assert np.abs(path.energy.residual).max() < 1e-12 * size
    assert size == pytest.approx(lost(SQUEEZE, path), rel=0.01)
    for loss in (path.energy.friction, path.energy.drag, path.energy.numerical):
        assert np.diff(loss).min() >= -1e-12 * size


def test_every_step_is_a_closest_point():
    """Frames of every step, beside `friction_load` with the set turned to the part's axes."""
    S, dt, drag = KINDS["rubbing and damped"]["friction"], 2e-3, np.array([0.5, 0.5, 0.2])
    path = field_motion(
        CARD,
        SQUEEZE,
        (0.0, 0.2, 0.4),
        0.2,
        twist=(0.3, -0.1, 0.5),
        friction=S,
        drag=drag,
        method="steps",
        time_step=dt,
        frames=100,
    )
    mass = np.array([CARD.mass, CARD.mass, CARD.inertia])
    assert path.times == pytest.approx(dt * np.arange(101), abs=1e-15)
    for k in range(0, 100, 7):
        c, s = np.cos(path.poses[k, 2]), np.sin(path.poses[k, 2])
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
        pull = SQUEEZE.load(CARD, path.poses[k]) + mass * path.twists[k] / dt
        found = friction_load(S, pull @ turn, 1.0 / (mass / dt + drag))
        assert path.twists[k + 1] == pytest.approx(turn @ found.twist, abs=1e-9)
        contacts = SQUEEZE.load(CARD, path.poses[k]) + turn @ found.friction
        assert path.loads[k] == pytest.approx(contacts, abs=1e-9)
    assert path.worst_error < 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_a_part_that_friction_holds_stays(method):
    S = UniformFriction(CARD, 1.01 * np.sqrt(0.5))
    pull = np.array([1.0, 1.0, 0.0])
    for more in ({}, {"mode": "quasi-static", "drag": (1.0, 1.0, 1.0)}):
        path = field_motion(CARD, NOTHING, load=pull, friction=S, method=method, **more)
        assert path.outcome is Outcome.REST
        assert path.duration == 0.0
        assert np.array_equal(path.final_pose, np.zeros(3))
        assert path.loads[0] == pytest.approx(-pull, abs=1e-9)
        moving = field_motion(
            CARD, NOTHING, duration=1.0, load=1.1 * pull, friction=S, method=method, **more
        )
        assert moving.outcome is Outcome.TIME_LIMIT
        assert moving.final_pose[0] > 1e-3


def test_a_mass_that_turns_back_starts_again():
    """Pulled to the middle with little friction it swings; each turn is a stop and a start.

    Translation in a linear density: half a period each, the swing smaller by 2 mu N / k.
    """
    field, S = DensityField.linear(6.0), UniformFriction(CARD, 0.5)
    path = field_motion(CARD, field, (1.0, 0.0, 0.0), 20.0, friction=S)
    starts = [e.time for e in path.events if e.kind is EventKind.START]
    assert starts == pytest.approx(np.pi / 2 * np.arange(6), abs=1e-6)
    assert path.outcome is Outcome.REST
    assert path.duration == pytest.approx(3 * np.pi, abs=1e-6)
    assert path.final_pose == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    at = [path.poses[np.searchsorted(path.times, t), 0] for t in starts]
    swings = (-1.0) ** np.arange(6) * (1.0 - np.arange(6) / 6.0)
    assert at == pytest.approx(swings, abs=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_without_loads_nothing_moves_or_keeps_moving(method):
    path = field_motion(CARD, NOTHING, (1.0, 2.0, 3.0), method=method)
    assert path.outcome is Outcome.REST
    assert np.array_equal(path.final_pose, [1.0, 2.0, 3.0])
    coasting = field_motion(CARD, NOTHING, duration=2.0, twist=(1.0, 0.0, 0.5), method=method)
    assert coasting.outcome is Outcome.TIME_LIMIT
    assert coasting.final_pose == pytest.approx([2.0, 0.0, 1.0], abs=1e-9)


@pytest.mark.parametrize("mode", ["inertial", "quasi-static"])
def test_a_growing_load_breaks_a_part_loose_when_it_exceeds_friction(mode):
    path = field_motion(
        CARD,
        NOTHING,
        duration=2.0,
        mode=mode,
        drag=(1.0, 1.0, 1.0),
        friction=UniformFriction(CARD, 0.5),
        load=lambda t: (t, 0.0, 0.0),
        method="steps",
        time_step=1e-3,
        frames=2000,
    )
    moves = path.twists[:, 0] > 0.0
    assert path.outcome is Outcome.TIME_LIMIT
    assert path.times[np.argmax(moves)] == pytest.approx(1.0, abs=3e-3)
    assert not path.twists[path.times < 0.995].any()
    if mode == "quasi-static":
        assert path.twists[-1, 0] == pytest.approx(1.0, rel=2e-3)


def test_a_load_that_changes_is_followed_by_events():
    path = field_motion(
        CARD, NOTHING, duration=1.0, mode="quasi-static", drag=(2, 2, 1), load=lambda t: (t, 0, 0)
    )
    assert path.poses[:, 0] == pytest.approx(path.times**2 / 4.0, abs=1e-8)


def rests_of(part, field, starts, **more):
    drag = (part.area, part.area, part.polar_moment)
    return [
        field_motion(part, field, q, 1e4, mode="quasi-static", drag=drag, **more) for q in starts
    ]


def test_a_squeezed_part_descends_its_potential_to_a_stable_orientation(rng):
    line = 0.7
    field = DensityField.squeeze(line, 1.0)
    for n in rng.integers(4, 14, 12):
        part = star(rng, n)
        turn = turn_function(part)
        starts = rng.uniform(-1, 1, (3, 3)) * [part.circumradius, part.circumradius, np.pi]
        for path in rests_of(part, field, starts):
            U = field.potential(part, path.poses)
            assert np.diff(U).max() <= 1e-12 * U[0]
            assert path.outcome is Outcome.REST
            off = np.mod(path.final_pose[2] - line - turn.stable + np.pi / 2, np.pi) - np.pi / 2
            assert np.abs(off).min() < 1e-8
            load = field.load(part, path.final_pose)
            assert np.abs(load).max() < 1e-12 * part.area * part.circumradius


def test_the_reduced_potential_falls_from_the_median_but_not_from_everywhere(rng):
    """U of the median alone may rise while the part is off its median: by a percent or so."""
    field, rises = DensityField.squeeze(0.0, 1.0), []
    for n in rng.integers(4, 14, 12):
        part = star(rng, n)
        turn, angles = turn_function(part), rng.uniform(0.0, 2 * np.pi, 3)
        on_median = [(0.0, -turn.median(phi)[0], phi) for phi in angles]
        anywhere = [(0.0, part.circumradius * rng.uniform(-1, 1), phi) for phi in angles]
        for path in rests_of(part, field, on_median):
            U = turn.potential(path.poses[:, 2])
            assert np.diff(U).max() <= 1e-9 * U[0]
        for path in rests_of(part, field, anywhere):
            U = turn.potential(path.poses[:, 2])
            rises.append(np.diff(U).max() / U[0])
    assert 1e-4 < max(rises) < 0.05


def test_a_skewed_squeeze_shifts_the_rest_and_then_spins_the_part():
    """Rest where ``cos(skew) U' = sin(skew) U``, as long as tan(skew) < max U'/U."""
    square = gon(4)
    turn = turn_function(square)
    for skew in (0.05, 0.11):
        field = DensityField.skewed_squeeze(0.0, skew, 1.0)
        (path,) = rests_of(square, field, [(0.0, 0.1, 0.3)])
        phi = path.final_pose[2]
        assert path.outcome is Outcome.REST
        assert abs(turn.moment(phi) / turn.potential(phi)) == pytest.approx(np.tan(skew), rel=1e-7)
    assert 0.11 < turn.critical_angle < 0.12
    drag = (square.area, square.area, square.polar_moment)
    spins = field_motion(
        square,
        DensityField.skewed_squeeze(0.0, 0.2, 1.0),
        (0.0, 0.1, 0.3),
        500.0,
        mode="quasi-static",
        drag=drag,
    )
    assert spins.outcome is Outcome.TIME_LIMIT
    assert np.abs(np.diff(spins.poses[:, 2])).min() > 0.0
    assert np.ptp(spins.poses[:, 2]) > 4 * np.pi


def test_a_saddle_is_left_alone_by_the_polish():
    """A part that is slow on an unstable equilibrium is at rest there, and is not moved."""
    for method in METHODS:
        path = field_motion(
            CARD,
            DensityField.squeeze(0.0, 1.0),
            (0.0, 0.0, np.pi / 2),
            5.0,
            mode="quasi-static",
            drag=(2, 2, 1),
            method=method,
        )
        assert path.outcome is Outcome.REST
        assert path.final_pose == pytest.approx([0, 0, np.pi / 2], abs=1e-12)


def array_of(array, pitch):
    """Return an array of the same size whose pixels have another pitch, point tips, no grip."""
    pixels = round(array.width / pitch)
    pixel = replace(array.pixel, pitch=pitch, tip_width=0.0, residual_fraction=0.0)
    return replace(array, pixel=pixel, rows=pixels, columns=pixels)


LINE = 0.3


@pytest.fixture(scope="module")
def continuum(paper_t, array64):
    """The density of an array whose dithered axis directions add up to the normal of a line."""
    mixed = 1.0 / (abs(np.cos(LINE)) + abs(np.sin(LINE)))
    return DensityField.squeeze(LINE, push_density(paper_t, array64) * mixed)


def test_loads_of_an_array_tend_to_those_of_its_density(paper_t, array64, continuum, rng):
    """The error falls with a power of the pitch; see docs/fields.md."""
    poses = np.column_stack([rng.uniform(-2e-3, 2e-3, (16, 2)), rng.uniform(0.0, 2 * np.pi, 16)])
    exact, pitches, errors = continuum.load(paper_t, poses), (4e-4, 2e-4, 1e-4, 5e-5), []
    size = push_density(paper_t, array64) * paper_t.area
    unit = size * np.array([1.0, 1.0, paper_t.circumradius])
    for pitch in pitches:
        drive = squeeze_activation(array_of(array64, pitch), LINE)
        loads = [
            simulate(paper_t, drive, q, 1e-9, mode="quasi-static", time_step=1e-9).loads[0]
            for q in poses
        ]
        errors.append(np.sqrt(np.mean(((loads - exact) / unit) ** 2)))
    rate = np.polyfit(np.log(pitches), np.log(errors), 1)[0]
    assert 1.1 < rate < 2.0
    assert errors[-1] < 3e-3


@pytest.mark.slow
def test_rest_on_an_array_tends_to_that_in_its_density(paper_t, array64, continuum, rng):
    drag = air_film_drag(paper_t, array64)
    starts = np.column_stack([rng.uniform(-5e-4, 5e-4, (6, 2)), rng.uniform(0.0, 2 * np.pi, 6)])
    pitches, errors, paths = (4e-4, 2e-4, 1e-4), [], []
    for pitch in pitches:
        drive, off, apart = squeeze_activation(array_of(array64, pitch), LINE), [], []
        for q in starts:
            path = simulate(
                paper_t, drive, q, 12.0, mode="quasi-static", time_step=2.5 * pitch, frames=1000
            )
            limit = field_motion(
                paper_t, continuum, q, path.duration, mode="quasi-static", drag=drag, frames=1000
            )
            off.append(path.final_pose[2] - limit.final_pose[2])
            t = np.linspace(0.0, min(path.duration, limit.duration), 50)
            there, here = (PchipInterpolator(p.times, p.poses[:, 2])(t) for p in (path, limit))
            apart.append(there - here)
        errors.append(np.sqrt(np.mean(np.square(off))))
        paths.append(np.sqrt(np.mean(np.square(apart))))
    for found in (errors, paths):
        assert np.polyfit(np.log(pitches), np.log(found), 1)[0] > 1.1
        assert found[-1] < 0.02


@pytest.mark.parametrize(
    ("more", "argument"),
    [
        ({"mode": "quasi-static"}, "drag"),
        ({"mode": "quasi-static", "drag": (1.0, 0.0, 1.0)}, "drag"),
        ({"drag": (1.0, -1.0, 1.0)}, "drag"),
        ({"drag": 1.0}, "drag"),
        ({"mode": "slow"}, "mode"),
        ({"method": "guess"}, "method"),
        ({"pose": (0.0, 1.0)}, "pose"),
        ({"twist": (0.0, 1.0, np.nan)}, "twist"),
        ({"duration": 0.0}, "duration"),
        ({"tolerance": -1.0}, "tolerance"),
        ({"time_step": 0.0, "method": "steps"}, "time_step"),
        ({"time_step": 1e-12, "duration": 1.0, "method": "steps"}, "time_step"),
        ({"frames": 0}, "frames"),
        ({"frames": 2.5}, "frames"),
        ({"frames": "many"}, "frames"),
        ({"part": "card"}, "part"),
        ({"field": lambda points: points}, "field"),
        ({"friction": 0.3}, "friction"),
        ({"load": LoadTable(lambda t: (t, 0.0, 0.0), 1.0), "duration": 2.0}, "load"),
        ({"load": (1.0, 0.0)}, "load"),
        ({"friction": UniformFriction(CARD, 1.0), "load": lambda t: (t, 0.0, 0.0)}, "method"),
    ],
)
def test_bad_arguments_are_named(more, argument):
    with pytest.raises(InputError) as found:
        field_motion(**({"part": CARD, "field": SQUEEZE} | more))
    assert found.value.argument == argument


def test_the_example_of_the_docs_runs(capsys):
    page = (Path(__file__).parents[2] / "docs" / "fields.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(code, "fields.md", "exec"), {})
    assert "at rest" in capsys.readouterr().out


def test_a_mass_needs_an_areal_density():
    with pytest.raises(InputError) as found:
        field_motion(Part([(0, 0), (1, 0), (0, 1)]), SQUEEZE)
    assert found.value.argument == "areal_density"


@pytest.mark.parametrize("time_step", [0.03, 1.0])
def test_steps_end_at_the_limit(time_step):
    path = field_motion(CARD, SQUEEZE, duration=0.1, method="steps", time_step=time_step)
    assert path.duration == pytest.approx(0.1, rel=1e-12)
    assert len(path.times) == 1 + np.ceil(0.1 / time_step)


def test_a_table_of_a_constant_load_lets_a_part_rest():
    start, load = (0.1, 0.2, 0.3), (0.0, 0.3, 0.1)
    kind = KINDS["quasi-static"]
    one = field_motion(CARD, SQUEEZE, start, load=load, **kind)
    other = field_motion(CARD, SQUEEZE, start, load=LoadTable(load, 1.0), **kind)
    assert one.outcome is other.outcome
    assert np.array_equal(one.final_pose, other.final_pose)
