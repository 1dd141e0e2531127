import itertools

import numpy as np
import pytest
import shapely

from limitsurf.errors import InputError, NoPlan
from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import AlignmentPlan, plan_alignment
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.turn_function import turn_function
from limitsurf.planning.verification import verify_alignment
from tests.reference_cases import CASES, NAMES, angle_distance


def outcomes(plan, errors):
    """Return the final orientations, modulo the period, of starts everywhere and line errors."""
    phi = np.linspace(0.0, np.pi, 3001)
    for line, error in zip(plan.lines, errors, strict=True):
        phi = plan.squeeze(phi - line - error) + line + error
    return np.mod(phi - plan.final + plan.period / 2, plan.period) - plan.period / 2


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_plans_are_as_short_and_as_safe_as_the_reference(case):
    plan = plan_alignment(Part(case["vertices"]))
    assert len(plan.lines) == case["plan"]["bfs_length"]
    assert plan.period == pytest.approx(case["period_T"])
    best = case["plan"]["max_min_margin"]
    assert plan.least_margin == pytest.approx(np.inf if best is None else best, abs=1e-12)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_plans_align_every_orientation(case):
    plan = plan_alignment(Part(case["vertices"]))
    assert np.abs(outcomes(plan, np.zeros(len(plan.lines)))).max() < 1e-9
    starts = np.linspace(0.0, np.pi, 777)
    ends = np.unique(np.round(np.mod(plan.predict(starts) - plan.final + 0.1, plan.period), 8))
    assert ends == pytest.approx([0.1])


@pytest.mark.parametrize("name", ["T", "blob_m3", "longplan_L5", "near_square"])
def test_plans_tolerate_their_margins_and_no_more(name):
    """Errors of consecutive lines add up within a step: half the margin each is safe."""
    plan = plan_alignment(Part(CASES[NAMES.index(name)]["vertices"]))
    k = len(plan.lines)
    for signs in itertools.product((-1, 1), repeat=k):
        errors = 0.499 * plan.least_margin * np.array(signs)
        drift = outcomes(plan, errors) - errors[-1]
        assert np.ptp(np.mod(drift + plan.period / 2, plan.period)) < 1e-9
    weakest = int(np.argmin(plan.margins))
    broken = 0
    for sign in (-1, 1):
        errors = np.zeros(k)
        errors[weakest:] = sign * 1.001 * plan.least_margin
        drift = np.mod(outcomes(plan, errors) - errors[-1] + plan.period / 2, plan.period)
        broken += np.ptp(drift) > 1e-3
    assert broken


def test_shortest_plan_by_breadth_first_search():
    """The slow twin: search over sets of images, with relative turns from a grid."""
    case = CASES[NAMES.index("blob_m3")]
    plan = plan_alignment(Part(case["vertices"]))
    squeeze = plan.squeeze
    states = {frozenset(range(len(squeeze.images)))}
    turns = np.linspace(0.0, np.pi, 721)
    images = np.mod(squeeze.images, np.pi)
    length = 1
    while all(len(state) > 1 for state in states):
        states = {
            frozenset(int(np.argmin(np.abs(images - squeeze(images[i] - turn)))) for i in state)
            for state in states
            for turn in turns
        }
        length += 1
        assert length < 10
    assert len(plan.lines) == length


def test_wheel_with_a_missing_tooth():
    plan = plan_alignment(Part.from_file("wheel_7_of_8"))
    assert len(plan.lines) == 4
    margins = np.degrees(plan.margins[1:])
    assert margins.min() > 6.0
    assert margins.max() < 12.1


def test_paper_t():
    plan = plan_alignment(Part.from_file("paper_t"))
    assert len(plan.lines) == 2
    assert np.degrees(plan.least_margin) == pytest.approx(33.67, abs=0.01)


def test_min_margin():
    part = Part(CASES[NAMES.index("near_square")]["vertices"])
    best = plan_alignment(part).least_margin
    assert plan_alignment(part, min_margin=0.99 * best).least_margin == pytest.approx(best)
    with pytest.raises(NoPlan, match="reachable") as caught:
        plan_alignment(part, min_margin=2 * best)
    assert caught.value.reachable_margin >= best
    reachable = plan_alignment(part, min_margin=caught.value.reachable_margin * (1 - 1e-9))
    assert reachable.least_margin >= caught.value.reachable_margin * (1 - 1e-9)
    with pytest.raises(InputError, match="min_margin"):
        plan_alignment(part, min_margin=-1.0)


def test_neutral_parts_have_no_plan():
    disk = Part(shapely.Point(0, 0).buffer(1.0))
    with pytest.raises(NoPlan, match=r"cannot be aligned.*neutral.*Zindler") as caught:
        plan_alignment(disk)
    critical = np.degrees(turn_function(disk).critical_angle)
    assert f"{critical:.1e} deg" in str(caught.value)
    assert caught.value.plan is None


@pytest.mark.parametrize("name", ["T", "blob_m3", "longplan_L5", "near_square", "pentagon"])
def test_goal(name):
    part = Part(CASES[NAMES.index(name)]["vertices"])
    for goal in (0.0, 1.0, 4.0):
        plan = plan_alignment(part, goal=goal)
        ends = plan.predict(np.linspace(0.0, np.pi, 99)) - goal
        assert ends - plan.period * np.round(ends / plan.period) == pytest.approx(0.0, abs=1e-9)
        assert 0.0 <= plan.final < plan.period


def test_given_lines_align_the_part():
    plan = plan_alignment(Part.from_file("longplan_L5"), lines=24)
    steps = np.degrees(plan.lines) / 7.5
    assert steps == pytest.approx(np.round(steps))
    assert np.abs(outcomes(plan, np.zeros(len(plan.lines)))).max() < 1e-9
    assert isinstance(plan, AlignmentPlan)


def test_predict_is_the_plan_carried_out():
    """Turning the part under a fixed line is the same as turning the line about the part."""
    plan = plan_alignment(Part.from_file("longplan_L5"))
    for start in np.random.default_rng(0).uniform(-9.0, 9.0, 20):
        phi = start
        for line in plan.lines:
            reduced = (phi - line) % np.pi
            step = max(np.flatnonzero(plan.squeeze.breaks <= reduced), default=-1)
            phi = plan.squeeze.images[step] + line
        assert np.sin(plan.predict(start) - phi) == pytest.approx(0.0, abs=1e-12)


def test_the_reachable_plan_belongs_to_the_part():
    part = Part.from_file("paper_t")
    with pytest.raises(NoPlan) as caught:
        plan_alignment(part, min_margin=1.0)
    assert isinstance(caught.value.plan, AlignmentPlan)
    assert caught.value.plan.part is part


def test_symmetric_parts_known_to_nine_digits_have_wide_margins():
    """Vertices with errors below 1e-10 leave steps that repeat to as much, not exactly."""
    rng = np.random.default_rng(1)
    radius = np.array([1.0, 0.55, 0.8, 0.45])
    angle = np.arange(20) * np.pi / 10
    star = np.tile(radius, 5)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    plan = plan_alignment(Part(star + 1e-11 * rng.normal(size=star.shape)))
    exact = plan_alignment(Part(star))
    assert plan.period == exact.period == pytest.approx(np.pi / 5)
    assert len(plan.lines) == len(exact.lines)
    assert plan.least_margin == pytest.approx(exact.least_margin, abs=1e-8)
    assert np.abs(outcomes(plan, np.zeros(len(plan.lines)))).max() < 1e-8


def test_final_orientation_is_stable_relative_to_the_last_line():
    for case in CASES:
        plan = plan_alignment(Part(case["vertices"]))
        relative = np.mod(plan.final - plan.lines[-1], plan.period)
        stable = np.mod(case["stable_phi"], plan.period)
        assert (
            angle_distance([relative], [stable[np.argmin(np.abs(stable - relative))]], plan.period)
            < 1e-9
        )


def test_a_plan_is_not_longer_for_rounding():
    """Two plans have one margin, but for its last digit; the shorter one is reported."""
    pieces = [shapely.box(0, 0, 1, 1), shapely.box(2, 1, 2.7, 3)]
    turned = shapely.affinity.rotate(shapely.box(-1, 3, 0.3, 4), 20)
    part = Part(shapely.MultiPolygon([*pieces, turned]))
    with pytest.raises(NoPlan) as found:
        plan_alignment(part, model="push-squeeze", min_margin=1.0)
    best = found.value.plan
    assert found.value.reachable_margin == best.least_margin
    slack = best.least_margin * (1.0 - 1e-9)
    assert len(best.lines) == len(
        plan_alignment(part, model="push-squeeze", min_margin=slack).lines
    )


def test_differences_that_the_symmetry_denies_are_not_relied_on():
    """A nonagon, three times symmetric to 1e-9, whose steps differ by 1e-7."""
    angle = 0.3 + 2 * np.pi * np.arange(9) / 9
    radius = 1.0 + 1.3464454409219474e-09 * np.random.default_rng(921).normal(size=9)
    part = Part(radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))
    assert part.symmetry_order == 3
    for model, ratio in (("squeeze", 0.0), ("centred", 1.0), ("push-squeeze", 1.0)):
        plan = plan_alignment(part, model=model, mobility_ratio=ratio)
        assert verify_alignment(plan, part, IdealSqueeze(ratio), 40, 0).rate == 1.0
