"""What the picture of equilibria shows."""

import numpy as np
import pytest

from limitsurf.actuators.density_field import DensityField
from limitsurf.actuators.radial_density import RadialField
from limitsurf.geometry.part import Part
from limitsurf.planning.equilibria import equilibria
from limitsurf.plot.equilibria import draw_equilibria
from tests.planning.equilibria_cases import FIELDS, PARTS

PART = PARTS["bracket"]


def traces(figure, name):
    return [trace for trace in figure.data if trace.name == name]


def test_parts_are_drawn_where_they_rest():
    field = FIELDS["radial and squeeze"]
    found = equilibria(PART, field)
    figure = draw_equilibria(PART, field)
    assert figure.layout.xaxis.title.text == "x [m]"
    assert figure.layout.yaxis.title.text == "y [m]"
    for name, poses, fill in (("stable", found.stable, "toself"), ("saddle", found.saddles, None)):
        drawn = traces(figure, name)
        assert len(drawn) == len(poses)
        for trace, pose in zip(drawn, poses, strict=True):
            assert trace.fill == fill
            bounds = np.array(PART.at(pose).bounds)
            assert np.nanmin(trace.x) == pytest.approx(bounds[0])
            assert np.nanmax(trace.y) == pytest.approx(bounds[3])
    assert traces(figure, "saddle")[0].line.dash == "dot"


def test_arrows_point_with_the_field():
    field = FIELDS["feeder"]
    (arrows,) = traces(draw_equilibria(PART, field), "field")
    push = field(np.column_stack([arrows.x, arrows.y]))
    way = np.radians(90.0 - np.array(arrows.marker.angle))  # angles count clockwise from up
    unit = push / np.hypot(*push.T)[:, None]
    assert np.column_stack([np.cos(way), np.sin(way)]) == pytest.approx(unit, abs=1e-12)
    assert len(push) > 50


def test_poses_along_a_line_stand_side_by_side():
    figure = draw_equilibria(PART, DensityField.squeeze(0.0, 1.0))
    (marks,) = traces(figure, "centre of mass")
    assert np.diff(np.sort(marks.x)) == pytest.approx(np.full(3, 2.2 * PART.circumradius))
    assert "side by side" in figure.layout.title.text


def test_no_equilibrium_says_why():
    figure = draw_equilibria(PART, DensityField.uniform(0.0, 1.0))
    assert "pushed away" in figure.layout.title.text
    assert not traces(figure, "stable")
    (arrows,) = traces(figure, "field")
    assert np.array(arrows.marker.angle) == pytest.approx(np.full(len(arrows.x), 90.0))
    assert len(arrows.x) > 50


def test_neutral_part_is_called_so():
    figure = draw_equilibria(PART, RadialField(2.0, (0.5, -1.0)))
    assert "every orientation" in figure.layout.title.text
    assert len(traces(figure, "stable")) == 1


def test_small_parts_are_drawn_in_micrometres():
    part = Part(1e-6 * np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)]))
    field = DensityField.squeeze(0.0, 1.0)
    figure = draw_equilibria(part, field)
    assert figure.layout.xaxis.title.text == "x [um]"
    pose = equilibria(part, field).stable[0]
    drawn = traces(figure, "stable")[0]
    height = np.ptp(np.array(part.at(pose).bounds)[1::2])
    assert np.nanmax(drawn.y) - np.nanmin(drawn.y) == pytest.approx(1e6 * height)
