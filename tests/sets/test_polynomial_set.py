"""Even convex quartics: against 50-digit arithmetic, semidefinite programs and closed forms."""

from itertools import product

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limitsurf.errors import InputError, SolveFailed
from limitsurf.sets.arguments import read_metric
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.linear_image import LinearImage
from limitsurf.sets.polynomial_set import PolynomialSet

QUARTIC = PolynomialSet(
    [[4, 0, 0], [0, 4, 0], [0, 0, 4], [2, 2, 0], [2, 0, 0], [2, 0, 2]],
    [1.0, 2.0, 3.0, 0.5, 0.3, 1.0],
)


FLAT = PolynomialSet([[4, 0], [0, 4]], [1.0, 1.0])  # flat to third order where it meets the axes


def substituted(exponents, coefficients, B):
    """Return the polynomial q(B x), expanded term by term."""
    total = {}
    for e, c in zip(exponents, coefficients, strict=True):
        factors = np.repeat(np.arange(len(e)), e)
        for picks in product(range(B.shape[1]), repeat=len(factors)):
            key = tuple(np.bincount(picks, minlength=B.shape[1]))
            total[key] = total.get(key, 0.0) + c * np.prod(B[factors, list(picks)])
    return PolynomialSet(list(total), list(total.values()))


def random_quartic(rng, n, forms):
    """Return a sum of fourth powers of linear forms and a square, convex and bounded."""
    powers = 4 * np.eye(forms + n, dtype=int)
    powers[forms:] //= 2
    B = np.vstack([rng.normal(size=(forms, n)), 0.3 * np.eye(n)])
    return substituted(powers, np.ones(forms + n), B)


def exact_projection(S, p, W, start):
    """Return the closest point in 50 digits, by Newton's method from a nearby point."""
    E, n = S.exponents.tolist(), S.dim
    c = [mp.mpf(float(v)) for v in S.coefficients]
    W, p = mp.matrix(W.tolist()), [mp.mpf(float(v)) for v in p]

    def term(k, x, i=-1):
        down = [max(e - (j == i), 0) for j, e in enumerate(E[k])]
        factor = c[k] * (E[k][i] if i >= 0 else 1)
        return factor * mp.fprod(x[j] ** down[j] for j in range(n))

    def conditions(*y):
        x = y[:n]
        pull = [mp.fsum(W[i, j] * (p[j] - x[j]) for j in range(n)) for i in range(n)]
        grad = [mp.fsum(term(k, x, i) for k in range(len(E))) for i in range(n)]
        on_boundary = mp.fsum(term(k, x) for k in range(len(E))) - 1
        return [a - y[n] * g for a, g in zip(pull, grad, strict=True)] + [on_boundary]

    x = [mp.mpf(float(v)) for v in start]
    pull = conditions(*x, mp.mpf(0))[:n]
    grad = [a - b for a, b in zip(pull, conditions(*x, mp.mpf(1))[:n], strict=True)]
    shift = mp.fsum(a * b for a, b in zip(pull, grad, strict=True)) / mp.fsum(g**2 for g in grad)
    return mp.findroot(conditions, [*x, shift], tol=mp.mpf(10) ** -70, maxsteps=50)[:n]


def exact_error(S, p, W):
    """Return the error of a projection and its certified bound, in the norm of W."""
    with mp.workdps(50):
        projection = S.project(p, metric=W)
        e = [
            mp.mpf(float(a)) - b
            for a, b in zip(
                projection.point, exact_projection(S, p, W, projection.point), strict=True
            )
        ]
        square = mp.fsum(
            e[i] * mp.mpf(float(W[i, j])) * e[j] for i in range(S.dim) for j in range(S.dim)
        )
        return float(mp.sqrt(square)), float(projection.error_bound)


def values(S, x):
    powers = np.prod(x[..., None, :] ** S.exponents, axis=-1)
    return powers @ S.coefficients


def gradient(S, x):
    down = np.maximum(S.exponents - np.eye(S.dim, dtype=int)[:, None], 0)
    powers = np.prod(x[..., None, None, :] ** down, axis=-1)
    return np.einsum("...ik,ki,k->...i", powers, S.exponents, S.coefficients)


def test_a_quadratic_is_an_ellipsoid(rng):
    A = np.diag([2.0, 1.0, 0.5])
    inverse = np.linalg.inv(A @ A.T)
    exponents, coefficients = [], []
    for i in range(3):
        for j in range(i, 3):
            exponents.append(np.eye(3, dtype=int)[i] + np.eye(3, dtype=int)[j])
            coefficients.append(inverse[i, j] * (1 if i == j else 2))
    S, E = PolynomialSet(exponents, coefficients), Ellipsoid(np.zeros(3), A)
    p = 3 * rng.normal(size=(30, 3))
    assert S.project(p).point == pytest.approx(E.project(p).point, abs=1e-12)
    d = rng.normal(size=(5, 3))
    assert S.support(d) == pytest.approx(E.support(d), rel=1e-14)
    assert S.support_point(d) == pytest.approx(E.support_point(d), abs=1e-13)


def test_closest_points_lie_on_the_surface_along_the_gradient(rng):
    p = 4 * rng.normal(size=(100, 3))
    projection = QUARTIC.project(p)
    outside = values(QUARTIC, p) > 1
    assert np.array_equal(outside, ~projection.inside)
    x = projection.point[outside]
    assert values(QUARTIC, x) == pytest.approx(np.ones(len(x)), abs=1e-13)
    normal = gradient(QUARTIC, x)
    cosine = np.einsum("ij,ij->i", normal, p[outside] - x)
    lengths = np.linalg.norm(normal, axis=1) * np.linalg.norm(p[outside] - x, axis=1)
    assert cosine == pytest.approx(lengths, rel=1e-14)
    assert projection.error_bound.max() < 1e-13 * 40


def test_far_and_near_points(rng):
    for size in (1e-6, 1.0001, 1e3, 1e6):
        p = size * rng.normal(size=(20, 3))
        projection = QUARTIC.project(p)
        assert np.all(projection.error_bound <= 1e-12 * (1 + np.abs(p).max()))


def test_the_moment_form_is_exact(rng):
    """Support by the semidefinite program and by Newton, against a scan of the surface."""
    d = rng.normal(size=3)
    u = rng.normal(size=(200000, 3))
    a = (u**2 * [0.3, 0, 0]).sum(axis=1)
    b = values(QUARTIC, u) - a
    s = np.sqrt(2 / (a + np.sqrt(a * a + 4 * b)))
    scan = (s[:, None] * u @ d).max()
    assert QUARTIC.support(d) == pytest.approx(scan, rel=1e-3)
    assert QUARTIC.support(d) >= scan
    slow = ConvexSet._support_points(QUARTIC, d[None])[0]
    assert slow @ d == pytest.approx(QUARTIC.support(d), abs=1e-6)


def test_convexity_is_certified():
    assert QUARTIC.convexity_margin > -1e-7
    convex = PolynomialSet([[4, 0], [2, 2], [0, 4]], [1.0, 6.0, 1.0])  # on the edge of convexity
    assert convex.convexity_margin == pytest.approx(0.0, abs=1e-6)
    for c in (6.2, -0.1):
        with pytest.raises(InputError, match="no certificate of convexity"):
            PolynomialSet([[4, 0], [2, 2], [0, 4]], [1.0, c, 1.0])


@pytest.mark.parametrize("metric", ["identity", "diagonal", "graded", "full"])
def test_projection_against_50_digits(metric, rng):
    for k in range(8):
        L = np.eye(3) + 0.4 * rng.normal(size=(3, 3))
        W = {
            "identity": np.eye(3),
            "diagonal": np.diag([1.0, 2.0, 3.0]),
            "graded": np.diag([1.0, 1.0, 1e4]),
            "full": L.T @ L,
        }[metric]
        p = QUARTIC.support_point(rng.normal(size=3)) * (1.0 + 10.0 ** (k - 4))
        error, bound = exact_error(QUARTIC, p, W)
        assert error <= 1e-15 * np.sqrt(p @ W @ p)
        assert error <= bound <= 1e-13 * np.sqrt(p @ W @ p)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 3), st.integers(1, 4))
def test_bounds_are_never_below_the_true_error(seed, n, forms):
    rng = np.random.default_rng(seed)
    S = random_quartic(rng, n, forms)
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0] * 10.0 ** rng.uniform(-2, 2, size=n)
    d = rng.normal(size=n)
    p = S.support_point(d) * (1.0 + 10.0 ** rng.uniform(-12, 4))
    error, bound = exact_error(S, p, turn @ turn.T)
    assert error <= bound


def test_projection_in_a_metric_is_that_of_the_semidefinite_program(rng):
    p = 3 * rng.normal(size=(3, 3))
    W = read_metric(np.array([1.0, 2.0, 3.0]), 3)
    fast, slow = QUARTIC.project(p, metric=W.W), ConvexSet._project(QUARTIC, p, W)
    assert fast.point == pytest.approx(slow.point, abs=1e-4)
    assert fast.distance == pytest.approx(ConvexSet._distances(QUARTIC, p, W), abs=1e-6)
    assert np.all(slow.status == fast.status)


def test_support_points_have_their_normal(rng):
    """x is the support point along grad q(x) exactly, as far as q(x) = 1."""
    for S in (QUARTIC, FLAT, random_quartic(rng, 3, 3)):
        x = S.support_point(rng.normal(size=(50, S.dim)))
        assert values(S, x) == pytest.approx(np.ones(50), abs=1e-12)
        normal = gradient(S, x)
        assert S.support_point(normal) == pytest.approx(x, abs=1e-12)
        assert S.support(normal) == pytest.approx(np.einsum("ij,ij->i", normal, x), rel=1e-14)
    assert np.array_equal(QUARTIC.support_point(np.zeros(3)), np.zeros(3))


@pytest.mark.parametrize("slope", [0.0, 1e-15, 1e-9, 1e-3, 1.0])
def test_support_where_the_boundary_is_flat(slope):
    """On x^4 + y^4 = 1 the normal (1, a) holds at y = a^(1/3) x."""
    y = np.cbrt(slope)
    expected = np.array([1.0, y]) / (1.0 + y**4) ** 0.25
    assert FLAT.support_point([1.0, slope]) == pytest.approx(expected, abs=1e-15)
    assert FLAT.face([1.0, slope]).rank == 0


def test_units_do_not_matter(rng):
    """Loads in SI units are small: 1e-7 N, 1e-11 N m."""
    units = np.array([1e-7, 1e-7, 1e-11])
    small = PolynomialSet(
        QUARTIC.exponents, QUARTIC.coefficients / np.prod(units**QUARTIC.exponents, axis=1)
    )
    assert small.convexity_margin == pytest.approx(QUARTIC.convexity_margin, rel=1.0)
    p = 3 * rng.normal(size=(20, 3))
    projection = small.project(units * p, metric=units**-2.0)
    assert projection.point / units == pytest.approx(QUARTIC.project(p).point, abs=1e-14)
    assert projection.error_bound.max() < 1e-13 * 10
    slow = ConvexSet._support_points(small, p[:3] / units)
    assert np.einsum("ij,ij->i", slow, p[:3] / units) == pytest.approx(QUARTIC.support(p[:3]))
    with pytest.raises(InputError, match="no certificate"):  # however small its last coordinate
        PolynomialSet([[4, 0], [2, 2], [0, 4]], [1.0, 6.2e-8, 1e-16])


def test_images_are_those_of_the_expanded_polynomial(rng):
    """An image is projected through its preimage; expanding the polynomial is the slow twin."""
    M = np.eye(3) + 0.2 * rng.normal(size=(3, 3))
    c = np.array([0.3, -0.2, 0.5])
    image = LinearImage(M, QUARTIC, c)
    slow = substituted(QUARTIC.exponents, QUARTIC.coefficients, np.linalg.inv(M))
    p, W = 4 * rng.normal(size=(30, 3)), np.array([1.0, 3.0, 10.0])
    for metric in (None, W):
        fast, twin = image.project(p + c, metric=metric), slow.project(p, metric=metric)
        assert fast.point - c == pytest.approx(twin.point, abs=1e-13)
        assert image.distance(p + c, metric=metric) == pytest.approx(twin.distance, abs=1e-13)
        assert np.all(fast.error_bound <= 1e-11)
        assert np.array_equal(fast.inside, twin.inside)
        assert np.array_equal(fast.point[fast.inside], (p + c)[fast.inside])
    assert image.support(p) == pytest.approx(slow.support(p) + p @ c, abs=1e-12)


def test_images_that_cannot_be_pulled_back_go_through_the_conic_form(rng):
    for M in (np.array([[1.0, 0, 0], [0, 1, 0], [1, 1, 0]]), np.array([[1.0, 0, 2], [0, 1, 0]])):
        image = LinearImage(M, QUARTIC)
        p = 4 * rng.normal(size=(3, len(M)))
        e = p - image.project(p).point
        gap = image.support(e) - np.einsum("ij,ij->i", e, p - e)
        assert np.abs(gap).max() < 1e-3


def test_support_that_does_not_converge_raises(monkeypatch):
    def stop_early(directions, exponents, c, farthest, residual):
        farthest[:], residual[:] = 0.0, 1e-3

    monkeypatch.setattr("limitsurf.sets.polynomial_set.support_on_polynomial", stop_early)
    with pytest.raises(SolveFailed, match="support"):
        QUARTIC.support_point([1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("exponents", "coefficients", "problem"),
    [
        ([[3, 0]], [1.0], "exponents"),
        ([[1, 1]], [1.0], "no certificate"),
        ([[4.5, -0.5]], [1.0], "exponents"),
        ([[4, 0]], [1.0], "unbounded"),
        ([[4, 0], [0, 4]], [1.0], "coefficients: has shape"),
        ([[4, 0], [0, 4]], [1.0, np.nan], "not finite"),
        (np.empty((0, 2)), [], "exponents"),
    ],
)
def test_bad_polynomials(exponents, coefficients, problem):
    with pytest.raises(InputError, match=problem):
        PolynomialSet(exponents, coefficients)
