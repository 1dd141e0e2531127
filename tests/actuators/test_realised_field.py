import numpy as np
import pytest
from scipy.optimize import linprog

import limitsurf as ls
from limitsurf.actuators.activation import direction_error, squeeze_activation
from limitsurf.actuators.actuator_array import load_array
from limitsurf.actuators.field_error import direction_errors, load_error
from limitsurf.actuators.force_fields import (
    elliptic_field,
    radial_field,
    skewed_squeeze_field,
    squeeze_field,
    uniform_field,
)
from limitsurf.actuators.pixel_lattice import PixelLattice, headings
from limitsurf.actuators.realised_field import RealisedField, activate, realise, time_shares
from limitsurf.errors import InputError


def whirl(points):
    """Return a field of my own: a vortex."""
    return np.stack([-points[:, 1], points[:, 0]], axis=-1) / 10e-3


FIELDS = {
    "uniform": uniform_field(0.3),
    "squeeze": squeeze_field(0.4, 1e-3),
    "skewed": skewed_squeeze_field(0.4, 0.3),
    "radial": radial_field((1e-3, 0.0)),
    "elliptic": elliptic_field((1.0, 2.0), 5e-3, 0.2),
    "own": whirl,
}
WEAK = (FIELDS["elliptic"], FIELDS["own"])
LATTICES = {
    "three ways": PixelLattice.hexagonal(70, 60, 200e-6, headings(3)),
    "six ways": PixelLattice.hexagonal(70, 60, 200e-6, headings(6, 0.1)),
    "four ways": PixelLattice.rectangular(64, 64, 200e-6, headings(4)),
}


def test_shares_solve_the_linear_program(rng):
    """min sum s, sum s_k push_k = wanted, s >= 0: by HiGHS, pixel by pixel."""
    pushes = rng.normal(size=(60, 5, 2))
    pushes[::7, 2] = 0.0
    wanted = rng.normal(size=(60, 2))
    shares = time_shares(pushes, wanted)
    for p, w, s in zip(pushes, wanted, shares, strict=True):
        program = linprog(np.ones(5), A_eq=p.T, b_eq=w, bounds=(0, None))
        if program.status == 0:
            assert p.T @ s == pytest.approx(w, abs=1e-9)
            assert s.sum() == pytest.approx(program.fun, rel=1e-9)
            assert np.sum(s > 0.0) <= 2
        else:
            assert np.sum(s > 0.0) <= 1
            alone = [np.maximum(q @ w, 0.0) / max(q @ q, 1e-300) for q in p]
            errors = [np.linalg.norm(a * q - w) for a, q in zip(alone, p, strict=True)]
            assert np.linalg.norm(p.T @ s - w) == pytest.approx(min(errors))


@pytest.mark.parametrize("lattice", LATTICES.values(), ids=list(LATTICES))
@pytest.mark.parametrize("field", FIELDS.values(), ids=list(FIELDS))
class TestEveryFieldOnEveryLattice:
    def test_duty_cycles_give_the_field_exactly(self, lattice, field):
        realised = realise(lattice, field, "duty")
        assert realised.duty.min() >= 0.0
        assert realised.duty.sum(axis=1).max() == pytest.approx(1.0) or realised.scale == 1.0
        wanted = realised.scale * field(lattice.pixel_centers)
        assert realised.forces.sum(axis=1) == pytest.approx(wanted, abs=1e-12)
        assert direction_errors(realised, 1e-3).worst < 1e-9

    def test_dither_runs_one_a_pixel_and_is_right_on_average(self, lattice, field):
        realised = realise(lattice, field, "dither")
        assert set(np.unique(realised.duty)) <= {0.0, 1.0}
        assert realised.duty.sum(axis=1).max() == 1.0
        assert direction_errors(realised, 1.5e-3).rms < np.radians(7.0 if field in WEAK else 2.5)
        wanted = realised.scale * field(lattice.pixel_centers)
        assert realised.forces.sum(axis=1).mean(axis=0) == pytest.approx(
            wanted.mean(axis=0), abs=5e-3
        )

    def test_nearest_is_off_by_at_most_half_the_angle_between_directions(self, lattice, field):
        realised = realise(lattice, field, "nearest")
        wanted = field(lattice.pixel_centers)
        push = realised.forces.sum(axis=1)
        runs = np.any(push != 0.0, axis=1)
        cosine = np.sum(push * wanted, axis=1)[runs] / np.linalg.norm(wanted[runs], axis=1)
        assert np.degrees(np.arccos(np.minimum(cosine, 1.0))).max() <= (
            180.0 / len(lattice.directions) + 1e-6
        )

    def test_load_on_a_part(self, lattice, field):
        """Dither is coarse where a field is weak: the elliptic and my own run few tips here."""
        part = ls.Part.from_file("paper_t")
        errors = {}
        for method in ("duty", "dither"):
            found = load_error(realise(lattice, field, method), part, (2e-4, 1e-4, 0.5))
            errors[method] = np.hypot(*found.force) + abs(found.moment)
        assert errors["duty"] < 0.03
        assert errors["dither"] < (0.4 if field in WEAK else 0.12)


def test_ideal_load_of_a_uniform_field_has_no_moment():
    realised = realise(LATTICES["four ways"], uniform_field(0.7), "duty")
    error = load_error(realised, ls.Part.from_file("paper_t"), (0.0, 0.0, 0.3))
    assert error.ideal == pytest.approx([np.cos(0.7), np.sin(0.7), 0.0], abs=1e-3)
    assert error.realised[:2] == pytest.approx([np.cos(0.7), np.sin(0.7)], abs=0.03)


def test_dither_turns_a_part_less_than_nearest_does():
    """The moment of a skewed squeeze, which nearest directions forget."""
    part, moments = ls.Part.from_file("paper_t"), {}
    for method in ("dither", "nearest"):
        realised = realise(LATTICES["four ways"], squeeze_field(0.4), method)
        poses = [(0.0, 0.0, angle) for angle in np.linspace(0.0, 3.0, 12)]
        moments[method] = np.mean([abs(load_error(realised, part, p).moment) for p in poses])
    assert moments["dither"] < 0.25 * moments["nearest"]


def test_a_part_over_the_edge_is_named():
    realised = realise(LATTICES["four ways"], uniform_field(0.0))
    with pytest.raises(InputError, match="over the edge"):
        load_error(realised, ls.Part.from_file("paper_t"), (5e-3, 0.0, 0.0))


def test_errors_by_hand():
    """Two pixels on a bar: one pushes along x as asked, the other across."""
    lattice = PixelLattice.rectangular(1, 2, 1.0, headings(4), np.zeros((4, 2)))
    duty = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0]])
    realised = RealisedField(lattice, uniform_field(0.0), duty, 1.0)
    bar = ls.Part(np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]))
    error = load_error(realised, bar)
    assert error.realised[:2] == pytest.approx([0.5, 0.5])
    assert error.realised[2] == pytest.approx(0.5 / (2 * np.sqrt(5 / 12)))
    assert error.force == pytest.approx((-0.5, 0.5), abs=1e-9)
    assert error.moment == pytest.approx(error.realised[2], abs=1e-9)


def test_dead_actuators_are_replaced_where_others_can():
    lattice = LATTICES["six ways"].with_spread(dead=0.1, seed=3)
    realised = realise(lattice, uniform_field(0.3), "duty")
    assert not realised.duty[lattice.spread.dead].any()
    error = realised.forces.sum(axis=1) - realised.scale * uniform_field(0.3)(lattice.pixel_centers)
    assert np.mean(np.linalg.norm(error, axis=1) < 1e-9) > 0.75
    assert np.linalg.norm(error.mean(axis=0)) < 0.07
    assert realised.scale == realise(LATTICES["six ways"], uniform_field(0.3), "duty").scale


def test_spread_is_not_known_to_the_choice_but_shows_in_the_error():
    spread = LATTICES["four ways"].with_spread(strength=0.2, direction=0.2, seed=3)
    for method in ("dither", "nearest", "duty"):
        blind = realise(LATTICES["four ways"], radial_field(), method)
        assert np.array_equal(realise(spread, radial_field(), method).duty, blind.duty)
    assert direction_errors(realise(spread, radial_field(), "duty"), 1e-3).rms > 0.01


@pytest.mark.parametrize("line", [0.0, 0.3, 1.2, 2.5])
def test_an_activated_array_squeezes_like_squeeze_activation(line):
    array = load_array("resonator64")
    ours = activate(array, squeeze_field(line))
    assert ours.active.sum() == pytest.approx(64 * 64, abs=64)  # on the line nothing runs
    realised = realise(PixelLattice.from_array(array), squeeze_field(line))
    assert direction_errors(realised, 2e-3).rms < np.radians(2.0)
    theirs = squeeze_activation(array, line)
    assert np.mean(ours.active == theirs.active) > 0.7
    assert direction_error(theirs) < np.radians(0.5)


def test_an_elliptic_field_aligns_a_part():
    """Kavraki 1997: the part's longer axis comes to rest along the softer axis of the field."""
    array = load_array("resonator64")
    drive = activate(array, elliptic_field((1.0, 3.0), 3e-3))
    part = ls.Part.from_file("paper_t")
    run = ls.simulate(part, drive, (1e-3, 1e-3, 0.6), duration=3.0)
    assert np.linalg.norm(run.final_pose[:2]) < 3e-4


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: realise(LATTICES["four ways"], uniform_field(0.0), "best"), "method"),
        (lambda: realise(LATTICES["four ways"], lambda p: p[:, 0]), "field"),
        (lambda: activate(load_array("resonator32"), uniform_field(0.0), "duty"), "method"),
        (lambda: uniform_field(np.nan), "angle"),
        (lambda: elliptic_field((1.0, -1.0), 1.0), "stiffness"),
        (lambda: elliptic_field((1.0, 1.0), 0.0), "reach"),
        (lambda: skewed_squeeze_field(0.0, 2.0), "skew"),
        (lambda: direction_errors(realise(LATTICES["four ways"], whirl), -1.0), "radius"),
        (lambda: direction_errors(realise(LATTICES["four ways"], whirl), 1.0), "radius"),
    ],
)
def test_bad_arguments_are_named(call, name):
    with pytest.raises(InputError, match=name):
        call()
