import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.polynomial_set import PolynomialSet

QUARTIC = PolynomialSet(
    [[4, 0, 0], [0, 4, 0], [0, 0, 4], [2, 2, 0], [2, 0, 0], [2, 0, 2]],
    [1.0, 2.0, 3.0, 0.5, 0.3, 1.0],
)


def values(S, x):
    powers = np.prod(x[..., None, :] ** S.exponents, axis=-1)
    return powers @ S.coefficients


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
    assert S.support(d) == pytest.approx(E.support(d), rel=1e-6)


def test_closest_points_lie_on_the_surface_along_the_gradient(rng):
    p = 4 * rng.normal(size=(100, 3))
    projection = QUARTIC.project(p)
    outside = values(QUARTIC, p) > 1
    assert np.array_equal(outside, ~projection.inside)
    x = projection.point[outside]
    assert values(QUARTIC, x) == pytest.approx(np.ones(len(x)), abs=1e-13)
    h = 1e-6
    gradient = np.stack(
        [(values(QUARTIC, x + h * e) - values(QUARTIC, x - h * e)) / (2 * h) for e in np.eye(3)], -1
    )
    cosine = np.einsum("ij,ij->i", gradient, p[outside] - x)
    lengths = np.linalg.norm(gradient, axis=1) * np.linalg.norm(p[outside] - x, axis=1)
    assert cosine == pytest.approx(lengths, rel=1e-8)
    assert projection.error_bound.max() < 1e-13 * 40


def test_far_and_near_points(rng):
    for size in (1e-6, 1.0001, 1e3, 1e6):
        p = size * rng.normal(size=(20, 3))
        projection = QUARTIC.project(p)
        assert np.all(projection.error_bound <= 1e-12 * (1 + np.abs(p).max()))


def test_the_moment_form_is_exact(rng):
    """Support by the semidefinite program, against a dense scan of the surface."""
    d = rng.normal(size=3)
    u = rng.normal(size=(200000, 3))
    a = (u**2 * [0.3, 0, 0]).sum(axis=1)
    b = values(QUARTIC, u) - a
    s = np.sqrt(2 / (a + np.sqrt(a * a + 4 * b)))
    scan = (s[:, None] * u @ d).max()
    assert QUARTIC.support(d) == pytest.approx(scan, rel=2e-3)
    assert QUARTIC.support(d) >= scan - 1e-6


def test_convexity_is_certified():
    assert QUARTIC.convexity_margin > -1e-7
    convex = PolynomialSet([[4, 0], [2, 2], [0, 4]], [1.0, 6.0, 1.0])  # on the edge of convexity
    assert convex.convexity_margin == pytest.approx(0.0, abs=1e-6)
    for c in (6.2, -0.1):
        with pytest.raises(InputError, match="no certificate of convexity"):
            PolynomialSet([[4, 0], [2, 2], [0, 4]], [1.0, c, 1.0])


def test_metric_goes_through_the_conic_form(rng):
    p = 3 * rng.normal(size=(3, 3))
    W = np.diag([1.0, 2.0, 3.0])
    x = QUARTIC.project(p, metric=W).point
    y = ConvexSet._support_points(QUARTIC, (p - x) @ W)
    gap = np.einsum("ij,ij->i", (p - x) @ W, y - x)
    assert np.all(np.abs(gap) < 1e-3)


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
