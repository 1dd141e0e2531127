from dataclasses import replace

import numpy as np
import pytest

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.simulate_many import simulate_many
from limitsurf.motion.starts import random_starts
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.field_errors import FieldErrors
from limitsurf.planning.robustness import robustness
from limitsurf.planning.turn_function import turn_function
from tests.planning.test_field_errors import with_pitch
from tests.reference_cases import CASES, NAMES

LOBED = ["T", "U_sym", "blob_m3", "simple_16", "longplan_L5"]


def plan_of(name):
    return plan_alignment(Part(CASES[NAMES.index(name)]["vertices"]))


@pytest.fixture(scope="module")
def plan(paper_t):
    return plan_alignment(paper_t)


def simulated(plan, array, runs, method="dither"):
    """Return orientation errors [rad] of runs on an array, modulo the plan's period."""
    poses = random_starts(runs, 5, 0.0)
    for line in plan.lines:
        drive = squeeze_activation(array, line, method=method)
        poses = simulate_many(plan.part, drive, poses, tolerance=3e-4, jobs=1).finals
    return np.mod(poses[:, 2] - plan.final + plan.period / 2, plan.period) - plan.period / 2


@pytest.mark.parametrize("name", LOBED)
def test_without_errors_nothing_changes(name):
    plan = plan_of(name)
    found = plan.robustness(FieldErrors())
    assert found.status == "guaranteed"
    assert found.final_width < 1e-6
    assert found.worst.at_risk < 1e-4
    assert (found.worst.margins >= plan.margins - 1e-5).all()
    assert found.least_margin >= plan.least_margin - 1e-5


@pytest.mark.parametrize("name", LOBED)
def test_margins_of_a_plan_are_met_by_the_weakest_line(name):
    """The turn that the weakest line tolerates is the margin, unless an arc has inner slack."""
    plan = plan_of(name)
    k = int(np.argmin(plan.margins))
    found = plan.robustness(FieldErrors())
    assert found.worst.margins[k] < np.pi / 2

    def turned(off):
        lines = plan.lines + np.where(np.arange(len(plan.lines)) >= k, off, 0.0)
        return replace(plan, lines=lines, final=plan.final + off).robustness(FieldErrors()).status

    margin = found.worst.margins[k]
    assert [turned(sign * 0.999 * margin) for sign in (-1, 1)] == ["guaranteed"] * 2
    assert "lost" in [turned(sign * (margin + 1e-5)) for sign in (-1, 1)]


@pytest.mark.parametrize(
    ("vertices", "degrees"),
    [
        ([(0, 0), (1, 0), (1, 1), (0, 1)], 6.6),
        ([(np.cos(t), np.sin(t)) for t in 2 * np.pi * np.arange(5) / 5], 0.39),
        ([(0, 0), (2, 0), (2, 1), (0, 1)], 39.3),
    ],
    ids=["square", "pentagon", "rectangle"],
)
def test_equilibria_vanish_beyond_the_critical_angle(vertices, degrees):
    """planning.md: 6.6, 0.39 and 39 degrees."""
    plan = plan_alignment(Part(vertices))
    for sign in (-1, 1):
        inside, outside = (
            plan.robustness(FieldErrors(direction=np.radians(sign * degrees * f)))
            for f in (0.98, 1.02)
        )
        assert inside.status == "guaranteed"
        assert inside.worst.lost.sum() == 0
        assert outside.status == "lost"
        assert outside.worst.lost[0] == len(plan.squeeze.images)
        assert outside.worst.at_risk == 1.0


def test_errors_only_make_things_worse(plan):
    rank = {"guaranteed": 0, "likely": 1, "lost": 2}
    last, width, margin = 0, 0.0, np.inf
    for worst in (0.0, 0.01, 0.03, 0.045, 0.1, 0.3):
        found = plan.robustness(FieldErrors(pixels=0.4 * worst, pixels_worst=worst))
        assert rank[found.status] >= last
        assert found.final_width >= width - 1e-9
        assert found.least_margin <= margin + 1e-9
        last, width, margin = rank[found.status], found.final_width, found.least_margin
    assert last == 2


def test_the_paper_t_needs_dither(plan, paper_t, array64):
    array = array64.running_under(paper_t)
    assert plan.robustness(array).status == "likely"
    nearest = plan.robustness(array, method="nearest")
    assert nearest.steps == ("likely", "lost")
    errors = simulated(plan, array, 8, method="nearest")
    assert (np.abs(errors) > np.radians(6.0)).sum() >= 6


def test_what_is_guaranteed_aligns_within_the_width(plan, paper_t, array64):
    found = plan.robustness(with_pitch(array64, 1e-4))
    assert found.status == "guaranteed"
    errors = simulated(plan, with_pitch(array64, 1e-4), 12)
    low, high = found.worst.sets[-1][0] - plan.final
    assert low <= errors.min()
    assert errors.max() <= high
    assert found.final_width < np.radians(6.0)


@pytest.mark.slow
def test_what_is_guaranteed_always_aligns(array64):
    """A U of 2.4 mm, and the paper T with dead actuators at a fine pitch."""
    vertices = np.array(CASES[NAMES.index("U_sym")]["vertices"])
    vertices = 2.4e-3 * vertices / Part(vertices).circumradius
    cases = [
        (Part(vertices, "80 g/m^2"), with_pitch(array64, 1e-4), 60),
        (Part.from_file("paper_t"), with_pitch(array64, 5e-5).with_spread(dead=0.02, seed=2), 20),
    ]
    for part, array, runs in cases:
        plan = plan_alignment(part)
        found = plan.robustness(array)
        assert found.status == "guaranteed"
        errors = simulated(plan, array, runs)
        low, high = found.worst.sets[-1][0] - plan.final
        low, high = (x - plan.period * np.round(low / plan.period) for x in (low, high))
        assert low <= errors.min()
        assert errors.max() <= high


def test_starts_at_risk_are_those_that_stay_between(array64):
    """On one line with much grip: starts near the unstable orientation stay, all others align."""
    part = Part([(0, 0), (4e-3, 0), (4e-3, 2e-3), (0, 2e-3)], "80 g/m^2")
    array = with_pitch(array64, 1e-4)
    pixel = replace(array.pixel, residual_fraction=0.03 * array.pixel.offset_fraction)
    array, plan = replace(array, pixel=pixel), plan_alignment(part)
    found = plan.robustness(array)
    assert found.steps == ("guaranteed",)
    assert 0.02 < found.worst.at_risk < 0.2
    half = 0.5 * np.pi * found.worst.at_risk
    drive = squeeze_activation(array, plan.lines[0])
    ends = []
    for off in (0.0, 1.3 * half, -1.3 * half):
        pose = (0.0, 0.0, plan.squeeze.breaks[0] + plan.lines[0] + off)
        end = simulate_many(part, drive, [pose], tolerance=3e-4, jobs=1).finals[0, 2] - plan.final
        ends.append(abs(np.mod(end + np.pi / 2, np.pi) - np.pi / 2))
    assert ends[0] > np.radians(60.0)
    assert max(ends[1:]) <= found.final_width


def test_grip_loses_the_plan(plan, paper_t, array64):
    """Friction of half the push: the T stays where it is put."""
    pixel = replace(array64.pixel, residual_fraction=0.5 * array64.pixel.offset_fraction)
    sticky = replace(array64, pixel=pixel)
    found = plan.robustness(sticky)
    assert found.status == "lost"
    assert (np.abs(simulated(plan, sticky, 8)) > np.radians(6.0)).any()


def test_table_says_which_source_dominates(plan, array64):
    found = plan.robustness(with_pitch(array64, 1e-4).with_spread(dead=0.3, seed=0))
    rows = found.table()
    assert len(rows) == 5 * len(plan.lines)
    by_source = {row["source"]: row for row in rows if row["line"] == 2}
    assert by_source["spread"]["rest_deg"] > by_source["pixels"]["rest_deg"]
    assert by_source["all"]["rest_deg"] >= by_source["spread"]["rest_deg"]
    assert by_source["deadband"]["rest_deg"] < 1e-6
    assert by_source["direction"]["line_deg"] == pytest.approx(np.degrees(plan.lines[1]))


def test_a_small_skew_shifts_rests_by_its_tangent(plan):
    """planning.md: by about eps U / (2J - U)."""
    eps = 1e-3
    row = plan.robustness(FieldErrors(direction=eps)).table()[0]
    turn = turn_function(plan.part)
    shift = eps * turn.potential(turn.stable) / turn.curvature(turn.stable)
    assert np.radians(row["rest_deg"]) == pytest.approx(shift.max(), rel=0.02)


def test_one_errors_for_each_line(plan):
    two = plan.robustness([FieldErrors(), FieldErrors(direction=1.0)])
    assert two.steps == ("guaranteed", "lost")
    assert "lost" in repr(two)
    with pytest.raises(InputError, match="3 lines"):
        plan.robustness([FieldErrors()] * 3)
    with pytest.raises(InputError, match="no FieldErrors"):
        plan.robustness([1.0, 2.0])
    with pytest.raises(InputError, match="sigmas"):
        plan.robustness(FieldErrors(), sigmas=0.0)
    alone = robustness(plan, FieldErrors())
    assert alone.least_margin == pytest.approx(plan.least_margin, abs=1e-5)
    assert two.least_margin == 0.0
