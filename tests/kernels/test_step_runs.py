"""The widest run of steps, against all runs."""

import numpy as np
import pytest
from step_twins import random_steps

from limitsurf.kernels.step_runs import widest_run


def all_runs(breaks, ends, images, period):
    """Yield (first, count, width, span) of every run."""
    k = len(breaks) // 2
    for i in range(k):
        for n in range(1, k + 1):
            span = np.ptp(images[i : i + n])
            yield i, n, period if n == k else ends[i + n - 1] - breaks[i], span


@pytest.mark.parametrize("shuffled", [False, True])
def test_no_run_that_fits_is_wider(shuffled):
    rng = np.random.default_rng(4)
    for _ in range(300):
        k = int(rng.integers(1, 9))
        steps = random_steps(rng, k, bands=bool(rng.integers(2)))
        turn = np.repeat([0.0, np.pi], k)
        images = rng.permutation(steps.images) if shuffled else steps.images
        breaks, ends, images = (np.tile(x, 2) + turn for x in (steps.breaks, steps.ends, images))
        runs = list(all_runs(breaks, ends, images, np.pi))
        in_order = bool(np.all(np.diff(images) >= 0.0))
        for room in [0.0, *rng.uniform(0.0, 4.0, 4), runs[-1][3]]:
            args = (breaks, ends, images, np.pi, room, in_order)
            first, count, smallest, span, more = widest_run(*args)
            assert more == min((run[3] for run in runs if run[3] > room), default=np.inf)
            fitting = [run for run in runs if run[3] <= room]
            widest = max(width for *_, width, _ in fitting)
            least = min(span for *_, width, span in fitting if width == widest)
            assert (first, count, widest, least) in fitting
            assert span == least
            assert smallest == images[first : first + count].min()
        if in_order:  # the queues find the same
            for room in rng.uniform(0.0, 4.0, 4):
                args = (breaks, ends, images, np.pi, room)
                assert widest_run(*args, True) == widest_run(*args, False)


def test_nothing_fits_into_less_than_nothing():
    two = np.array([0.0, np.pi])
    assert widest_run(two, two + np.pi, two, np.pi, -1e-300, True)[1] == 0
