"""Schedules: what runs when, also far away, over many periods, and at their joints."""

import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.motion.schedule import Schedule


@pytest.mark.parametrize("period", [None, 1.0, 0.95, 0.1 + 0.9])
def test_pieces_join_and_say_what_runs(rng, period):
    for _ in range(100):
        times = [0.0, *np.sort(0.9 * rng.random(rng.integers(0, 4)))]
        plan = Schedule(list(zip(times, range(len(times)), strict=True)), period)
        duration = rng.choice([rng.uniform(0.01, 6.0), 3 * (period or 1.0)])
        pieces = plan.pieces(duration)
        begins, ends, runs = zip(*pieces, strict=True)
        assert begins == (0.0, *ends[:-1])
        assert ends[-1] == duration
        for begin, end, drive in zip(begins, ends, runs, strict=True):
            assert begin < end
            assert plan.at(begin) == plan.at(0.5 * (begin + end)) == drive


def test_times_far_away_cost_nothing():
    plan = Schedule([(0.0, "left"), (0.25, "right")], period=0.5)
    assert plan.at(1e12) == "left"
    assert plan.at(1e12 + 0.25) == "right"


def test_nothing_runs_in_no_time():
    assert Schedule([(0.0, "left")]).pieces(0.0) == []


@pytest.mark.parametrize("time", [-1.0, np.nan, np.inf, "now"])
def test_times_without_meaning_are_named(time):
    plan = Schedule([(0.0, "left"), (0.25, "right")], period=0.5)
    with pytest.raises(InputError) as found:
        plan.at(time)
    assert found.value.argument == "time"
    with pytest.raises(InputError) as found:
        plan.pieces(time)
    assert found.value.argument == "duration"


def test_a_period_that_takes_forever_is_named():
    with pytest.raises(InputError, match="period: is too short"):
        Schedule([(0.0, "left")], period=1e-12).pieces(1.0)


@pytest.mark.parametrize("entries", [[1, 2], None, [("a", "b")], [(None, "b")]])
def test_entries_that_are_no_pairs_are_named(entries):
    with pytest.raises(InputError) as found:
        Schedule(entries)
    assert found.value.argument == "schedule"
