"""One stable pose in a radial plus a weak constant field: theory, and simulation."""

import numpy as np
import pytest
from scipy.optimize import minimize

from limitsurf.actuators.radial_density import RadialField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.equilibria import equilibria
from limitsurf.planning.universal_feeder import feeder_field, feeder_range, pivot_point
from tests.planning.equilibria_cases import PARTS, settled, turned

T = Part([(0, 0), (1, 0), (1, 3), (2.5, 3), (2.5, 4), (-1.5, 4), (-1.5, 3), (0, 3)])
FED = {"bracket": PARTS["bracket"], "plate": PARTS["plate with a hole"], "T": T}


def gon(n):
    t = 2 * np.pi * np.arange(n) / n
    return Part(np.column_stack([np.cos(t), np.sin(t)]))


def test_the_pivot_minimises_the_mean_distance():
    for part in PARTS.values():
        pivot, radial = pivot_point(part), RadialField(1.0)

        def distance(c, part=part, radial=radial):
            return float(radial.potential(part, (-c[0], -c[1], 0.0)))

        slow = minimize(distance, np.zeros(2), method="Nelder-Mead", options={"xatol": 1e-9})
        assert pivot == pytest.approx(slow.x, abs=1e-6)


def test_weak_fields_hang_the_centroid_below_the_pivot():
    """As a pendulum: the arm from pivot to centroid points where the constant field pushes."""
    part, angle = PARTS["bracket"], 0.7
    pivot = pivot_point(part)
    found = equilibria(part, feeder_field(1.0, 1e-6, angle))
    (stable,) = found.stable
    arm = np.arctan2(-pivot[1], -pivot[0])
    assert turned(stable[2] + arm, angle) < 1e-5
    assert turned(found.saddles[0, 2] + arm, angle + np.pi) < 1e-5


@pytest.mark.parametrize("name", ["bracket", "plate", pytest.param("T", marks=pytest.mark.slow)])
def test_counts_change_at_the_limit(name):
    part = FED[name]
    found = feeder_range(part)
    assert found.proven
    assert 0.05 < found.ratio < found.limit < found.ratio + 1e-3
    assert len(equilibria(part, feeder_field(1.0, 0.999 * found.ratio)).stable) == 1
    assert len(equilibria(part, feeder_field(1.0, 1.002 * found.limit)).stable) == 2
    assert all(count == 1 for ratio, count in found.counts.items() if ratio <= found.ratio)


def reach_one_pose(part, ratio, starts, rng):
    """Check that random starts, anywhere within three circumradii, come to one pose."""
    field = feeder_field(1.0, ratio, 0.3, (0.4, -0.2))
    (stable,) = equilibria(part, field).stable
    q = rng.uniform(-1.0, 1.0, (starts, 3)) * [3.0 * part.circumradius] * 1.0
    q[:, 2] = rng.uniform(0.0, 2 * np.pi, starts)
    ends = settled(part, field, q, 4000.0)
    assert np.abs(ends[:, :2] - stable[:2]).max() < 1e-4
    assert turned(ends[:, 2], stable[2]).max() < 1e-4


def test_random_starts_come_to_one_pose(rng):
    reach_one_pose(PARTS["bracket"], 0.15, 12, rng)


@pytest.mark.slow
@pytest.mark.parametrize("name", FED)
def test_two_hundred_random_starts_come_to_one_pose(name, rng):
    reach_one_pose(FED[name], 0.5 * feeder_range(FED[name]).ratio, 200, rng)


@pytest.mark.parametrize(("n", "poses"), [(3, 3), (4, 4)])
def test_symmetric_parts_have_as_many_stable_poses_as_symmetries(n, poses):
    part = gon(n)
    found = feeder_range(part)
    assert found.ratio == 0.0
    assert f"symmetry of order {n}" in found.reason
    for ratio in (0.2, 0.4):
        stable = equilibria(part, feeder_field(1.0, ratio)).stable
        assert len(stable) == poses
        assert np.diff(stable[:, 2]) == pytest.approx(np.full(n - 1, 2 * np.pi / n), abs=1e-9)


def test_a_mirror_symmetric_part_is_fed(rng):
    """Only rotations are ambiguous: the T comes to rest one way round."""
    assert len(equilibria(T, feeder_field(1.0, 0.05)).stable) == 1


def test_bad_arguments_are_named():
    for make, argument in (
        (lambda: feeder_range("T"), "part"),
        (lambda: feeder_field(-1.0, 0.1), "density"),
        (lambda: feeder_field(1.0, "weak"), "ratio"),
    ):
        with pytest.raises(InputError) as found:
            make()
        assert found.value.argument == argument
