"""Equilibria beside closed forms, the turn function, minimisation, and simulation."""

import numpy as np
import pytest
from scipy.optimize import minimize

from limitsurf.actuators.density_field import DensityField
from limitsurf.actuators.density_piece import DensityPiece
from limitsurf.actuators.radial_density import RadialField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.field_motion import field_motion
from limitsurf.planning.equilibria import equilibria
from limitsurf.planning.many_starts import stationary_poses
from limitsurf.planning.reduced_potential import ReducedPotential
from limitsurf.planning.squeeze_function import squeeze_function
from limitsurf.planning.turn_function import turn_function
from tests.planning.equilibria_cases import BRACKET, FIELDS, PARTS, settled, sizes, turned
from tests.reference_cases import CASES, NAMES, angle_distance


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_squeezes_agree_with_the_turn_function(case):
    """Orientations to 1e-9, and the line on the median; both ways round."""
    part, line, offset = Part(case["vertices"]), 0.7, 0.3
    turn = turn_function(part)
    found = equilibria(part, DensityField.squeeze(line, 2.0, offset))
    n = np.array([-np.sin(line), np.cos(line)])
    for poses, angles in ((found.stable, turn.stable), (found.saddles, turn.unstable)):
        both = np.concatenate([angles, angles + np.pi]) + line
        assert angle_distance(poses[:, 2], both, 2 * np.pi) < 1e-9
        for pose in poses:
            median = turn.median(pose[2] - line)[0]
            assert pose[:2] @ n == pytest.approx(offset - median, abs=1e-9)
    assert found.complete
    assert len(found.flat) == 1
    assert np.abs(found.flat @ n) < 1e-12


@pytest.mark.parametrize("name", FIELDS)
def test_loads_vanish_and_the_index_is_that_of_the_hessian(name):
    field = FIELDS[name]
    for part in PARTS.values():
        found = equilibria(part, field)
        assert found.complete
        assert len(found.stable) == len(found.saddles) >= 1
        assert np.abs(sizes(part, field, found.poses)).max() < 1e-13
        assert found.potentials == pytest.approx(field.potential(part, found.poses))
        unit = np.array([part.circumradius, part.circumradius, 1.0])
        hessians = -field.jacobian(part, found.poses) * unit * unit[:, None]
        assert np.array_equal((np.linalg.eigvalsh(hessians) < 0.0).sum(axis=1), found.index)


@pytest.mark.parametrize("name", FIELDS)
def test_many_starts_find_the_same_poses(name):
    """The slow twin: Levenberg-Marquardt on the load, from 400 poses."""
    field = FIELDS[name]
    for part in (PARTS["bracket"], PARTS["two pieces"]):
        found = equilibria(part, field)
        poses, index = stationary_poses(part, field, field.centers, field.flat)
        assert len(poses) == len(found.poses)
        for pose, descends in zip(poses, index, strict=True):
            away = np.abs(found.poses - pose)
            away[:, 2] = turned(found.poses[:, 2], pose[2])
            match = np.argmin(away.sum(axis=1))
            assert away[match] == pytest.approx(np.zeros(3), abs=1e-6)
            assert found.index[match] == descends


def random_field(rng):
    """Return one term to three, of any kind, all convex."""

    def term():
        kind = rng.integers(4)
        if kind == 0:
            return RadialField(rng.uniform(0.2, 2.0), rng.normal(size=2))
        if kind == 1:
            return DensityField.squeeze(rng.uniform(0, 3), rng.uniform(0.2, 2.0), rng.normal())
        if kind == 2:
            B = rng.normal(size=(2, 2))
            return DensityField.linear(B @ B.T, rng.normal(size=2))
        return DensityField.uniform(rng.uniform(0, 6), rng.uniform(0, 0.5))

    field = term()
    for _ in range(rng.integers(0, 3)):
        field = field + term()
    return field


@pytest.mark.slow
def test_nothing_is_missed_in_random_fields(rng):
    """Whatever many starts find is there, with its index, and so is nothing else."""
    hits = total = 0
    for _ in range(80):
        angle = 2 * np.pi / 9 * (np.arange(9) + rng.uniform(0.0, 0.8, 9))
        radius = rng.uniform(0.3, 2.0, 9)
        part = Part(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
        field = random_field(rng)
        found = equilibria(part, field)
        assert found.complete
        if found.neutral:
            continue
        total += len(found.poses)
        across = np.eye(2) - found.flat.T @ found.flat
        poses, index = stationary_poses(part, field, field.centers, field.flat)
        for pose, descends in zip(poses, index, strict=True):
            away = np.abs((found.poses - pose)[:, :2] @ across).sum(axis=1)
            away += turned(found.poses[:, 2], pose[2])
            assert away.min() < 1e-5
            assert found.index[np.argmin(away)] == descends
        hits += len(poses)
    assert 150 < hits <= total


def test_extreme_strengths_and_distances_settle(rng):
    """Strengths over six decades, lines and centres up to a thousand circumradii away."""
    for _ in range(20):
        size = 10.0 ** rng.uniform(-6, 5)
        angle = 2 * np.pi / 7 * (np.arange(7) + rng.uniform(0.0, 0.8, 7))
        radius = size * rng.uniform(0.3, 2.0, 7)
        part = Part(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
        R = part.circumradius
        strength = 10.0 ** rng.uniform(-3, 3, 3)
        place = R * 10.0 ** rng.uniform(-1, 3, 3)[:, None] * rng.normal(size=(3, 2))
        field = (
            RadialField(strength[0], place[0])
            + DensityField.squeeze(rng.uniform(0, 3), strength[1], place[1, 0])
            + DensityField.squeeze(rng.uniform(0, 3), strength[2], place[2, 0])
        )
        found = equilibria(part, field)
        assert len(found.stable) >= 1
        far = 1.0 + np.abs(found.poses[:, :2]).max() / R
        assert np.abs(sizes(part, field, found.poses)).max() < 1e-12 * far


def test_minimisation_ends_in_stable_poses(rng):
    part, field = PARTS["bracket"], FIELDS["radial and squeeze"]
    stable, reached = equilibria(part, field).stable, set()
    for _ in range(30):
        start = rng.uniform(-3.0, 3.0, 3) * [1.0, 1.0, 2.0]
        end = minimize(
            lambda q: float(field.potential(part, q)),
            start,
            jac=lambda q: -field.load(part, q),
            options={"gtol": 1e-9},
        ).x
        away = np.hypot(*(stable[:, :2] - end[:2]).T) + turned(stable[:, 2], end[2])
        assert away.min() < 1e-6
        reached.add(int(np.argmin(away)))
    assert len(reached) == len(stable)


@pytest.mark.parametrize("name", ["feeder", "radial and squeeze", "crossed squeezes"])
def test_the_reduced_slope_is_a_derivative_and_climbs_no_faster_than_its_bound(name):
    for part in PARTS.values():
        reduced = ReducedPotential.of(part, FIELDS[name])
        theta = np.linspace(0.0, 2 * np.pi, 400)

        def least(theta, part=part, reduced=reduced):
            poses = np.column_stack([reduced.position(theta), theta])
            return FIELDS[name].potential(part, poses)

        h = 1e-4
        difference = (least(theta + h) - least(theta - h)) / (2.0 * h)
        assert reduced.slope(theta) == pytest.approx(difference, abs=1e-6 * reduced.rise)
        rise = (reduced.slope(theta + h) - reduced.slope(theta - h)) / (2.0 * h)
        assert 0.02 * reduced.rise < rise.max() <= reduced.rise


@pytest.mark.parametrize("ratio", [1.01, 1.1, 1.2])
def test_rectangles_have_twelve_digits(ratio):
    """Stable at tan(theta) = +-sqrt(3 b^2/a^2 - 2) in a squeeze (docs/planning.md)."""
    part = Part([(0, 0), (ratio, 0), (ratio, 1), (0, 1)])
    theta = np.arctan(np.sqrt(3 / ratio**2 - 2))
    expected = np.array([theta, np.pi - theta, np.pi + theta, 2 * np.pi - theta])
    found = equilibria(part, DensityField.squeeze(0.0, 1.0))
    assert np.sort(found.stable[:, 2]) == pytest.approx(np.sort(expected), abs=1e-12)


def test_elliptic_fields_turn_parts_to_their_principal_axes():
    """The long axis along the soft one (Kavraki 1997): two stable poses, in closed form."""
    axis, soft_angle = 0.4, 0.9
    c, s = np.cos(soft_angle), np.sin(soft_angle)
    frame = np.array([[c, -s], [s, c]])
    field = DensityField.linear(frame @ np.diag([1.0, 2.5]) @ frame.T, (3.0, -1.0))
    box = np.array([(-2, -0.5), (2, -0.5), (2, 0.5), (-2, 0.5)]) @ [
        [np.cos(axis), np.sin(axis)],
        [-np.sin(axis), np.cos(axis)],
    ]
    found = equilibria(Part(box), field)
    expected = np.sort(np.mod(soft_angle - axis + np.array([0.0, np.pi]), 2 * np.pi))
    assert found.stable[:, 2] == pytest.approx(expected, abs=1e-12)
    assert found.stable[:, :2] == pytest.approx(np.tile([3.0, -1.0], (2, 1)), abs=1e-12)
    assert found.complete


def test_isotropic_and_radial_fields_are_neutral():
    """Linear: about the centroid. Radial: about the pivot, whatever the orientation."""
    part = PARTS["bracket"]
    linear = equilibria(part, DensityField.linear(2.0, (1.0, 2.0)))
    assert linear.neutral
    assert linear.complete
    assert linear.poses == pytest.approx(np.array([[1.0, 2.0, 0.0]]), abs=1e-12)
    radial = RadialField(2.0, (1.0, 2.0))
    found = equilibria(part, radial)
    assert found.neutral
    assert found.complete
    assert "every orientation" in found.note
    arm = found.poses[0, :2] - [1.0, 2.0]
    assert np.hypot(*arm) > 0.05
    for theta in (1.0, 2.0, 5.0):
        c, s = np.cos(theta), np.sin(theta)
        pose = np.array([1.0 + c * arm[0] - s * arm[1], 2.0 + s * arm[0] + c * arm[1], theta])
        assert np.abs(sizes(part, radial, pose[None])).max() < 1e-14


def test_disks_are_neutral_to_rounding_and_not_by_proof():
    t = 2 * np.pi * np.arange(400) / 400
    disk = Part(np.column_stack([np.cos(t), np.sin(t)]))
    found = equilibria(disk, FIELDS["feeder"])
    assert found.neutral
    assert not found.complete
    assert "to rounding" in found.note


@pytest.mark.parametrize(
    "field",
    [
        DensityField.uniform(0.3, 1.0),
        DensityField.squeeze(0.3, 1.0) + DensityField.uniform(0.3, 1e-6),
        DensityField.squeeze(0.3, 1.0) + DensityField.uniform(0.3 + np.pi / 2, 1.01),
        DensityField.linear([[1.0, 0.0], [0.0, 0.0]]) + DensityField.uniform(np.pi / 2, 0.1),
        RadialField(1.0) + DensityField.uniform(0.3, 1.0),
        RadialField(1.0) + DensityField.uniform(0.3, 1.2),
    ],
    ids=repr,
)
def test_nothing_rests_where_the_field_pushes_without_end(field):
    found = equilibria(PARTS["bracket"], field)
    assert len(found.poses) == 0
    assert "pushed away" in found.note


def test_a_push_across_the_line_shifts_the_part(rng):
    """Equilibrium where the areas on the two sides differ by the push: checked by simulation."""
    part = PARTS["bracket"]
    field = DensityField.squeeze(0.3, 1.0) + DensityField.uniform(0.3 + np.pi / 2, 0.4)
    found = equilibria(part, field)
    starts = rng.uniform(-1.0, 1.0, (10, 3)) * [1.0, 1.0, np.pi]
    for end in settled(part, field, starts, 300.0):
        k = np.argmin(turned(found.stable[:, 2], end[2]))
        assert turned(found.stable[k, 2], end[2]) < 1e-5


def test_a_triple_root_is_found_to_1e_5():
    """The rectangle of ratio sqrt(1.5): the moment vanishes like the cube."""
    part = Part([(0, 0), (np.sqrt(1.5), 0), (np.sqrt(1.5), 1), (0, 1)])
    found = equilibria(part, DensityField.squeeze(0.0, 1.0))
    assert angle_distance(found.stable[:, 2], [0.0, np.pi], 2 * np.pi) < 1e-5
    assert len(found.saddles) == 2


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_sizes_do_not_matter(scale):
    center = np.array([0.5, -1.0])
    small = equilibria(Part(BRACKET), RadialField(1.0, center) + DensityField.uniform(0.4, 0.6))
    field = RadialField(1e3, scale * center) + DensityField.uniform(0.4, 600.0)
    found = equilibria(Part(scale * BRACKET), field)
    assert found.poses == pytest.approx(small.poses * [scale, scale, 1.0], rel=1e-10)
    assert found.potentials == pytest.approx(1e3 * scale**3 * small.potentials, rel=1e-12)
    assert found.complete


def test_far_from_the_origin_only_digits_are_lost():
    far = np.array([3e4, -7e4])
    near = equilibria(PARTS["bracket"], RadialField(1.0) + DensityField.uniform(0.4, 0.6))
    found = equilibria(PARTS["bracket"], RadialField(1.0, far) + DensityField.uniform(0.4, 0.6))
    assert found.poses - [*far, 0.0] == pytest.approx(near.poses, abs=1e-8)


def test_fields_that_push_outwards_come_without_a_promise():
    """A stretched squeeze: what was stable falls in two directions, what was a saddle in one."""
    part = PARTS["bracket"]
    found, turn = equilibria(part, DensityField.squeeze(0.3, -2.0)), turn_function(part)
    assert not found.complete
    assert "may be others" in found.note
    assert "perhaps not all" in repr(found)
    assert len(found.stable) == 0
    assert angle_distance(found.unstable[:, 2] - 0.3, np.tile(turn.stable, 2)) < 1e-6
    assert angle_distance(found.saddles[:, 2] - 0.3, np.tile(turn.unstable, 2)) < 1e-6


def test_any_field_with_loads_and_a_potential_will_do():
    """A saddle-shaped linear field through a class that offers nothing else."""

    class Saddle:
        inner = DensityField.linear([[2.0, 0.3], [0.3, -1.0]])
        has_potential = True

        def load(self, part, pose):
            return self.inner.load(part, pose)

        def jacobian(self, part, pose):
            return self.inner.jacobian(part, pose)

        def potential(self, part, pose):
            return self.inner.potential(part, pose)

    found = equilibria(PARTS["bracket"], Saddle())
    assert len(found.poses) == 4
    assert sorted(found.index) == [1, 1, 2, 2]
    assert np.abs(found.poses[:, :2]).max() < 1e-9


def test_fields_without_potential_are_refused():
    for field in (DensityField.skewed_squeeze(0.0, 0.1, 1.0), DensityField([WEDGE])):
        with pytest.raises(InputError, match="skewed_equilibria") as found:
            equilibria(PARTS["bracket"], field)
        assert found.value.argument == "field"


WEDGE = DensityPiece([0.0, 1.0], normals=[[0, 1], [1, 0]], bounds=[0.0, 0.0])


def test_a_field_of_nothing_is_refused():
    with pytest.raises(InputError):
        equilibria(PARTS["bracket"], DensityField.squeeze(0.0, 0.0))


def test_squeezing_after_centring_forgets_the_offset():
    """The isotropic field brings the centroid to the line and does not turn the part; the squeeze
    then does the same whatever the offset was. Without centring the offset decides."""
    part = Part.from_file("paper_t")
    size, quasi = part.circumradius, {"mode": "quasi-static"}
    drag = 1e4 * np.array([part.area, part.area, part.polar_moment])
    isotropic = DensityField.linear(1e3 / size)
    squeeze = DensityField.squeeze(0.0, 1e3)
    turn = turn_function(part)
    theta = float(turn.unstable[0]) + 0.02
    alone, centred = [], []
    for y in (-0.8 * size, 0.8 * size):
        start = (0.1 * size, y, theta)
        path = field_motion(part, squeeze, start, drag=drag, **quasi)
        alone.append(path.final_pose[2])
        middle = field_motion(part, isotropic, start, drag=drag, **quasi).final_pose
        assert middle == pytest.approx([0.0, 0.0, theta], abs=1e-8)
        end = field_motion(part, squeeze, middle, drag=drag, **quasi).final_pose
        centred.append(end[2])
        found = equilibria(part, squeeze).stable
        assert turned(found[:, 2], end[2]).min() < 1e-6
    assert turned(centred[0], centred[1]) < 1e-6
    assert turned(alone[0], alone[1]) > 0.5
    assert len(squeeze_function(turn).images) > 1
