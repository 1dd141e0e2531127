"""Many starts at once: the runs of `simulate`, on any number of threads."""

import numpy as np
import pytest
import xarray

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.errors import InputError
from limitsurf.motion.simulate import simulate
from limitsurf.motion.simulate_many import simulate_many
from limitsurf.motion.starts import random_starts
from limitsurf.motion.trajectory import Outcome


@pytest.fixture(scope="module")
def drive(array64):
    return squeeze_activation(array64, 0.0)


def test_the_runs_are_those_of_simulate(drive, paper_t):
    starts = random_starts(6, 3, 1e-3)
    runs = simulate_many(paper_t, drive, starts, tolerance=1e-3)
    for k, start in enumerate(starts):
        alone = simulate(paper_t, drive, start, tolerance=1e-3)
        assert np.array_equal(runs.finals[k], alone.final_pose)
        assert runs.durations[k] == alone.duration
        assert runs.outcomes[k] == alone.outcome
    assert np.array_equal(runs.replay(2).final_pose, runs.finals[2])
    assert repr(runs) == "Runs(6: 6 at rest)"
    with pytest.raises(InputError, match="run: must lie in"):
        runs.replay(6)


def test_threads_and_seeds(drive, paper_t):
    runs = [simulate_many(paper_t, drive, 12, seed=5, jobs=j, tolerance=1e-3) for j in (1, 2, 4)]
    assert all(np.array_equal(run.finals, runs[0].finals) for run in runs)
    other = simulate_many(paper_t, drive, 12, seed=6, tolerance=1e-3)
    assert not np.array_equal(other.starts, runs[0].starts)
    assert np.hypot(*runs[0].starts[:, :2].T).max() <= 0.5 * paper_t.circumradius


def test_an_interrupted_run_leaves_a_readable_file(drive, paper_t, tmp_path):
    starts, file = random_starts(4, 0, 1e-3), tmp_path / "runs.nc"
    starts = np.concatenate([starts, [[1.0, 0.0, 0.0]]])  # off the array: the last one fails
    with pytest.raises(
        InputError, match="poses: puts the part over the edge of the array in run 4"
    ):
        simulate_many(paper_t, drive, starts, save=file, jobs=1, progress=True, tolerance=1e-3)
    with xarray.open_dataset(file, engine="scipy") as data:
        assert data.sizes["run"] == 4
        assert np.all(data.outcome.values == Outcome.REST)
        assert data.start.values == pytest.approx(starts[:4])


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"poses": np.empty((0, 3))}, "poses"),
        ({"poses": [[0, 0]]}, "poses"),
        ({"poses": 0}, "samples"),
        ({"poses": 3, "seed": -1}, "seed"),
        ({"poses": 3, "start_offset": -1.0}, "start_offset"),
        ({"poses": 3, "frames": 3}, "frames"),
        ({"poses": True}, "samples"),
        ({"poses": 3, "seed": 1.5}, "seed"),
        ({"poses": 3, "start_offset": "far"}, "start_offset"),
        ({"poses": 3, "jobs": 0}, "jobs"),
        ({"poses": 3, "jobs": 1.5}, "jobs"),
        ({"poses": 3, "twist": (1.0, 0.0)}, "twist"),
        ({"poses": 3, "save": "no such folder/runs.nc"}, "save"),
    ],
)
def test_bad_arguments_are_named(drive, paper_t, arguments, name):
    with pytest.raises((InputError, TypeError), match=name):
        simulate_many(paper_t, drive, **arguments)


def test_runs_begin_with_a_twist(drive, paper_t):
    starts, twist = random_starts(2, 3, 1e-3), (0.02, 0.0, 1.0)
    runs = simulate_many(paper_t, drive, starts, 0.05, twist=twist, jobs=1)
    for k, start in enumerate(starts):
        alone = simulate(paper_t, drive, start, 0.05, twist=twist)
        assert np.array_equal(runs.finals[k], alone.final_pose)
        assert np.array_equal(runs.replay(k).final_pose, alone.final_pose)
    still = simulate_many(paper_t, drive, starts, 0.05, jobs=1)
    assert np.abs(runs.finals - still.finals).max() > 1e-4
    with pytest.raises(InputError, match="run: must be a whole number"):
        runs.replay(0.5)
