"""Shared loads beside the same program in cvxpy, and cases with known answers."""

import cvxpy as cp
import numpy as np
import pytest

from limitsurf.contacts.load_sharing import share_load
from limitsurf.errors import InputError, LimitSurfError, OutsideSupports

LEGS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


def twin(positions, weight, center):
    """Return the loads of the quadratic program, solved by Clarabel."""
    n = len(positions)
    N = cp.Variable(n)
    arms = (positions - center) / np.abs(positions - center).max()
    program = cp.Problem(
        cp.Minimize(cp.sum_squares(N)), [cp.sum(N) == n, arms.T @ N == 0.0, N >= 0.0]
    )
    tight = {f"tol_{k}": 1e-14 for k in ("gap_abs", "gap_rel", "feas")}
    program.solve(solver=cp.CLARABEL, **tight)
    return N.value * weight / n


@pytest.mark.parametrize("n", [3, 4, 7, 30, 300, 3000])
def test_minimum_norm_is_the_quadratic_programs(rng, n):
    for _ in range(3):
        places = rng.normal(size=(n, 2)) + np.array([3.0, -1.0])
        inner = rng.dirichlet(np.full(min(n, 5), 0.7)) @ places[:5]  # off the middle
        share = share_load(places, 2.5, inner)
        slow = twin(places, 2.5, inner)
        assert share.normal_force == pytest.approx(slow, abs=1e-9 * slow.max())


@pytest.mark.parametrize("n", [1, 2, 3, 5, 50, 20000])
def test_conditions_of_optimality_hold(rng, n):
    places = rng.normal(size=(n, 2))
    center = rng.dirichlet(np.full(n, 0.3)) @ places
    share = share_load(places, 7.0, center)
    assert share.residual <= 1e-12
    assert (share.normal_force >= 0.0).all()
    assert share.normal_force.sum() == pytest.approx(7.0, rel=1e-12)
    assert share.normal_force @ places == pytest.approx(7.0 * center, abs=1e-11)
    pull = np.column_stack([np.ones(n), places - center]) @ share.multipliers
    assert share.normal_force == pytest.approx(np.maximum(pull, 0.0), abs=1e-13 * 7.0)


def test_degenerate_supports():
    line = [[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [1.0, 1.0]]
    assert share_load(line, 1.0, [0.5, 0.5]).residual <= 1e-12
    assert share_load(line, 1.0, [3.0, 3.0]).normal_force == pytest.approx([0, 0, 1, 0], abs=1e-12)
    assert share_load([[2.0, 2.0]] * 4, 1.0, [2.0, 2.0]).normal_force == pytest.approx([0.25] * 4)
    on_an_edge = share_load(LEGS, 1.0, [1.0, 0.5]).normal_force
    assert on_an_edge == pytest.approx([0.75, 0.0, 0.0, 0.25], abs=1e-12)
    on_a_corner = share_load(LEGS, 1.0, [-1.0, 1.0]).normal_force
    assert on_a_corner == pytest.approx([0.0, 1.0, 0.0, 0.0], abs=1e-12)


def test_units_and_frames_do_not_matter(rng):
    places, center = rng.normal(size=(20, 2)), np.array([0.5, 0.3])
    share = share_load(places, 1.0, center).normal_force
    small = share_load(1e-6 * places, 1e-8, 1e-6 * center).normal_force
    assert small == pytest.approx(1e-8 * share, rel=1e-9, abs=1e-21)
    shift = np.array([7.0, -2.0])
    moved = share_load(places + shift, 1.0, center + shift).normal_force
    assert moved == pytest.approx(share, abs=1e-12)


@pytest.mark.parametrize("center", [(1.0 + 1e-9, 0.0), (5.0, 5.0), (0.0, -1.5)])
def test_a_centre_of_mass_outside_the_supports_is_named(center):
    for supports, rule in ((LEGS, "minimum-norm"), (LEGS[:3], "three-point")):
        with pytest.raises(
            OutsideSupports, match="centre of mass is outside the supports"
        ) as found:
            share_load(supports, 1.0, center, rule)
        assert isinstance(found.value, LimitSurfError)
        assert found.value.center_of_mass == center
        nearest = np.clip(center, -1.0, 1.0)
        if rule == "minimum-norm":
            assert found.value.distance == pytest.approx(np.linalg.norm(center - nearest))


def test_three_points_are_exact(rng):
    for _ in range(20):
        places = rng.normal(size=(3, 2))
        shares = rng.dirichlet([1.0, 1.0, 1.0])
        share = share_load(places, 3.0, shares @ places, "three-point")
        assert share.normal_force == pytest.approx(3.0 * shares, abs=1e-13)
        least = share_load(places, 3.0, shares @ places).normal_force
        assert least == pytest.approx(3.0 * shares, abs=1e-11)
    over_an_edge = share_load([[0, 0], [1, 0], [0, 1]], 2.0, [0.25, 0.0], "three-point")
    assert over_an_edge.normal_force == pytest.approx([1.5, 0.5, 0.0])


def test_equal_loads_say_which_moments_they_leave():
    share = share_load(LEGS, 4.0, [0.25, 0.0], "equal")
    assert share.normal_force == pytest.approx([1.0] * 4)
    assert share.imbalance == pytest.approx([0.0, -1.0, 0.0])
    assert share_load(LEGS, 4.0, rule="equal").residual == 0.0


def test_air_takes_weight_off():
    for rule in ("equal", "minimum-norm"):
        share = share_load(LEGS, 4.0, rule=rule, lift=0.75)
        assert share.carried == 1.0
        assert share.normal_force == pytest.approx([0.25] * 4)
        assert share_load(LEGS, 4.0, rule=rule, lift=1.0).normal_force == pytest.approx([0.0] * 4)


def test_given_loads_are_checked():
    given = share_load(LEGS, 4.0, rule=[2.0, 0.0, 2.0, 0.0])
    assert given.rule == "given"
    assert given.normal_force == pytest.approx([2.0, 0.0, 2.0, 0.0])
    for loads in ([1, 1, 1, 2], [2, 2, 0, 0], [3, -1, 3, -1], [1, 1, 1], [1, 1, 1, np.nan]):
        with pytest.raises(InputError) as found:
            share_load(LEGS, 4.0, rule=loads)
        assert found.value.argument == "rule"


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"weight": -1.0}, "weight"),
        ({"weight": np.inf}, "weight"),
        ({"weight": "4 N"}, "weight"),
        ({"lift": "half"}, "lift"),
        ({"lift": 1.5}, "lift"),
        ({"lift": np.nan}, "lift"),
        ({"rule": "fair"}, "rule"),
        ({"rule": "three-point"}, "positions"),
        ({"positions": [[0, 0], [1, 1], [2, 2]], "rule": "three-point"}, "positions"),
        ({"positions": np.empty((0, 2))}, "positions"),
        ({"positions": np.zeros((4, 3))}, "positions"),
        ({"center_of_mass": [0.0]}, "center_of_mass"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    with pytest.raises(InputError) as found:
        share_load(**({"positions": LEGS, "weight": 1.0} | changed))
    assert found.value.argument == argument


def test_a_hundred_thousand_supports(rng):
    places = rng.uniform(-1.0, 1.0, (100_000, 2))
    share = share_load(places, 1.0, [0.4, -0.2])
    assert share.residual <= 1e-12
    assert share.iterations < 20
    assert "minimum-norm" in repr(share)


def awkward(rng, kind, n):
    """Return grids with ties, lines, thin strips, clusters with an outlier, and any scale."""
    places = rng.normal(size=(n, 2))
    if kind == "grid":
        return rng.integers(-3, 4, (n, 2)).astype(float)
    if kind == "line":
        return np.outer(rng.normal(size=n), [0.3, -0.7]) + np.array([2.0, 1.0])
    if kind == "strip":
        return places * np.array([1.0, 1e-6]) @ np.array([[0.6, 0.8], [-0.8, 0.6]])
    if kind == "cluster":
        return np.vstack([1e-4 * places, rng.normal(size=(1, 2))])
    return 10.0 ** rng.uniform(-9, 9) * places


@pytest.mark.parametrize("kind", ["grid", "line", "strip", "cluster", "any scale"])
def test_awkward_supports_balance_too(rng, kind):
    for _ in range(300):
        places = awkward(rng, kind, int(rng.integers(1, 40)))
        some = rng.dirichlet(np.full(len(places), 10.0 ** rng.uniform(-1, 1)))
        share = share_load(places, 1.0, some @ places)
        assert share.residual <= 5e-12
        assert share.normal_force @ share.normal_force <= some @ some * (1 + 1e-8)


def test_nothing_to_carry_is_no_error():
    for rule in ("minimum-norm", "three-point"):
        assert not share_load(LEGS[:3], 1.0, [9.0, 9.0], rule, lift=1.0).normal_force.any()
