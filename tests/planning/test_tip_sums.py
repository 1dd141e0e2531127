import numpy as np
import pytest
import shapely
from shapely.ops import split

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.planning.tip_sums import poses_near_rest, tip_sums
from limitsurf.planning.turn_function import turn_function


def test_sums_over_tips_by_shapely(paper_t, array64):
    """Slow twin: every site of the array, one by one, with its vector products written out."""
    line, turn = 0.4, turn_function(paper_t)
    activation = squeeze_activation(array64, line)
    poses = poses_near_rest(turn, line, 2e-4, 1e-3, 2)
    x0, y0 = array64.first_site
    j, i = np.meshgrid(np.arange(128), np.arange(128))
    spots = np.stack([x0 + 1e-4 * j, y0 + 1e-4 * i], axis=-1)[activation.running]
    push = array64.site_directions[activation.running]
    for row, found in zip(poses, tip_sums(activation, paper_t, poses), strict=True):
        inside = shapely.contains_xy(paper_t.at(row[1:4]), spots[:, 0], spots[:, 1])
        p, f = spots[inside], push[inside]
        arm = p - (row[1:3] + row[4:6])
        moment = (arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum()
        height = np.cos(line) * p[:, 1] - np.sin(line) * p[:, 0]
        work = -(height * (np.cos(line) * f[:, 1] - np.sin(line) * f[:, 0])).sum()
        assert found[4] == inside.sum()
        assert found[0] == pytest.approx(moment, abs=1e-12 * inside.sum())
        assert found[1] == pytest.approx(work, rel=1e-12)


def test_arms_end_in_the_middle_of_the_chord(paper_t):
    """Without pitch the line is the median, and by shapely its chord has its middle there."""
    turn, line = turn_function(paper_t), 2.0
    along, normal = np.array([np.cos(line), np.sin(line)]), np.array([-np.sin(line), np.cos(line)])
    for phi, x, y, theta, *arm in poses_near_rest(turn, line, 0.0, 1e-3, 1):
        outline, middle = paper_t.at((x, y, theta)), np.array([x, y]) + arm
        assert theta == pytest.approx(phi + line)
        assert abs(middle @ normal) < 1e-12
        whole = shapely.LineString([-0.1 * along, 0.1 * along])
        chord = shapely.get_coordinates(shapely.intersection(whole, outline).centroid)
        assert np.abs(chord - middle).max() < 1e-12
        halves = split(outline, whole).geoms
        left = sum(g.area for g in halves if shapely.get_coordinates(g.centroid)[0] @ normal > 0)
        assert left == pytest.approx(paper_t.area / 2, rel=1e-9)
