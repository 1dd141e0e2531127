import numpy as np
import pytest

from limitsurf.actuators.density_field import DensityField, push_density
from limitsurf.errors import SolveFailed
from limitsurf.motion.drag import air_film_drag
from limitsurf.motion.field_motion import field_motion
from limitsurf.planning import settling
from limitsurf.planning.settling import settle
from limitsurf.planning.turn_function import turn_function

TOLERANCE = float(np.radians(1.0))


def test_times_are_those_of_single_motions(paper_t, array64):
    """Slow twin: `field_motion` from each start, looked at frame by frame."""
    turn = turn_function(paper_t)
    density, drag = push_density(paper_t, array64), air_film_drag(paper_t, array64)
    phi, offset = np.array([-2.0, 0.3, 1.0, 4.0]), np.array([1e-3, 0.0, -2e-3, 5e-4])
    found = settle(turn, density, drag, phi, offset, TOLERANCE)
    field = DensityField.squeeze(0.0, density)
    gyration = np.sqrt(paper_t.polar_moment / paper_t.area)
    for k in range(len(phi)):
        path = field_motion(paper_t, field, (0, offset[k], phi[k]), drag=drag, frames=4000)
        end = path.final_pose
        assert found.phi[k] == pytest.approx(end[2], abs=1e-6)
        assert found.offset[k] == pytest.approx(end[1], abs=1e-6 * gyration)
        off = np.abs(path.poses[:, 1:] - end[1:]) / [gyration, 1.0]
        last = path.times[np.flatnonzero(off.max(axis=1) > TOLERANCE)[-1]]
        assert found.times[k] == pytest.approx(last, rel=0.01)


def test_starts_do_not_know_of_each_other(paper_t, array64):
    turn = turn_function(paper_t)
    given = push_density(paper_t, array64), air_film_drag(paper_t, array64)
    phi, offset = np.array([0.4, 1.1, 2.2]), np.array([0.0, 1e-3, -1e-3])
    together = settle(turn, *given, phi, offset, TOLERANCE).times
    alone = [
        settle(turn, *given, phi[k : k + 1], offset[k : k + 1], TOLERANCE).times[0]
        for k in range(3)
    ]
    assert together == pytest.approx(alone, rel=5e-3)


def test_a_part_at_rest_takes_no_time(paper_t, array64):
    turn = turn_function(paper_t)
    phi = turn.stable
    medians = np.array([turn.median(float(p))[0] for p in phi])
    given = push_density(paper_t, array64), air_film_drag(paper_t, array64)
    found = settle(turn, *given, phi, -medians, TOLERANCE)
    assert (found.times == 0.0).all()
    flipped = settle(turn, *given, phi + np.pi, medians, TOLERANCE)
    assert (flipped.times == 0.0).all()


def test_a_part_that_does_not_settle_in_time(paper_t, array64, monkeypatch):
    monkeypatch.setattr(settling, "_LONGEST", 0.5)
    given = push_density(paper_t, array64), air_film_drag(paper_t, array64)
    with pytest.raises(SolveFailed, match="have not settled"):
        settle(turn_function(paper_t), *given, np.array([0.3]), np.zeros(1), TOLERANCE)
