"""Piece-by-piece closed forms against quadrature with 30 digits, and drift against a scan."""

import mpmath as mp
import numpy as np
import pytest

from limitsurf.kernels.drift import drift_speeds
from limitsurf.kernels.oscillating import SUMS, tip_sums


def sums_of(u, e, w, N, width=1e-12, blur=0.0):
    out = np.empty((1, SUMS))
    arrays = [np.array([a], dtype=float) for a in (u, e, w, N)]
    tip_sums(arrays[0], np.zeros(1, np.int32), *arrays[1:], width, blur, False, out)
    return out[0]


def along_and_across(u, e):
    (ux, uy), (ex, ey) = map(mp.mpf, u), map(mp.mpf, e)
    return ux * ex + uy * ey, uy * ex - ux * ey


def breaks(a, b, q):
    """Return points of the piece around the nearest approach, closer and closer together."""
    if a == b:
        return [0, 1]
    at, near = -a / (b - a), abs(q / (b - a))
    steps = [mp.mpf(0)] + [near * 10**k for k in range(9)]
    return sorted(
        {mp.mpf(0), mp.mpf(1), *(s for h in steps for s in (at - h, at + h) if 0 < s < 1)}
    )


def quadrature(u, e, w, N):
    """Return Phi, gradient and Hessian by Gauss-Legendre quadrature with 30 digits."""
    mp.mp.dps = 30
    p, q = along_and_across(u, e)
    total = mp.matrix(6, 1)
    for k in range(len(w)):
        a, b = mp.mpf(w[k]) - p, mp.mpf(w[(k + 1) % len(w)]) - p
        Na, Nb = mp.mpf(N[k]), mp.mpf(N[(k + 1) % len(w)])

        def piece(f, a=a, b=b, Na=Na, Nb=Nb):
            def integrand(s):
                x = a + (b - a) * s
                return (Na + (Nb - Na) * s) * f(x, mp.sqrt(x * x + q * q))

            return mp.quad(integrand, breaks(a, b, q)) / len(w)

        total[0] += piece(lambda x, r: r)
        total[1] += piece(lambda x, r: -x / r)
        total[2] += piece(lambda x, r: q / r)
        if q:
            total[3] += piece(lambda x, r: q * q / r**3)
            total[4] += piece(lambda x, r: x * q / r**3)
            total[5] += piece(lambda x, r: x * x / r**3)
    return total


def turned(sums, e):
    """Return sums of the tip's frame in that of e."""
    phi, gp, gq, hpp, hpq, hqq = (float(s) for s in sums)
    R = np.array([[e[0], -e[1]], [e[1], e[0]]])
    g, H = R @ [gp, gq], R @ np.array([[hpp, hpq], [hpq, hqq]]) @ R.T
    return np.array([phi, *g, H[0, 0], H[0, 1], H[1, 1]])


def assert_close(found, exact, force):
    assert found[0] == pytest.approx(exact[0], rel=4e-15)
    assert found[1:3] == pytest.approx(exact[1:3], abs=2e-15 * force)
    assert found[3:] == pytest.approx(exact[3:], abs=4e-15 * np.abs(exact[3:]).max())


@pytest.mark.parametrize("across", [3.0, 0.2, 1e-3, 1e-8])
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e-9])
def test_closed_forms_hold_for_pieces_of_any_length(rng, size, across):
    """Slips of size 1; pieces as long, or far shorter."""
    w, N = 0.3 + size * rng.normal(size=4), rng.uniform(0.0, 1.0, 4)
    N[1] = 0.0
    u = np.array([w[1] + 0.1 * size, across * size])
    exact = turned(quadrature(u, (1.0, 0.0), w, N), (1.0, 0.0))
    assert_close(sums_of(u, (1.0, 0.0), w, N, 1e-9 * size * across), exact, N.mean())


@pytest.mark.parametrize("across", [2.0, 1e-4])
def test_short_pieces_far_away(rng, across):
    w, N = 5.0 + 1e-6 * rng.normal(size=3), rng.uniform(0.0, 1.0, 3)
    u, e = np.array([0.5, across]), np.array([0.6, 0.8])
    assert_close(sums_of(u, e, w, N), turned(quadrature(u, e, w, N), e), N.mean())


def test_equal_samples_and_normal_forces_that_vanish(rng):
    w = np.array([0.5, 0.5, -1.0, 0.0, 0.0])
    N = np.array([1.0, 2.0, 0.0, 0.0, 3.0])
    for u in ([0.5, 0.3], [-1.0, 1e-5], [0.0, -1e-5]):
        exact = turned(quadrature(u, (1.0, 0.0), w, N), (1.0, 0.0))
        assert_close(sums_of(u, (1.0, 0.0), w, N), exact, N.mean())


def test_on_the_tips_line_potential_and_gradient_are_exact(rng):
    w, N = rng.normal(size=5), rng.uniform(0.0, 1.0, 5)
    for p in (0.0, 0.1, w[2], w.max(), 3.0):
        exact = quadrature((p, 0.0), (1.0, 0.0), w, N)
        found = sums_of((p, 0.0), (1.0, 0.0), w, N)
        assert found[0] == pytest.approx(float(exact[0]), rel=4e-15)
        assert found[1] == pytest.approx(float(exact[1]), abs=2e-15)
        assert found[2] == 0.0


def test_the_smoothed_hessian_is_continuous_and_positive(rng):
    w, N, width = rng.normal(size=6), rng.uniform(0.0, 1.0, 6), 1e-3
    for p in (0.1, w[0], 5.0):
        outer = sums_of((p, width), (1.0, 0.0), w, N, width)
        inner = sums_of((p, width * (1 - 1e-9)), (1.0, 0.0), w, N, width)
        assert inner == pytest.approx(outer, rel=1e-6, abs=1e-8)
        for q in (0.0, 0.3 * width, -0.9 * width):
            xx, xy, yy = sums_of((p, q), (1.0, 0.0), w, N, width)[3:]
            assert xx >= 0.0
            assert yy >= 0.0
            assert xx * yy >= xy * xy


def test_a_tip_at_rest_is_smoothed_alike_in_all_directions():
    xx, xy, yy = sums_of((0.0, 0.0), (0.6, 0.8), np.zeros(2), np.full(2, 3.0), 1e-6)[3:]
    assert [xx, xy, yy] == pytest.approx([3e6, 0.0, 3e6], abs=1e-6)


def drift_of(w, N):
    out = np.empty(1)
    drift_speeds(np.array([w], dtype=float), np.array([N], dtype=float), out)
    return out[0]


def test_drift_is_where_the_potential_is_least(rng):
    for _ in range(200):
        K = int(rng.integers(2, 9))
        w, N = rng.normal(size=K).round(int(rng.integers(0, 5))), rng.uniform(0.0, 1.0, K)
        p = drift_of(w, N)
        around = p + np.concatenate([-np.logspace(-7, 0, 8), np.logspace(-7, 0, 8)])
        least = sums_of((p, 0.0), (1.0, 0.0), w, N)[0]
        assert all(sums_of((x, 0.0), (1.0, 0.0), w, N)[0] >= least * (1 - 1e-15) for x in around)


@pytest.mark.parametrize(
    ("w", "N", "drift"),
    [
        ([1.0, 1.0, 1.0, -3.0], [1.0, 1.0, 1.0, 1.0], 1.0),
        ([0.0, 1.0, 0.0, -1.0], [1.0, 1.0, 1.0, 1.0], 0.0),
        ([2.0, 2.0], [1.0, 1.0], 2.0),
        ([1.0, 2.0, 3.0, 2.0], [0.0, 0.0, 0.0, 0.0], 0.0),
        ([3.0, 3.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0], 2.0),
        # no force between 1 and 3, as much above as below: all of [1, 3] will do
        ([3.0, 3.0, 3.0, 1.0, 1.0, 1.0], [0.0, 1.0, 0.0, 0.0, 1.0, 0.0], 1.0),
        ([-3.0, -3.0, -3.0, -1.0, -1.0, -1.0], [0.0, 1.0, 0.0, 0.0, 1.0, 0.0], -1.0),
    ],
)
def test_drift_of_simple_waveforms(w, N, drift):
    assert drift_of(w, N) == pytest.approx(drift, abs=4e-15)  # ties are ties up to 4e-16 of N
