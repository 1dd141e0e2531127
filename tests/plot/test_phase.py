"""The phase portrait shows the curves of the objects that it is made from."""

import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.separatrices import separatrices
from limitsurf.planning.turn_function import turn_function
from limitsurf.plot.phase import draw_phase_portrait

OUTLINE = [(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)]


@pytest.fixture(scope="module")
def part():
    return Part(1e-3 * np.array(OUTLINE))


@pytest.fixture(scope="module")
def figure(part):
    return draw_phase_portrait(part, 2.0, paths=5)


def curves(figure, name):
    trace = next(t for t in figure.data if t.name == name)
    x, y = np.array(trace.x, dtype=float), np.array(trace.y, dtype=float)
    ends = np.flatnonzero(np.isnan(x))
    return [c[:, :-1] for c in np.split(np.array([x, y]), ends + 1, axis=1) if c.shape[1]]


def test_separatrices_are_those_of_the_part(figure, part):
    for curve in separatrices(part, 2.0):
        same = [c for c in curves(figure, "separatrix") if c.shape[1] == len(curve.offsets)]
        off = [
            np.abs(c - [np.degrees(curve.orientations), 1e3 * curve.offsets]).max() for c in same
        ]
        assert min(off) < 1e-9


def test_paths_end_at_stable_points(figure, part):
    turn = turn_function(part)
    stable = np.degrees(turn.stable)
    for path in curves(figure, "path"):
        off = np.abs(path[0, -1] - stable) % 180
        assert np.minimum(off, 180 - off).min() < 1e-5
    assert len(curves(figure, "path")) >= 10


def test_equilibria_lie_on_the_median(figure, part):
    (median,) = curves(figure, "median")
    for name in ("stable", "unstable"):
        trace = next(t for t in figure.data if t.name == name)
        assert np.interp(trace.x, *median) == pytest.approx(np.array(trace.y), abs=2e-2)


def test_axes_have_units(figure):
    assert figure.layout.xaxis.title.text == "orientation phi [deg]"
    assert figure.layout.yaxis.title.text == "offset of the line from the centroid [mm]"


def test_bad_counts_are_named(part):
    with pytest.raises(InputError, match="paths"):
        draw_phase_portrait(part, paths=-1)
