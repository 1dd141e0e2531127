"""The largest gap is found exactly, whatever plans the search returns on the way."""

import numpy as np
import pytest

from limitsurf.planning.largest_margin import with_largest_gap


@pytest.mark.parametrize("skips", [False, True])
def test_the_end_is_exact(skips):
    rng = np.random.default_rng(0)
    for _ in range(200):
        gaps = np.sort(np.exp(rng.uniform(-20.0, 1.0, int(rng.integers(1, 30)))))
        feasible = gaps[: int(rng.integers(1, len(gaps) + 1))]
        asked = []

        def search(gap, gaps=gaps, feasible=feasible, asked=asked):
            asked.append(gap)
            enough = feasible[feasible >= gap]
            below = gaps[gaps < gap].max() if skips else float(np.nextafter(gap, -np.inf))
            return (rng.choice(enough) if len(enough) else None), below

        found = with_largest_gap(feasible[0], float, search, np.pi)
        assert found == feasible[-1]
        assert len(asked) <= (2 * len(gaps) if skips else 100)


def test_a_plan_of_one_line_is_left_alone():
    def search(gap):
        raise AssertionError

    assert with_largest_gap("one line", lambda _: np.inf, search, np.pi) == "one line"
