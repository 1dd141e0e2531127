import numpy as np
import pytest

from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.field_errors import FieldErrors
from limitsurf.planning.robustness import robustness
from limitsurf.plot.robustness import draw_robustness


def test_bars_hold_the_intervals(paper_t):
    plan = plan_alignment(paper_t)
    found = robustness(plan, [FieldErrors(pixels=0.01, pixels_worst=0.03)] * 2)
    figure = draw_robustness(found)
    covered = sum(float(np.sum(bar.y)) for bar in figure.data if bar.type == "bar")
    sets = [np.diff(s).sum() for what in (found.worst, found.likely) for s in what.sets]
    assert covered == pytest.approx(np.degrees(sum(sets)))
    points = next(trace for trace in figure.data if trace.type == "scatter")
    assert points.y[-1] == pytest.approx(np.degrees(plan.final))
    lost = draw_robustness(robustness(plan, FieldErrors(direction=1.0)))
    assert any(bar.name == "lost" and len(bar.x) for bar in lost.data if bar.type == "bar")


def test_thin_bars_and_points_at_the_border_can_be_seen(paper_t):
    plan = plan_alignment(paper_t)
    figure = draw_robustness(robustness(plan, FieldErrors(direction=1e-6)))
    bars = [bar for bar in figure.data if bar.type == "bar" and len(bar.x)]
    assert all(bar.marker.line.width >= 1 for bar in bars)
    low, high = figure.layout.yaxis.range
    assert low < 0.0 < 180.0 < high
    assert "worst" in figure.layout.xaxis.title.text
