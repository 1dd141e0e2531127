"""Equilibria of skewed squeezes beside exact loads, simulation and the critical angle."""

import numpy as np
import pytest

from limitsurf.actuators.density_field import DensityField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.field_motion import field_motion
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.field_errors import FieldErrors
from limitsurf.planning.robustness import robustness
from limitsurf.planning.skewed_equilibria import skewed_equilibria
from limitsurf.planning.turn_function import turn_function
from tests.planning.equilibria_cases import PARTS, turned
from tests.reference_cases import CASES, NAMES, angle_distance


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("skew", [-0.4, -0.05, 0.02, 0.3])
def test_loads_vanish_there(name, skew):
    part = PARTS[name]
    turn, R = turn_function(part), part.circumradius
    field = DensityField.skewed_squeeze(0.0, skew, 1.0)
    found = skewed_equilibria(turn, skew)
    assert len(found.stable) == len(found.unstable)
    for angles, sign in ((found.stable, -1.0), (found.unstable, 1.0)):
        for phi in angles:
            z = turn.median(float(phi))[0]
            load = field.load(part, (0.0, -z, phi)) / (part.area * np.array([1.0, 1.0, R]))
            assert load == pytest.approx(np.zeros(3), abs=1e-13)
            beside = turn.median(float(phi) + 1e-4)[0]
            push = field.load(part, (0.0, -beside, phi + 1e-4))[2]
            assert np.sign(push) == sign


@pytest.mark.parametrize("skew", [-0.2, 0.2])
def test_positive_skew_turns_pushes_clockwise_and_parts_counter_clockwise(skew):
    """Errors of direction count counter-clockwise, the other way."""
    part = Part.from_file("paper_t")
    turn = turn_function(part)
    for place, normal in ((1.0, -0.5 * np.pi), (-1.0, 0.5 * np.pi)):
        push = DensityField.skewed_squeeze(0.0, skew, 1.0)(np.array([[0.0, place]]))[0]
        assert np.arctan2(push[1], push[0]) == pytest.approx(normal - skew)
    (rest,) = skewed_equilibria(turn, skew).stable
    assert np.sign(rest - 0.5 * np.pi) == np.sign(skew)
    found = robustness(plan_alignment(part), FieldErrors(direction=-skew))
    assert found.worst.sets[0] == pytest.approx(np.array([[rest, rest]]), abs=1e-6)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_without_skew_they_are_those_of_the_turn_function(case):
    turn = turn_function(Part(case["vertices"]))
    found = skewed_equilibria(turn, 0.0)
    assert angle_distance(found.stable, turn.stable) < 1e-9
    assert angle_distance(found.unstable, turn.unstable) < 1e-9


@pytest.mark.parametrize("name", PARTS)
def test_none_is_left_beyond_the_critical_angle(name):
    """The last one vanishes at it, for one sense of the skew or the other."""
    turn = turn_function(PARTS[name])
    critical = turn.critical_angle
    left = [len(skewed_equilibria(turn, s * critical * 0.999).stable) for s in (-1.0, 1.0)]
    assert max(left) == 1
    for sense in (-1.0, 1.0):
        assert len(skewed_equilibria(turn, sense * critical * 1.001).stable) == 0


def test_small_skews_shift_by_the_rule_of_thumb():
    """By eps U / (2 J - U), to first order in eps."""
    turn = turn_function(PARTS["bracket"])
    phi, eps = float(turn.stable[0]), 1e-5
    shift = eps * turn.potential(phi) / turn.curvature(phi)
    assert skewed_equilibria(turn, eps).stable[0] - phi == pytest.approx(shift, rel=1e-3)


def test_a_simulated_part_comes_to_rest_there_or_spins():
    part = Part(PARTS["bracket"].polygon, 1.0)
    turn = turn_function(part)
    drag = (part.area, part.area, part.polar_moment)
    for skew in (0.2, -0.2):
        field = DensityField.skewed_squeeze(0.0, skew, 1.0)
        start = (0.0, 0.1, float(turn.stable[0]))
        end = field_motion(part, field, start, mode="quasi-static", drag=drag).final_pose
        stable = skewed_equilibria(turn, skew).stable
        assert turned(2.0 * stable, 2.0 * end[2]).min() < 1e-5
    field = DensityField.skewed_squeeze(0.0, 1.2 * turn.critical_angle, 1.0)
    end = field_motion(part, field, start, 200.0, mode="quasi-static", drag=drag).final_pose
    assert end[2] > start[2] + 2 * np.pi


def test_neutral_parts_and_bad_skews():
    t = 2 * np.pi * np.arange(90) / 90
    disk = turn_function(Part(np.column_stack([np.cos(t), np.sin(t)])))
    for skew in (0.2, -0.2):
        assert len(skewed_equilibria(disk, skew).stable) == 0
    assert disk.neutral
    assert len(skewed_equilibria(disk, 0.0).stable) == 0
    for skew in (1.6, np.nan, "much"):
        with pytest.raises(InputError) as found:
            skewed_equilibria(disk, skew)
        assert found.value.argument == "skew"
