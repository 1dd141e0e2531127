"""Plans whose lines come from a finite set, against every sequence of lines."""

import itertools
import re
from time import perf_counter

import numpy as np
import pytest
from step_twins import all_sequences, ends_of, random_steps

from limitsurf.errors import InputError, NoPlan, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.planning import given_lines
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.given_lines import GivenLines, fewest_lines, margins_of
from limitsurf.planning.plan_lines import plan_lines
from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.planning.stuck_pairs import stuck_pairs
from limitsurf.tolerances import LINE_MARGIN
from tests.reference_cases import CASES, NAMES


def scrambled_steps(rng, k):
    """Return steps with images in no order, for which sets of steps are no runs."""
    steps = random_steps(rng, k)
    return SqueezeFunction(steps.breaks, steps.ends, rng.uniform(0.0, np.pi, k), np.pi)


def some_steps(rng, n):
    k = int(rng.integers(1, 5))
    return scrambled_steps(rng, k) if n % 3 == 2 else random_steps(rng, k, bands=n % 3 == 1)


def test_plans_are_as_short_as_the_shortest_of_all_sequences():
    rng = np.random.default_rng(1)
    lengths = []
    for n in range(150):
        squeeze, lines = some_steps(rng, n), rng.uniform(0.0, np.pi, int(rng.integers(1, 4)))
        margin = LINE_MARGIN if n % 2 else 0.05
        sequences = all_sequences(squeeze, lines, margin, 5)
        try:
            plan = plan_lines(squeeze, lines=lines, min_margin=margin)
        except NoPlan:
            assert not sequences
            lengths.append(0)
            continue
        used = tuple(int(np.argmin(np.abs(lines - line))) for line in plan.lines)
        assert np.array_equal(lines[list(used)], plan.lines)
        assert not sequences or used in sequences
        assert bool(sequences) == (len(plan.lines) <= 5)
        lengths.append(len(plan.lines))
    assert min(lengths.count(n) for n in (0, 1, 2, 3)) > 5


def test_no_sequence_of_the_same_length_has_a_larger_margin():
    rng = np.random.default_rng(2)
    checked = 0
    for n in range(150):
        squeeze, lines = some_steps(rng, n), rng.uniform(0.0, np.pi, 3)
        try:
            plan = plan_lines(squeeze, lines=lines)
        except NoPlan:
            continue
        length, margin = len(plan.lines), plan.least_margin
        if 1 < length < 5 and margin < 0.5:
            assert len(all_sequences(squeeze, lines, margin - 1e-12, length)[0]) == length
            assert all_sequences(squeeze, lines, margin + 1e-12, length) == []
            checked += 1
    assert checked > 30


def test_existence_is_what_pairs_say():
    """Where no image lies close to the end of a step, pairs decide whether there is a plan."""
    rng = np.random.default_rng(3)
    verdicts = []
    for n in range(300):
        k = int(rng.integers(2, 6))
        squeeze = scrambled_steps(rng, k) if n % 2 else random_steps(rng, k)
        given = GivenLines(squeeze, rng.uniform(0.0, np.pi, 2))
        found = fewest_lines(given, LINE_MARGIN, given.targets(None, 0.0)) is not None
        assert found != stuck_pairs(given, LINE_MARGIN).any()
        verdicts.append(found)
    assert 30 < sum(verdicts) < 270


def test_all_lines_together_come_close_to_free_lines():
    """On a fine grid the plan is as short as with free lines, and its margin nearly as large."""
    rng = np.random.default_rng(4)
    for _ in range(10):
        squeeze = random_steps(rng, 3)
        free = plan_lines(squeeze)
        if free.least_margin < 0.1:
            continue
        plan = plan_lines(squeeze, lines=45)
        assert len(plan.lines) == len(free.lines)
        assert plan.least_margin <= free.least_margin
        if len(plan.lines) > 1:
            assert plan.least_margin > free.least_margin - np.pi / 45


def test_margins_are_distances_to_what_could_come_astray():
    rng = np.random.default_rng(5)
    for n in range(60):
        given = GivenLines(some_steps(rng, n), rng.uniform(0.0, np.pi, 3))
        nodes = fewest_lines(given, LINE_MARGIN, given.targets(None, 0.0))
        if nodes is None:
            continue
        assert len(margins_of(given, nodes)) == len(nodes)
        margin = float(margins_of(given, nodes).min())
        if np.isfinite(margin):
            targets = [(nodes[-1][0], nodes[-1][1].bit_length() - 1)]
            assert fewest_lines(given, margin, targets) is not None


def test_errors_within_the_margin_do_not_matter():
    """Every line but the first may be off by the margin, relative to the one before."""
    rng = np.random.default_rng(6)
    starts = np.linspace(0.0, np.pi, 300)
    carried_out = 0
    for n in range(90):
        squeeze = some_steps(rng, n)
        try:
            plan = plan_lines(squeeze, lines=int(rng.integers(2, 9)))
        except NoPlan:
            continue
        if len(plan.lines) == 1:
            continue
        for _ in range(5):
            relative = 0.999 * plan.least_margin * rng.choice([-1.0, 1.0], len(plan.lines))
            off = ends_of(plan, np.cumsum(relative), starts, rng)
            assert np.abs(off).max() < 1e-9
        carried_out += 1
    assert carried_out > 30


def test_goal():
    t = Part.from_file("paper_t")
    for goal in (0.0, np.pi / 4, 1.5 * np.pi):
        plan = plan_alignment(t, lines=8, goal=goal)
        assert np.cos(2 * (plan.final - goal)) == pytest.approx(1.0)
        assert np.cos(2 * (plan.predict([0.1, 1.9]) - goal)) == pytest.approx([1.0, 1.0])
    with pytest.raises(NoPlan, match=r"goal: .* 22\.5.*, 45\.0") as caught:
        plan_alignment(t, lines=8, goal=0.75)
    assert caught.value.plan.final == pytest.approx(np.pi / 4)
    named = [
        float(word) for word in str(caught.value).split("deg: ")[1].split(" deg")[0].split(",")
    ]
    assert len(named) == 8
    for final in named:  # what the message says can be asked for
        plan_alignment(t, lines=8, goal=np.radians(final))


def test_the_error_names_a_pair_that_never_merges_and_a_line_that_helps():
    """With lines at 0 and 90 deg only, mirror images of a symmetric part never merge."""
    part = Part(CASES[NAMES.index("U_sym")]["vertices"])
    squeeze, crossed = plan_alignment(part).squeeze, np.array([0.0, np.pi / 2])
    with pytest.raises(NoPlan, match=r"never merge.*mirror images.*add a line") as caught:
        plan_alignment(part, lines=crossed)
    message = str(caught.value)
    named = re.search(r"orientations (\S+) and (\S+) deg", message).groups()
    pair = np.radians([float(angle) for angle in named])
    for order in itertools.product(crossed, repeat=5):
        phi = pair
        for line in order:
            phi = squeeze(phi - line) + line
        assert abs(np.sin(phi[0] - phi[1])) > 1e-3
    line, length = re.search(r"such as (\S+) deg, with which (\d+) squeezes", message).groups()
    plan = plan_alignment(part, lines=[*crossed, np.radians(float(line))])
    assert len(plan.lines) == int(length)


def mirrored_steps():
    """Return steps with an axis of symmetry at 0 and none of its images on it."""
    breaks = np.array([0.0, 1.2, np.pi - 1.2])
    ends = np.array([1.2, np.pi - 1.2, np.pi])
    return SqueezeFunction(breaks, ends, np.array([0.5, np.pi / 2, np.pi - 0.5]), np.pi)


def test_mirror_images_are_named():
    squeeze = mirrored_steps()
    with pytest.raises(NoPlan, match=r"28\.65 and 151\.35 deg .* mirror images"):
        plan_lines(squeeze, lines=[0.0, np.pi / 2])
    with pytest.raises(NoPlan) as caught:  # the steps have another axis, but not the lines
        plan_lines(squeeze, lines=[0.0, 0.001])
    assert "mirror" not in str(caught.value)


def test_min_margin_says_what_the_lines_can_reach():
    t = Part.from_file("paper_t")
    with pytest.raises(NoPlan, match=r"min_margin: .* these lines .* 33\.67 deg") as caught:
        plan_alignment(t, lines=8, min_margin=1.0)
    plan = caught.value.plan
    assert plan.least_margin == caught.value.reachable_margin
    assert (
        plan_alignment(t, lines=8, min_margin=plan.least_margin).least_margin == plan.least_margin
    )
    with pytest.raises(NoPlan, match=r"min_margin: .* ends at the goal; at most 33\.67"):
        plan_alignment(t, lines=8, min_margin=1.0, goal=0.0)


def test_a_search_that_gives_up_says_so(monkeypatch):
    rng = np.random.default_rng(8)
    squeeze = scrambled_steps(rng, 5)
    monkeypatch.setattr(given_lines, "_MOST_STATES", 12)
    with pytest.raises(SolveFailed, match="first 12 sets of steps"):
        plan_lines(squeeze, lines=4, min_margin=0.01)


def test_one_step_needs_one_line():
    plan = plan_lines(random_steps(np.random.default_rng(0), 1), lines=[2.0, 0.3])
    assert len(plan.lines) == 1
    assert plan.least_margin == np.inf


def test_many_lines_are_searched_or_refused():
    squeeze = SqueezeFunction(
        np.array([0.0, 1.0]), np.array([1.0, np.pi]), np.array([0.5, 2.0]), np.pi
    )
    begin = perf_counter()
    plan = plan_lines(squeeze, lines=200)
    assert perf_counter() - begin < 5.0  # 0.5 s
    assert plan.least_margin <= plan_lines(squeeze).least_margin
    for lines in (100_000, np.linspace(0.0, 3.0, 1001)):
        with pytest.raises(InputError, match="round") as found:
            plan_lines(squeeze, lines=lines)
        assert found.value.argument == "lines"


@pytest.mark.parametrize("k", [1, 7, 8, 9, 63, 64, 65, 130])
def test_sets_of_steps_as_bits_and_back(k, rng):
    rows = rng.random((5, k)) < 0.5
    sets = given_lines._as_bits(rows)
    assert sets == [sum(1 << int(i) for i in np.flatnonzero(row)) for row in rows]
    assert np.array_equal(given_lines._as_rows(sets, k), rows)
