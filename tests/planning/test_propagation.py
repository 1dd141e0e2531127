import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.moment_ratio import MomentRatio
from limitsurf.planning.propagation import aligns, joined, propagate
from limitsurf.planning.step_bounds import step_bounds
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, NAMES


def test_joined_intervals_cover_the_same(rng):
    for _ in range(50):
        low = rng.uniform(-9, 9, 5)
        intervals = np.column_stack([low, low + rng.exponential(0.4, 5)])
        found = joined(intervals, np.pi)
        phi = rng.uniform(0, np.pi, 400)
        lifted = phi[:, None] + np.pi * np.arange(-5, 6)
        before, after = (
            ((lifted[..., None] >= s[:, 0]) & (lifted[..., None] <= s[:, 1])).any(axis=(1, 2))
            for s in (intervals, found)
        )
        assert np.array_equal(before, after)
        assert (np.diff(found.ravel()) >= 0.0).all()
        assert ((found[:, 0] >= 0) & (found[:, 0] < np.pi)).all()


@pytest.mark.parametrize("name", ["T", "U_sym", "blob_m3", "longplan_L5"])
def test_single_parts_stay_in_the_sets(name, rng):
    """Slow twin: parts that go through the bounds one by one, here and there in each."""
    plan = plan_alignment(Part(CASES[NAMES.index(name)]["vertices"]))
    ratio = MomentRatio(turn_function(plan.part))
    width = 0.1 * float(np.tan(ratio.turn.critical_angle))
    bounds = [step_bounds(plan.squeeze, ratio, 0.0, width)] * len(plan.lines)
    found = propagate(plan, bounds)
    bands = bounds[0].bands
    phi = rng.uniform(0, np.pi, 300)
    lifted = phi[:, None] + np.pi * np.arange(-1, 2)
    in_band = ((lifted[..., None] > bands[:, 0]) & (lifted[..., None] < bands[:, 1])).any((1, 2))
    phi = phi[~in_band] + plan.lines[0]
    for line, bound, sets in zip(plan.lines, bounds, found.sets, strict=True):
        low, high = (bound.reach(np.column_stack([phi, phi]) - line) + line).T
        phi = low + rng.random(len(phi)) * (high - low)
        turns = np.pi * np.arange(-60, 61)
        lifted = phi[:, None, None] + turns[:, None]
        inside = (lifted >= sets[:, 0] - 1e-9) & (lifted <= sets[:, 1] + 1e-9)
        assert inside.any(axis=(1, 2)).all()


def test_aligned_is_what_the_plan_says():
    plan = plan_alignment(Part(CASES[NAMES.index("blob_m3")]["vertices"]))
    phi = np.linspace(0.0, np.pi, 97)
    ends = np.mod(plan.predict(phi) - plan.final + 1.0, plan.period) - 1.0
    points = np.column_stack([phi, phi])
    assert np.abs(ends).max() < 1e-9
    assert aligns(plan, 0, points)
    last = len(plan.lines) - 1
    alone = [aligns(plan, last, points[k : k + 1]) for k in range(len(phi))]
    line = plan.lines[last]
    ends = plan.squeeze(phi - line) + line - plan.final
    expected = np.abs(np.mod(ends + 1.0, plan.period) - 1.0) < 1e-9
    assert np.array_equal(alone, expected)
    assert 0 < expected.sum() < len(phi)
