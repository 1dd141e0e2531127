import numpy as np
import pytest
import shapely

from limitsurf.actuators.actuator_array import load_array
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part
from limitsurf.motion.trajectory import EventKind, Outcome
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.verification import verify_alignment


@pytest.fixture(scope="module")
def plan(paper_t):
    return plan_alignment(paper_t)


@pytest.fixture(scope="module")
def verification(plan, paper_t, array64):
    return verify_alignment(plan, paper_t, array64, samples=24, seed=3)


def test_the_paper_t_aligns(verification):
    assert verification.rate > 0.9
    assert verification.poses.shape == (24, 3, 3)
    assert np.all(verification.durations > 0)
    assert verification.worst_errors.max() < 1e-7
    assert "24 runs" in repr(verification)


def test_success_is_what_it_says(verification):
    errors = np.degrees(verification.errors)
    final = np.degrees(verification.poses[:, -1, 2] - verification.plan.final)
    assert np.mod(final - errors + 1e-9, 180.0) == pytest.approx(np.full(24, 1e-9), abs=1e-6)
    expected = (np.abs(errors) <= 6.0) & (verification.outcomes == Outcome.REST).all(axis=1)
    assert np.array_equal(verification.successes, expected)
    assert verification.rate == expected.mean()


def test_wilson_interval(verification):
    """Wilson (1927), written out."""
    n, p, z = verification.samples, verification.rate, 1.959963984540054
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    assert verification.interval == pytest.approx((middle - half, middle + half))


def test_results_do_not_depend_on_threads(plan, paper_t, array64, verification):
    one = verify_alignment(plan, paper_t, array64, samples=24, seed=3, jobs=1)
    assert np.array_equal(one.poses, verification.poses)
    assert np.array_equal(one.durations, verification.durations)


def test_other_seeds_give_other_starts(plan, paper_t, array64, verification):
    other = verify_alignment(plan, paper_t, array64, samples=2, seed=4)
    assert not np.array_equal(other.poses[:2, 0], verification.poses[:2, 0])


def test_starts_fill_the_disk(plan, paper_t, array64):
    from limitsurf.motion.starts import random_starts

    starts = random_starts(20000, 0, 2.0)
    radii = np.hypot(starts[:, 0], starts[:, 1])
    assert radii.max() < 2.0
    assert np.mean(radii < 1.0) == pytest.approx(0.25, abs=0.01)
    assert np.mean(starts[:, 2]) == pytest.approx(np.pi, abs=0.05)


def test_replay_repeats_a_run(verification):
    replay = verification.replay(5)
    ends = [path.final_pose for path in replay]
    assert np.array_equal(ends, verification.poses[5, 1:])
    with pytest.raises(InputError, match="run"):
        verification.replay(24)


def test_dataset_has_units_and_no_time_stamps(verification, tmp_path):
    data = verification.to_dataset()
    for name in ("pose", "duration", "orientation_error"):
        assert data[name].attrs["units"]
    texts = []
    for name in ("a.nc", "b.nc"):
        data.to_netcdf(tmp_path / name, engine="scipy")
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]


def test_nearest_axis_fails_on_oblique_lines(plan, paper_t, array64):
    """The direction error of 45 degrees is beyond the critical angle: no equilibrium is left."""
    nearest = verify_alignment(plan, paper_t, array64, samples=6, method="nearest", seed=0)
    assert nearest.rate == 0.0
    assert len(nearest.failures) == 6


def test_runs_that_leave_the_array_fail(plan, paper_t):
    array = load_array("resonator64")
    drift = plan_alignment(Part(shapely.affinity.rotate(paper_t.polygon, 20.0), 0.08))
    result = verify_alignment(drift, paper_t, array, samples=4, seed=0)
    assert result.samples == 4  # another plan: it may well fail, but every run is recorded
    assert result.outcomes.shape == (4, len(drift.lines))


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"samples": 0}, "samples"),
        ({"samples": -3}, "samples"),
        ({"seed": -1}, "seed"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"start_offset": -1.0}, "start_offset"),
        ({"start_offset": 4e-3}, "array"),
    ],
)
def test_bad_arguments_are_named(plan, paper_t, array64, arguments, name):
    with pytest.raises(InputError) as caught:
        verify_alignment(plan, paper_t, array64, **arguments)
    assert caught.value.argument == name


def test_small_arrays_and_heavy_parts(plan, paper_t):
    with pytest.raises(InputError, match="larger array"):
        verify_alignment(plan, paper_t, load_array("resonator32"))
    with pytest.raises(PartTooHeavy, match="would lift it"):
        verify_alignment(plan, paper_t, load_array("resonator64", voltage=10.0))


def test_centred_plans_centre_first(paper_t, array64):
    """A linear radial field and then the squeeze, as one motion on each line."""
    plan = plan_alignment(paper_t, model="centred")
    result = verify_alignment(plan, paper_t, array64, samples=8, seed=1)
    assert result.rate == 1.0
    assert [len(stages) for stages in result.stages] == [2, 2]
    replay = result.replay(3)
    assert np.array_equal([path.final_pose for path in replay], result.poses[3, 1:])
    for path in replay:
        (switch,) = [e.time for e in path.events if e.kind is EventKind.SWITCH]
        before = path.poses[np.searchsorted(path.times, switch)]
        assert np.hypot(before[0], before[1]) < 0.1 * paper_t.circumradius


def test_push_squeeze_plans_squeeze_towards_a_line_beside_the_part(paper_t, array64):
    plan = plan_alignment(paper_t, model="push-squeeze")
    with pytest.raises(InputError, match="larger array"):
        verify_alignment(plan, paper_t, array64)
    array = load_array("resonator128")
    result = verify_alignment(plan, paper_t, array, samples=4, seed=1)
    for line, poses in zip(plan.lines, result.poses.transpose(1, 0, 2)[1:], strict=True):
        across = poses[:, :2] @ [-np.sin(line), np.cos(line)]
        assert np.abs(across / paper_t.circumradius + 1.1).max() < 0.5


@pytest.mark.slow
def test_nano_sim_on_the_large_array():
    part, array = Part.from_file("nano_sim"), load_array("resonator128", voltage=75.0)
    result = verify_alignment(plan_alignment(part), part, array, samples=60, seed=1)
    assert result.rate > 0.85
    assert result.worst_errors.max() < 1e-7
