"""Plans in the ideal squeeze field, under the model they were made for and under others."""

import numpy as np
import pytest

from limitsurf.errors import InputError, NoPlan
from limitsurf.geometry.part import Part
from limitsurf.motion.trajectory import Outcome
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.separatrices import boundary_shift
from limitsurf.planning.verification import Verification, verify_alignment
from tests.reference_cases import CASES

PARTS = {case["name"]: Part(np.array(case["vertices"])) for case in CASES}
RATIOS = (0.1, 1.0, 10.0)
MOVING = ("centred", "push-squeeze", "unknown-offset")


@pytest.fixture(scope="module")
def part():
    return PARTS["T"]


@pytest.fixture(scope="module")
def plan(part):
    return plan_alignment(part)


@pytest.mark.parametrize("name", ["T", "longplan_L5"])
def test_2phase_plans_always_work_under_2phase(name):
    part = PARTS[name]
    result = verify_alignment(plan_alignment(part), part, IdealSqueeze(0.0), 60, 1)
    assert result.rate == 1.0
    assert np.abs(result.errors).max() < 1e-9


@pytest.mark.parametrize("model", MOVING)
@pytest.mark.parametrize("name", ["triangle_3-4-5", "T", "simple_16"])
def test_plans_of_full_motion_always_work_under_it(model, name):
    part = PARTS[name]
    plan = plan_alignment(part, model=model, mobility_ratio=1.0)
    result = verify_alignment(plan, part, IdealSqueeze(1.0), 100, 2)
    assert result.rate == 1.0
    assert plan.period == pytest.approx(2 * np.pi if model == "push-squeeze" else np.pi)


def test_2phase_plans_may_fail_under_full_motion(part, plan):
    """The table in the docs: a plan that ignores the offset loses some starts."""
    result = verify_alignment(plan, part, IdealSqueeze(10.0), 200, 1)
    assert 0.4 < result.rate < 0.8
    assert (result.outcomes == Outcome.REST).all()


def test_margins_above_the_shift_of_borders_are_enough(part, plan):
    """The sufficient test: 2PHASE plans with such margins work from any offset."""
    shift = boundary_shift(part, 1.0)
    assert shift < plan.least_margin < boundary_shift(part, 10.0)
    assert verify_alignment(plan, part, IdealSqueeze(1.0), 200, 1).rate == 1.0


def test_other_outlines_fail(part, plan):
    """A plan for another part is no plan: the count can come out below one."""
    other = PARTS["simple_16"]
    assert verify_alignment(plan, other, IdealSqueeze(0.0), 100, 1).rate < 0.9


def test_replay_leads_to_the_recorded_poses(part, plan):
    result = verify_alignment(plan, part, IdealSqueeze(10.0), 60, 1)
    assert isinstance(result, Verification)
    for run in (*result.failures[:3], 0):
        paths = result.replay(run)
        assert len(paths) == len(plan.lines)
        for k, (path, line) in enumerate(zip(paths, plan.lines, strict=True)):
            assert path.offsets[0] == pytest.approx(result.offsets[run, k])
            before, after = result.poses[run, k : k + 2]
            assert path.orientations[0] + line == pytest.approx(before[2])
            assert path.orientations[-1] + line == pytest.approx(after[2], abs=1e-7)
            normal = np.array([-np.sin(line), np.cos(line)])
            assert path.offsets[-1] == pytest.approx(-normal @ after[:2], abs=1e-7)
    with pytest.raises(InputError, match="run"):
        result.replay(60)


def test_starts_are_what_the_model_says(part):
    """Any line that meets the part, the centroid on the line, the whole part on its left."""
    corners = part.edges[:, :2]
    for model in ("squeeze", "centred", "push-squeeze"):
        plan = plan_alignment(part, model=model)
        result = verify_alignment(plan, part, IdealSqueeze(1.0), 300, 4)
        theta = plan.lines - result.poses[:, :-1, 2]
        normal = np.stack([-np.sin(theta), np.cos(theta)], axis=-1)
        across = normal @ corners.T - result.offsets[..., None]
        if model == "squeeze":
            assert (across.min(axis=-1) <= 0).all()
            assert (across.max(axis=-1) >= 0).all()
            share = -across.min(axis=-1) / np.ptp(across, axis=-1)
            assert share.mean() == pytest.approx(0.5, abs=0.05)
        elif model == "centred":
            assert (result.offsets == 0.0).all()
        else:
            assert (across.min(axis=-1) >= 0).all()
        turn = np.mod(result.poses[:, 0, 2], 2 * np.pi)
        assert np.histogram(turn, 4, (0, 2 * np.pi))[0].min() > 50


def test_results_depend_on_the_seed_alone(part, plan):
    one, two, other = (
        verify_alignment(plan, part, IdealSqueeze(10.0), 20, seed) for seed in (1, 1, 2)
    )
    assert np.array_equal(one.poses, two.poses)
    assert not np.array_equal(one.poses, other.poses)


def test_a_known_offset_is_honoured(part, plan):
    result = verify_alignment(plan, part, IdealSqueeze(10.0), 50, 1, start_offset=0.01)
    assert np.abs(result.offsets).max() <= 0.01
    assert result.rate == 1.0


def test_bad_arguments_are_named(part, plan):
    centred = plan_alignment(part, model="centred")
    drive = IdealSqueeze()
    for bad, arguments in (
        ("samples", {"samples": 0}),
        ("tolerance", {"tolerance": -1.0}),
        ("start_offset", {"start_offset": -1.0}),
    ):
        with pytest.raises(InputError, match=bad):
            verify_alignment(plan, part, drive, **arguments)
    with pytest.raises(InputError, match="start_offset"):
        verify_alignment(centred, part, drive, start_offset=0.1)
    with pytest.raises(InputError, match="drive"):
        verify_alignment(plan, part, "array")


@pytest.mark.slow
@pytest.mark.parametrize("name", PARTS)
def test_all_reference_parts_align_under_their_models(name):
    """400 starts, every model and mobility ratio: the acceptance of the planner."""
    part = PARTS[name]
    assert verify_alignment(plan_alignment(part), part, IdealSqueeze(0.0), 400, 1).rate == 1.0
    for ratio in RATIOS:
        for model in MOVING:
            try:
                plan = plan_alignment(part, model=model, mobility_ratio=ratio)
            except NoPlan:
                assert model == "unknown-offset"  # right when it finds a plan, but incomplete
                assert ratio == 10.0
                continue
            assert verify_alignment(plan, part, IdealSqueeze(ratio), 400, 1).rate == 1.0
