"""Limit curves are drawn as they are: the curve's own corners, in newtons, at one scale."""

import numpy as np
import pytest
import shapely

from limitsurf import plot
from limitsurf.contacts.coulomb import coulomb_contact
from limitsurf.contacts.wheel import Wheel
from limitsurf.errors import InputError
from limitsurf.sets.sections import limit_curve, section


def drawn(trace):
    return np.column_stack([trace.x, trace.y])


def test_the_wheels_of_figure_7():
    """The driven curve is the passive one, shifted by torque / radius along the wheel."""
    wheels = [
        Wheel([0, 0], [0, 1], 0.01, 2.0, 0.5, bearing_friction=0.1, torque=t) for t in (0, 0.004)
    ]
    figure = plot.draw_limit_curve(*[w.limit_curve() for w in wheels], names=("passive", "driven"))
    passive, driven, origin = figure.data
    assert [t.name for t in figure.data] == ["passive", "driven", "origin"]
    assert drawn(driven) == pytest.approx(drawn(passive) + np.array([0.0, 0.4]), abs=1e-12)
    assert np.ptp(drawn(passive), axis=0) == pytest.approx([2.0, 0.2])
    assert drawn(passive)[0] == pytest.approx(drawn(passive)[-1])  # closed
    assert drawn(origin).tolist() == [[0.0, 0.0]]
    layout = figure.layout
    assert layout.xaxis.title.text == "F<sub>x</sub> [N]"
    assert layout.yaxis.title.text == "F<sub>y</sub> [N]"
    assert layout.yaxis.scaleanchor == "x"


def test_thin_and_empty_curves():
    tilted = coulomb_contact([1.0, 0.0], 2.0)  # M = fy: at M = 0 only fx is left
    curves = (limit_curve(tilted), shapely.Point(1.0, 2.0), section(tilted, [1, 0, 0], 5.0))
    segment, point, empty, _ = plot.draw_limit_curve(*curves).data
    assert np.sort(drawn(segment), axis=0) == pytest.approx(np.array([[-2.0, 0.0], [2.0, 0.0]]))
    assert (segment.mode, point.mode) == ("lines", "markers")
    assert drawn(point).tolist() == [[1.0, 2.0]]
    assert len(empty.x) == 0


def test_pieces_and_holes_are_separate_lines():
    ring = shapely.Point(0, 0).buffer(2.0).difference(shapely.Point(0, 0).buffer(1.0))
    both = shapely.MultiPolygon([ring, shapely.box(5, 5, 6, 6)])
    trace = plot.draw_limit_curve(both).data[0]
    assert np.isnan(np.array(trace.x)).sum() == 2
    assert trace.showlegend is False


def test_labels_and_nothing_to_draw():
    figure = plot.draw_limit_curve(shapely.box(0, 0, 1, 1), x="F [N]", y="M [N m]", title="cut")
    assert (figure.layout.yaxis.title.text, figure.layout.title.text) == ("M [N m]", "cut")
    with pytest.raises(InputError, match="curves"):
        plot.draw_limit_curve()
