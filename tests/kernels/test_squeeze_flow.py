"""Energy against clipped polygons, derivatives against differences, RODAS against its order."""

import numpy as np
import pytest
import shapely
from scipy.integrate import solve_ivp

from limitsurf.geometry.part import Part
from limitsurf.kernels.median import squeeze_states
from limitsurf.kernels.squeeze_energy import squeeze_energy
from limitsurf.kernels.squeeze_flow import (
    FLAT,
    STABLE,
    flow_rate,
    flow_step,
    flow_to,
    flow_trace,
    settle,
)
from limitsurf.planning.ideal_squeeze import turning_mobility
from tests.reference_cases import CASES

RING = shapely.Point(0.2, 0.1).buffer(1.0, 8).difference(shapely.box(-0.1, -0.2, 0.5, 0.6))
PIECES = shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0.3, 3.5, 0.9)])
PARTS = [Part(np.array(case["vertices"]), name=case["name"]) for case in CASES[::3]]
PARTS += [Part(RING, name="ring"), Part(PIECES, name="pieces")]


def edges_of(part):
    return np.array(part.unit_edges)


@pytest.fixture(params=PARTS, ids=lambda part: part.name)
def part(request):
    return request.param


def lines(part, rng, count):
    reach = part.circumradius / part.area**0.5
    return np.column_stack([rng.uniform(-reach, reach, count), rng.uniform(0, 2 * np.pi, count)])


def halves(part, z, theta):
    """Return area and centroid on the right and on the left of a line, by clipping."""
    shape = shapely.transform(
        part.polygon, lambda p: (p - np.array(part.centroid)) / part.area**0.5
    )
    turned = shapely.affinity.rotate(shape, -theta, origin=(0, 0), use_radians=True)
    for clip in (shapely.box(-99, -99, 99, z), shapely.box(-99, z, 99, 99)):
        side = shapely.intersection(turned, clip)
        yield shapely.area(side), shapely.get_coordinates(shapely.centroid(side))


def test_energy_is_that_of_the_two_sides(part, rng):
    for z, theta in lines(part, rng, 20):
        U, force, moment, *_ = squeeze_energy(edges_of(part), 1.0, z, theta)
        (right, low), (left, high) = halves(part, z, theta)
        first, second = (low, high) if len(low) and len(high) else ([[0, 0]], [[0, 0]])
        if right < 1e-9 or left < 1e-9:
            continue
        (s_right, t_right), (s_left, t_left) = np.ravel(first), np.ravel(second)
        assert pytest.approx(right * (z - t_right) + left * (t_left - z), abs=1e-12) == U
        assert force == pytest.approx(right - left, abs=1e-12)
        assert moment == pytest.approx(right * s_right - left * s_left, abs=1e-12)


def test_derivatives_are_those_of_the_energy(part, rng):
    edges, d = edges_of(part), 1e-5
    for z, theta in lines(part, rng, 20):
        U, force, moment, c0, c1, c2 = squeeze_energy(edges, 1.0, z, theta)
        along_z = [np.array(squeeze_energy(edges, 1.0, z + s * d, theta)) for s in (-1, 1)]
        along_t = [np.array(squeeze_energy(edges, 1.0, z, theta + s * d)) for s in (-1, 1)]
        by_z, by_t = ((b - a)[:3] / (2 * d) for a, b in (along_z, along_t))
        assert [by_z[0], by_t[0]] == pytest.approx([force, moment], abs=1e-8)
        near = max(
            np.abs(a + b - 2 * np.array([U, force, moment, c0, c1, c2]))[1:3].max()
            for a, b in (along_z, along_t)
        )
        if near < 1e-8:  # no vertex within d of the line
            found = [by_z[1], by_z[2], by_t[1], by_t[2]]
            expected = [2 * c0, 2 * c1, 2 * c1, 2 * c2 - U + z * force]
            assert found == pytest.approx(expected, abs=2e-4)


def test_on_the_median_it_is_the_state_of_the_turn_function(part, rng):
    theta = rng.uniform(0, np.pi, 20)
    for angle, (z, U, slope, J, *_) in zip(
        theta, squeeze_states(edges_of(part), theta, 0.5), strict=True
    ):
        energy, force, moment, c0, c1, c2 = squeeze_energy(edges_of(part), 1.0, z, angle)
        assert [energy, force, moment] == pytest.approx([U, 0.0, slope], abs=1e-13)
        if c0 > 0.0:
            assert 2 * (c2 - c1 * c1 / c0) == pytest.approx(2 * J, abs=1e-11)


def test_a_line_that_misses_the_part_pushes_and_does_not_turn(part, rng):
    reach = 1.001 * part.circumradius / part.area**0.5
    for theta in rng.uniform(0, 7, 10):
        for side in (-1.0, 1.0):
            state = squeeze_energy(edges_of(part), 1.0, side * reach, theta)
            assert state == (reach, side, 0.0, 0.0, 0.0, 0.0)


def test_rodas_has_order_four():
    """Away from kinks, halving the step divides the error of a fixed time by 2^4."""
    edges, root = edges_of(Part([(0, 0), (2, 0), (2, 1), (0, 1)])), 0.7
    start, time = np.array([0.05, 0.3]), 0.2

    def end(steps):
        z, theta = start
        for _ in range(steps):
            z, theta, *_ = flow_to(edges, root * root, 1.0, np.array([z, theta]), time / steps)
        return np.array([z, theta])

    exact = end(256)
    errors = [np.abs(end(n) - exact).max() for n in (2, 4, 8, 16)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(np.full(3, 4.0), abs=0.4)


def test_the_error_estimate_is_of_the_size_of_the_error():
    edges, root = edges_of(PARTS[3]), 1.3
    at = flow_rate(edges, root, 0.2, 0.5)
    z, q, error_z, error_q = flow_step(edges, root, 1.0, at, 0.02, np.empty((6, 2)))
    rows, _ = flow_trace(edges, root**2, 1.0, np.array([0.2, root * 0.5]), 1e-12)
    exact = [np.interp(0.02, rows[:, 0], rows[:, k]) for k in (1, 2)]
    off = np.hypot(z - exact[0], q - exact[1] / root)
    assert off < 10 * np.hypot(error_z, error_q) + 1e-6


def test_backwards_it_returns(part, rng):
    """A step forwards and the same step backwards: errors of the fifth power of the step."""
    edges, kappa = edges_of(part), turning_mobility(part, 1.0)
    for start in lines(part, rng, 10):
        z, theta, *_ = flow_to(edges, kappa, 1.0, start, 1e-3)
        back = flow_to(edges, kappa, -1.0, np.array([z, theta]), 1e-3)
        assert back[:2] == pytest.approx(start, abs=1e-9)


@pytest.mark.parametrize("ratio", [0.1, 10.0])
def test_paths_are_those_of_another_integrator(part, ratio, rng):
    edges, kappa = edges_of(part), turning_mobility(part, ratio)

    def rate(_, y):
        _, force, moment, *_ = squeeze_energy(edges, 1.0, y[0], y[1])
        return [-force, -kappa * moment]

    for start in lines(part, rng, 2):
        rows, status = flow_trace(edges, kappa, 1.0, start, 1e-10)
        assert status == STABLE
        k = len(rows) // 3
        twin = solve_ivp(rate, (0, rows[k, 0]), start, method="DOP853", rtol=1e-11, atol=1e-12)
        assert rows[k, 1:3] == pytest.approx(twin.y[:, -1], abs=1e-7)


@pytest.mark.parametrize("ratio", [0.0, 1e-4, 0.01, 1.0, 100.0, 1e4])
def test_rest_is_a_strict_minimum(part, ratio, rng):
    edges, kappa = edges_of(part), turning_mobility(part, ratio)
    ends, status = settle(edges, kappa, lines(part, rng, 20), 1e-8)
    assert (status == STABLE).all()
    for z, theta in ends:
        U, force, moment, c0, c1, c2 = squeeze_energy(edges, 1.0, z, theta)
        assert max(abs(force), abs(moment)) < 1e-13
        if c0 > 0.0:  # a line in the gap between two pieces may be moved
            assert 2 * (c2 - c1 * c1 / c0) > U


def test_energy_never_rises(part, rng):
    edges, kappa = edges_of(part), turning_mobility(part, 3.0)
    for start in lines(part, rng, 3):
        rows, _ = flow_trace(edges, kappa, 1.0, start, 1e-9)
        energies = np.array([squeeze_energy(edges, 1.0, z, theta)[0] for z, theta in rows[:, 1:3]])
        assert np.diff(energies).max() < 1e-13


def test_symmetric_starts_rest_on_the_border():
    """A rectangle across the line is in equilibrium; nothing turns it."""
    edges = edges_of(Part([(-1, -2), (1, -2), (1, 2), (-1, 2)]))
    ends, status = settle(edges, 1.0, np.array([[0.1, 0.0]]), 1e-8)
    assert status[0] == FLAT
    assert ends[0] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_disk_moves_onto_the_line_and_does_not_turn():
    disk = Part(shapely.Point(3.0, 2.0).buffer(1.0, 4096))
    ends, status = settle(edges_of(disk), 1.0, np.array([[0.2, 0.37]]), 1e-8)
    assert status[0] in (FLAT, STABLE)
    assert ends[0] == pytest.approx([0.0, 0.37], abs=1e-3)
