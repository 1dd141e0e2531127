"""Separatrices beside forward motion and beside another integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.squeeze_energy import squeeze_energy
from limitsurf.planning.ideal_squeeze import IdealSqueeze, turning_mobility
from limitsurf.planning.separatrices import boundary_shift, separatrices
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES

PARTS = {case["name"]: Part(np.array(case["vertices"])) for case in CASES}
NAMES = ("square", "T", "U_sym", "simple_16", "convex_8", "blob_m3", "L_pivot", "near_square")


def ends_on_both_sides(part, ratio, offset, phi, width=1e-9):
    starts = [phi - width, phi + width]
    return IdealSqueeze(ratio).settle(part, offset, starts, 1e-11)[1]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("ratio", [0.0, 0.01, 1.0, 10.0])
def test_motions_part_within_1e_9_of_every_crossing(name, ratio):
    part = PARTS[name]
    for curve in separatrices(part, ratio):
        for share in (-0.3, 0.0, 0.2):
            offset = share * part.area**0.5
            crossings = curve.crossings(offset)
            assert len(crossings) % 2 == 1
            for phi in crossings:
                low, high = ends_on_both_sides(part, ratio, offset, phi)
                assert abs(high - low) > 0.1


@pytest.mark.parametrize("name", ["T", "simple_16", "convex_8"])
@pytest.mark.parametrize("ratio", [0.1, 10.0])
def test_ends_are_those_of_another_integrator(name, ratio):
    """Backwards from the saddle by DOP853, along the eigenvector of the Hessian there."""
    part = PARTS[name]
    edges, kappa = np.array(part.unit_edges), turning_mobility(part, ratio)

    def rate(_, y):
        _, force, moment, *_ = squeeze_energy(edges, 1.0, y[0], y[1])
        return [force, kappa * moment]

    for curve in separatrices(part, ratio):
        saddle = np.array([curve.saddle[0] / part.area**0.5, -curve.saddle[1]])
        U, force, _, c0, c1, c2 = squeeze_energy(edges, 1.0, *saddle)
        hessian = np.array([[c0, c1], [c1, c2 - 0.5 * (U - saddle[0] * force)]]) * 2
        scale = np.diag([1.0, kappa**0.5])
        values, vectors = np.linalg.eigh(scale @ hessian @ scale)
        assert values[0] < 0.0 < values[1]
        way = scale @ vectors[:, 1] * np.sign(vectors[0, 1])
        for sign, end in zip((-1, 1), curve.ends, strict=True):
            twin = solve_ivp(
                rate, (0, 60), saddle + sign * 1e-6 * way, method="DOP853", rtol=1e-11, atol=1e-12
            )
            assert -twin.y[1, -1] == pytest.approx(end, abs=1e-8)


@pytest.mark.parametrize("name", NAMES)
def test_a_curve_is_one_motion_into_its_saddle(name):
    """Energy falls from both ends to the saddle, and there are as many as unstable orientations."""
    part = PARTS[name]
    curves = separatrices(part, 1.0)
    assert [c.saddle[1] for c in curves] == pytest.approx(turn_function(part).unstable.tolist())
    for curve in curves:
        for rows in curve.branches:
            energies = [squeeze_energy(np.array(part.unit_edges), 1.0, *r[1:3])[0] for r in rows]
            assert np.diff(energies).min() > -1e-13
        assert curve.offsets[0] < 0.0 < curve.offsets[-1]


def test_extremes_are_where_the_curve_turns_back():
    curve = separatrices(PARTS["simple_16"], 10.0)[0]
    low, high = curve.extremes
    assert low[1] == curve.orientations.min()
    assert high[1] == curve.orientations.max()
    fine = np.concatenate([curve.crossings(z) for z in np.linspace(-0.6, 0.6, 301)])
    assert fine.min() >= low[1] - 1e-9
    assert fine.max() <= high[1] + 1e-9
    assert fine.max() > high[1] - 1e-3


def test_crossings_beyond_the_part_are_the_ends():
    part = PARTS["T"]
    for curve in separatrices(part, 1.0):
        far = 2 * part.circumradius
        assert curve.crossings(-far).tolist() == [curve.ends[0]]
        assert curve.crossings(far).tolist() == [curve.ends[1]]


def test_symmetry_keeps_separatrices_straight():
    """A line across the axis of a mirror turns nothing, wherever it lies."""
    curve = separatrices(Part([(0, 0), (3, 0), (3, 1), (0, 1)]), 1.0)[0]
    assert np.ptp(curve.orientations) < 1e-12


def test_the_border_moves_less_the_slower_the_part_turns():
    shifts = [boundary_shift(PARTS["simple_16"], ratio) for ratio in (0.0, 0.001, 0.01, 0.1, 1.0)]
    assert shifts[0] == 0.0
    assert shifts[2] / shifts[1] == pytest.approx(10.0, rel=0.1)
    assert np.all(np.diff(shifts) > 0.0)


def test_curves_that_hang_on_rounding_are_refused():
    """Along its symmetric lines quick turning makes every error grow."""
    with pytest.raises(SolveFailed, match=r"hangs on rounding.*smaller mobility_ratio"):
        separatrices(PARTS["pentagon"], 1000.0)


def test_bad_ratios_are_named():
    with pytest.raises(InputError, match="mobility_ratio"):
        separatrices(PARTS["T"], -1.0)
