"""Plans from bare step functions, with lines of any angle."""

import math
from time import perf_counter

import numpy as np
import pytest
from step_twins import ends_of, naive_chain, random_steps, shortest_by_sets

from limitsurf.errors import InputError, NoPlan
from limitsurf.planning.free_lines import _room
from limitsurf.planning.plan_lines import plan_lines
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.tolerances import LINE_MARGIN


def length_or_none(squeeze):
    try:
        return len(plan_lines(squeeze).lines)
    except NoPlan:
        return None


def test_plans_are_as_short_as_breadth_first_search_finds():
    """2000 random step functions, a third with bands between the steps."""
    rng = np.random.default_rng(1)
    found = []
    for n in range(2000):
        k = int(rng.integers(1, 7))
        squeeze = random_steps(rng, k, bands=n % 3 == 1, inside=n % 2 == 0)
        length = length_or_none(squeeze)
        assert length == shortest_by_sets(squeeze)
        assert length is None or n % 3 == 1 or length <= 2 * k - 1
        found.append(length)
    assert None in found
    assert max(length for length in found if length) >= 8


@pytest.mark.parametrize("modulus", [np.pi, 2 * np.pi])
def test_plans_align_within_their_margins_and_no_more(modulus):
    rng = np.random.default_rng(2)
    starts = np.linspace(0.0, modulus, 400)
    broken = 0
    for n in range(120):
        squeeze = random_steps(rng, int(rng.integers(2, 7)), bands=n % 3 == 1, modulus=modulus)
        try:
            plan = plan_lines(squeeze)
        except NoPlan:
            continue
        k = len(plan.lines)
        for share in (0.0, 0.999):
            for _ in range(6):
                relative = share * plan.least_margin * rng.choice([-1.0, 1.0], k)
                errors = np.cumsum(relative) if k > 1 else np.zeros(1)
                assert np.abs(ends_of(plan, errors, starts, rng)).max() < 1e-9
        if k > 1:
            weakest = int(np.argmin(plan.margins))
            for sign in (-1.0, 1.0):
                errors = np.zeros(k)
                errors[weakest:] = sign * 1.001 * plan.least_margin
                broken += np.abs(ends_of(plan, errors, starts, rng)).max() > 1e-6
    assert broken > 40


def test_no_plan_of_the_same_length_has_a_larger_margin():
    """The slow twin asks the naive planner for every gap that any plan could have."""
    rng = np.random.default_rng(3)
    for n in range(40):
        squeeze = random_steps(rng, 4, bands=n % 2 == 1, inside=n % 4 < 2)
        chain = naive_chain(squeeze, 2 * LINE_MARGIN)
        if chain is None or len(chain) == 1:
            continue
        plan = plan_lines(squeeze)
        assert len(plan.lines) == len(chain)
        turn = np.repeat([0.0, np.pi], 4)
        breaks, ends, images = (
            np.tile(x, 2) + turn for x in (squeeze.breaks, squeeze.ends, squeeze.images)
        )
        widths, spans = np.subtract.outer(ends, breaks), np.subtract.outer(images, images)
        gaps = np.unique(np.subtract.outer(np.unique(widths), np.unique(spans)))
        possible = [
            g for g in gaps[gaps > 0] if len(naive_chain(squeeze, g - 1e-12) or ()) == len(chain)
        ]
        assert 2 * plan.least_margin == pytest.approx(max(possible), abs=1e-11)


def test_the_reachable_margin_is_reachable_and_no_more():
    rng = np.random.default_rng(5)
    longer = 0
    for _ in range(60):
        squeeze = random_steps(rng, 5)
        with pytest.raises(NoPlan, match=r"min_margin: .* at most") as caught:
            plan_lines(squeeze, min_margin=3.0)
        reachable, plan = caught.value.reachable_margin, caught.value.plan
        assert plan.least_margin == reachable
        again = plan_lines(squeeze, min_margin=reachable)
        assert again.least_margin == reachable
        assert len(again.lines) == len(plan.lines)
        if len(plan.lines) > 1:
            with pytest.raises(NoPlan):
                plan_lines(squeeze, min_margin=float(np.nextafter(reachable, 9.0)))
        longer += len(plan.lines) > len(plan_lines(squeeze).lines)
    assert longer > 5


def test_images_out_of_order_and_outside_their_steps():
    """The plan has to be right, if perhaps not the shortest."""
    rng = np.random.default_rng(6)
    starts = np.linspace(0.0, 2 * np.pi, 300)
    planned = 0
    for _ in range(200):
        steps = random_steps(rng, 5, period=2 * np.pi, modulus=2 * np.pi)
        images = steps.images + rng.normal(0.0, 1.0, 5)
        squeeze = SqueezeFunction(steps.breaks, steps.ends, images, 2 * np.pi, 2 * np.pi)
        try:
            plan = plan_lines(squeeze)
        except NoPlan:
            continue
        planned += not np.all(np.diff(images) > 0)
        errors = 0.999 * np.cumsum(
            np.minimum(plan.margins, plan.least_margin) if len(plan.lines) > 1 else [0.0]
        )
        assert np.abs(ends_of(plan, errors, starts, rng)).max() < 1e-9
        assert len(plan.lines) >= shortest_by_sets(squeeze)
    assert planned > 50


def test_goal_turns_the_whole_plan():
    rng = np.random.default_rng(7)
    squeeze = random_steps(rng, 4, period=np.pi / 2)
    free = plan_lines(squeeze)
    for goal in (0.0, 1.0, -7.0):
        plan = plan_lines(squeeze, goal=goal)
        assert np.cos(4 * (plan.final - goal)) == pytest.approx(1.0)
        assert np.cos(4 * (plan.predict(0.3) - goal)) == pytest.approx(1.0)
        assert np.array_equal(plan.margins, free.margins)


def test_rounding_to_a_grid_is_safe_below_the_margin():
    """Lines rounded to multiples of pi / N err by pi / 2 N each, two of them by pi / N."""
    rng = np.random.default_rng(8)
    starts = np.linspace(0.0, np.pi, 400)
    fine = 0
    for _ in range(100):
        plan = plan_lines(random_steps(rng, int(rng.integers(2, 6))))
        if len(plan.lines) == 1:
            continue
        n = int(np.pi / plan.least_margin) + 1
        if n > 2000:
            continue
        rounded = np.round(plan.lines * n / np.pi) * np.pi / n
        assert np.abs(ends_of(plan, rounded - plan.lines, starts, rng)).max() < 1e-9
        fine += 1
    assert fine > 40


def test_nothing_to_turn_and_bad_input():
    empty = np.empty(0)
    with pytest.raises(NoPlan, match="no steps"):
        plan_lines(SqueezeFunction(empty, empty, empty, np.pi))
    squeeze = random_steps(np.random.default_rng(9), 3)
    for name, bad in (
        ("min_margin", -1.0), ("min_margin", np.nan), ("min_margin", "wide"), ("goal", np.inf),
        ("goal", "up"), ("lines", []), ("lines", [0.0, np.nan]), ("lines", 0), ("lines", 2.5),
        ("lines", [[0.0, 1.0]]), ("lines", [0.0, 1.0, np.pi]), ("lines", True), ("lines", "all"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=name):
            plan_lines(squeeze, **{name: bad})


def test_bands_may_leave_no_plan():
    breaks, images = np.array([0.0, 1.5]), np.array([0.7, 2.2])
    squeeze = SqueezeFunction(breaks, breaks + 0.1, images, np.pi)
    with pytest.raises(
        NoPlan, match=r"has 5\.7.* of 180 deg; from the gaps .*push-squeeze"
    ) as caught:
        plan_lines(squeeze)
    assert caught.value.reachable_margin == 0.0
    assert caught.value.plan is None


@pytest.mark.parametrize("off", [1e-8, 1e-7, 1e-4])
def test_steps_that_nearly_repeat_are_planned_at_once(off):
    breaks = np.array([0.3, 0.3 + np.pi / 2 + off])
    ends = np.append(breaks[1:], breaks[0] + np.pi)
    squeeze = SqueezeFunction(breaks, ends, 0.5 * (breaks + ends), np.pi)
    begin = perf_counter()
    plan = plan_lines(squeeze)
    assert perf_counter() - begin < 1.0
    assert len(plan.lines) == 2
    assert plan.least_margin == pytest.approx(0.5 * off, rel=1e-6)


def test_room_is_the_largest_float_that_leaves_the_gap(rng):
    for _ in range(3000):
        width = rng.uniform(0.0, 3.0) * 10.0 ** -rng.integers(0, 9)
        gap = width - rng.choice([-1.0, 1.0]) * 10.0 ** -rng.uniform(0, 18)
        gap = rng.choice([gap, rng.uniform(0.0, 3.0), width, math.nextafter(width, 0.0)])
        if gap > 0.0:
            room = _room(width, gap)
            assert width - room >= gap
            assert width - math.nextafter(room, math.inf) < gap


def test_steps_that_all_but_repeat_are_said_to():
    off = 1.8e-9  # more than steps that are one, less than the margins of a plan
    breaks = np.array([0.3, 0.3 + np.pi / 2 + off])
    ends = np.append(breaks[1:], breaks[0] + np.pi)
    with pytest.raises(NoPlan, match="every 90 deg the steps repeat") as found:
        plan_lines(SqueezeFunction(breaks, ends, 0.5 * (breaks + ends), np.pi))
    assert found.value.reachable_margin == 0.0
