"""Pictures of step functions, plans and diameter functions show their numbers."""

import numpy as np
import pytest
from step_twins import random_steps

from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.diameter_function import diameter_function
from limitsurf.planning.plan_lines import plan_lines
from limitsurf.planning.squeeze_function import squeeze_function
from limitsurf.planning.turn_function import turn_function
from limitsurf.plot.diameter import draw_diameter_function
from limitsurf.plot.squeeze import draw_plan, draw_squeeze_function


def trace(figure, name):
    return next(t for t in figure.data if t.name == name)


def segments(figure, name):
    found = trace(figure, name)
    x, y = (np.array(v, dtype=float).reshape(-1, 3) for v in (found.x, found.y))
    assert np.array_equal(y[:, 0], y[:, 1])
    return x[:, 0], x[:, 1], y[:, 0]


@pytest.mark.parametrize("modulus", [np.pi, 2 * np.pi])
def test_steps_and_the_gaps_between_them(modulus):
    squeeze = random_steps(np.random.default_rng(0), 4, bands=True, period=modulus, modulus=modulus)
    figure = draw_squeeze_function(squeeze)
    left, right, image = segments(figure, "squeeze function s")
    middle = np.radians((left + right) / 2)
    assert np.degrees(squeeze(middle)) == pytest.approx(image)
    a, b, either = segments(figure, "either of two")
    gaps = np.sum(b - a) / 2
    assert np.sum(right - left) + gaps == pytest.approx(np.degrees(modulus))
    assert np.unique(np.round(either, 6)) == pytest.approx(np.unique(np.round(image, 6)))
    assert figure.layout.xaxis.range == (0, pytest.approx(np.degrees(modulus)))
    closed = draw_squeeze_function(random_steps(np.random.default_rng(0), 4))
    assert all(t.name != "either of two" for t in closed.data)


@pytest.mark.parametrize("modulus", [np.pi, 2 * np.pi])
def test_plan_shows_its_margins(modulus):
    plan = plan_lines(random_steps(np.random.default_rng(1), 4, period=modulus, modulus=modulus))
    assert len(plan.lines) > 1
    figure = draw_plan(plan)
    bars = trace(figure, "margin of the next line")
    for k, margin in enumerate(plan.margins[1:], 1):
        here = np.array(bars.x) == k
        assert np.array(bars.error_y.array)[here] == pytest.approx(np.degrees(margin))
    ways = trace(figure, "orientations")
    x, y = (np.array(v, dtype=float).reshape(-1, 3)[:, :2] for v in (ways.x, ways.y))
    low, high = np.radians(figure.layout.yaxis.range)
    assert low < 0.0 < modulus < high
    for k, line in enumerate(plan.lines):
        before, after = np.radians(y[x[:, 0] == k]).T
        expected = plan.squeeze.follow(before - line) + line
        assert after == pytest.approx(expected)
        shown = np.mod(after[(after >= 0.0) & (after < modulus)], modulus)
        assert set(np.round(np.mod(after, modulus), 6)) == set(np.round(shown, 6))
    ends = np.radians(y[x[:, 0] == len(plan.lines) - 1][:, 1])
    assert np.mod(ends, modulus) == pytest.approx(np.full(len(ends), plan.final))
    assert np.sum(x[:, 0] == 0) >= round(np.degrees(modulus))


def test_plan_wraps_around_at_the_ends():
    """No way climbs over the whole picture where it only passes its border."""
    plan = plan_alignment(Part.from_file("longplan_L5"))
    ways = trace(draw_plan(plan), "orientations")
    y = np.array(ways.y, dtype=float).reshape(-1, 3)[:, :2]
    assert np.abs(np.diff(y)).max() < 30.0
    assert y.min() < 0.0
    assert y.max() > 180.0


def test_an_image_at_the_border_is_drawn_at_zero():
    turns = 2.0 * np.pi * np.arange(20) / 20
    part = Part(1e-3 * np.column_stack([np.cos(turns), np.sin(turns)]))
    figure = draw_squeeze_function(squeeze_function(turn_function(part)))
    assert np.unique(segments(figure, "squeeze function s")[2]) == pytest.approx(
        18.0 * np.arange(10)
    )


def test_diameter_function():
    diameter = diameter_function(Part([(0, 0), (2e-3, 0), (2e-3, 1e-3), (0, 1e-3)]))
    figure = draw_diameter_function(diameter)
    assert np.array(trace(figure, "stable").x) == pytest.approx([0.0, 90.0])
    assert np.array(trace(figure, "stable").y) == pytest.approx([1.0, 2.0])
    assert np.max(trace(figure, "diameter function").y) == pytest.approx(np.sqrt(5.0), abs=1e-4)
    assert figure.layout.yaxis.title.text == "distance of the jaws [mm]"
