import itertools
import json

import numpy as np
import pytest
import shapely

from limitsurf.errors import InputError, ModelError, NoPlan
from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import AlignmentPlan, plan_alignment
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


def test_json_round_trip(tmp_path):
    plan = plan_alignment(Part.from_file("longplan_L5"))
    text = plan.to_json()
    path = tmp_path / "plan.json"
    path.write_text(text)
    for again in (AlignmentPlan.from_json(text), AlignmentPlan.from_json(path)):
        assert again.to_json() == text
        assert np.array_equal(again.lines, plan.lines)
        assert np.array_equal(again.margins, plan.margins)
    assert json.loads(text)["unit"] == "rad"
    for bad in ("", "{}", '{"lines": 3}'):
        with pytest.raises(ModelError, match="no alignment plan"):
            AlignmentPlan.from_json(bad)


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
    with pytest.raises(NoPlan, match="neutral"):
        plan_alignment(Part(shapely.Point(0, 0).buffer(1.0)))


def test_final_orientation_is_stable_relative_to_the_last_line():
    for case in CASES:
        plan = plan_alignment(Part(case["vertices"]))
        relative = np.mod(plan.final - plan.lines[-1], plan.period)
        stable = np.mod(case["stable_phi"], plan.period)
        assert (
            angle_distance([relative], [stable[np.argmin(np.abs(stable - relative))]], plan.period)
            < 1e-9
        )
