"""Sums over a quadtree of moments, against direct sums in long double precision."""

import numpy as np
import pytest

from limitsurf.kernels.moment_series import FORCE_TAIL, SPEED_TAIL
from limitsurf.kernels.moment_tree import tree_sums
from limitsurf.kernels.moment_tree_build import build_moment_tree
from tests.kernels.clouds import clouds, exact_sums, lattice, twists, weights

TOLERANCES = (0.0, 1e-14, 1e-9, 1e-5, 1e-2)


def sums_and_errors(tree, v, skip=-1, tol=1e-9):
    """Return the sums, the errors of g and h, and their bounds."""
    sums = np.full(11, np.nan)
    bounds = tree_sums(tree, np.asarray(v, dtype=float), skip, tol, sums)
    keep = np.arange(len(tree.x)) != skip
    exact = exact_sums(tree.x[keep], tree.y[keep], tree.m[keep], v)
    errors = np.linalg.norm((sums[1:4] - exact[1:4]).astype(float)), abs(float(sums[0] - exact[0]))
    return sums, exact, errors, bounds


@pytest.mark.parametrize("n", [1, 2, 30, 700, 3000])
def test_errors_are_within_their_bounds(rng, n):
    cases = 0
    for name, x, y in clouds(rng, n):
        for m in weights(rng, len(x)):
            tree = build_moment_tree(x, y, m, int(rng.integers(2, 25)), int(rng.choice([1, 8, 64])))
            for kind, v in twists(rng, x, y):
                skip = int(rng.integers(-1, len(x)))
                tol = float(rng.choice(TOLERANCES))
                sums, _, errors, bounds = sums_and_errors(tree, v, skip, tol)
                assert np.all(np.isfinite(sums)), (name, kind)
                assert errors[0] <= bounds[0], (name, kind, tol)
                assert errors[1] <= bounds[1], (name, kind, tol)
                cases += 1
    assert cases == 11 * 3 * 12


@pytest.mark.parametrize("tol", [1e-6, 1e-9, 1e-12])
def test_bounds_meet_the_tolerance(rng, tol):
    x, y = lattice(20000, 0.01)
    x = x + 0.0037  # no contact at the origin
    m = rng.uniform(0.5, 1.0, len(x))
    tree = build_moment_tree(x, y, m, 16, 64)
    arm = np.sqrt(1.0 + np.max(x * x + y * y))
    for kind, v in twists(rng, x, y):
        if "contact" in kind:  # its direction is lost in rounding, and counted
            continue
        _, _, _, bounds = sums_and_errors(tree, v, tol=tol)
        assert bounds[0] <= 2.0 * tol * arm * m.sum(), kind


def test_hessian_is_good_enough_for_newton(rng):
    for name, x, y in clouds(rng, 2000):
        m = rng.uniform(0.5, 1.0, len(x))
        tree = build_moment_tree(x, y, m, 12, 64)
        arm = 1.0 + np.hypot(x, y).max()
        scale = np.array([1, 1, 1, arm, arm, arm * arm, 1])
        for kind, v in twists(rng, x, y):
            if "contact" in kind:
                continue
            sums, exact, _, _ = sums_and_errors(tree, v)
            difference = (sums[4:] - exact[4:]).astype(float) / float(exact[10])
            assert np.max(np.abs(difference) / scale) < 1e-6, (name, kind)


def test_one_contact_left_out_at_the_centre_of_rotation(rng):
    """Without it the others are summed with a small bound; with it, its whole mass is in doubt."""
    x, y = lattice(3000)
    m = rng.uniform(0.5, 1.0, len(x))
    tree = build_moment_tree(x, y, m, 12, 64)
    for i in rng.integers(len(x), size=10):
        v = 0.3 * np.array([tree.y[i], -tree.x[i], 1.0])
        _, _, _, (without, _) = sums_and_errors(tree, v, int(i))
        _, _, _, (with_it, _) = sums_and_errors(tree, v)
        assert without < 1e-7 * m.sum()
        assert with_it >= tree.m[i]


def test_contact_at_rest_adds_nothing():
    x, y, m = np.array([0.0, 1.0]), np.array([0.0, 0.5]), np.array([3.0, 2.0])
    sums, exact, _, _ = sums_and_errors(build_moment_tree(x, y, m), np.array([0.0, 0.0, 1.0]))
    assert sums == pytest.approx(exact.astype(float))
    assert sums[10] == pytest.approx(2.0 / np.hypot(1.0, 0.5))


def test_contacts_far_from_the_centre_of_rotation_are_not_visited():
    x, y = lattice(40000, 0.005)
    tree = build_moment_tree(x, y, np.ones(len(x)), 16, 64)
    visited = tree._replace(x=np.full_like(tree.x, np.nan))  # NaN wherever a contact is summed
    sums = np.empty(11)
    tree_sums(visited, np.array([3.0, 4.0, 1.0]), -1, 1e-9, sums)
    assert np.all(np.isfinite(sums))


@pytest.mark.parametrize("leaf", [1, 7, 64, 10000])
def test_cells_are_ranges_that_hold_their_contacts(rng, leaf):
    for name, x, y in clouds(rng, 1500):
        m = rng.uniform(0.5, 1.0, len(x))
        tree = build_moment_tree(x, y, m, 4, leaf)
        assert np.array_equal(np.sort(tree.permutation), np.arange(len(x)))
        for sorted_, given in ((tree.x, x), (tree.y, y), (tree.m, m)):
            assert np.array_equal(sorted_, given[tree.permutation])
        assert len(tree.cells) <= 4 * len(x)
        for c, (start, end, after) in enumerate(tree.cells):
            px, py, radius = tree.balls[c]
            assert np.hypot(tree.x[start:end] - px, tree.y[start:end] - py).max() <= radius
            if after == c + 1 and end - start > leaf:  # contacts that are one
                assert np.ptp(x[tree.permutation[start:end]]) < 1e-8 * max(np.ptp(x), 1.0), name
            child, covered = c + 1, start
            while child < after:
                assert tree.cells[child, 0] == covered
                covered, child = tree.cells[child, 1], tree.cells[child, 2]
            assert covered in (start if after == c + 1 else end, end)


def test_moments_are_those_of_the_contacts(rng):
    x, y = rng.normal(size=(2, 500)) ** 3
    tree = build_moment_tree(x, y, rng.uniform(0.0, 1.0, 500), 12, 16)
    for (start, end, _), (px, py, radius), moments in zip(
        tree.cells, tree.balls, tree.moments, strict=True
    ):
        d = (tree.x[start:end] - px + 1j * (tree.y[start:end] - py)) / max(radius, 1e-300)
        weight, t = tree.m[start:end], 0
        for n in range(13):
            for low in range(n // 2 + 1):
                expected = np.sum(weight * d ** (n - low) * d.conj() ** low)
                assert moments[0, t] + 1j * moments[1, t] == pytest.approx(
                    expected, abs=1e-13 * max(weight.sum(), 1e-3)
                )
                t += 1


def test_majorants_are_sums_of_moduli():
    """``2 |c_n|`` and ``4 |b_n|`` are the sums over k + l = n of products of binomials."""
    b, c = np.ones(20), np.ones(20)
    for k in range(1, 20):
        b[k], c[k] = b[k - 1] * (1.5 - k) / k, c[k - 1] * (0.5 - k) / k
    b, c = np.abs(b), np.abs(c)
    for n in range(2, 20):
        assert FORCE_TAIL[n] == pytest.approx(np.sum(b[: n + 1] * c[n::-1]))
        assert SPEED_TAIL[n] == pytest.approx(np.sum(b[: n + 1] * b[n::-1]))
    assert np.all(np.diff(FORCE_TAIL[1:]) < 0)
    assert np.all(np.diff(SPEED_TAIL[1:]) < 0)


def test_no_contacts_no_mass_and_no_twist(rng):
    none = np.empty(0)
    tree = build_moment_tree(none, none, none)
    sums, _, _, bounds = sums_and_errors(tree, rng.normal(size=3))
    assert not np.any(sums)
    assert bounds == (0.0, 0.0)
    x, y = rng.normal(size=(2, 500))
    weightless = build_moment_tree(x, y, np.zeros(500))
    sums, _, _, bounds = sums_and_errors(weightless, rng.normal(size=3))
    assert not np.any(sums)
    assert bounds == (0.0, 0.0)
    sums, _, _, bounds = sums_and_errors(build_moment_tree(x, y, np.ones(500)), np.zeros(3))
    assert not np.any(sums)
    assert bounds == (0.0, 0.0)
