"""The conic programs: recomputed residuals, the two formulations, failures."""

import numpy as np
import pytest
from scipy import sparse

from limitsurf.conic.form import Cone, ConicForm, minkowski_sum, triangle_order, unpacking
from limitsurf.conic.solve import conic_distance, conic_projection, conic_support
from limitsurf.errors import SolveFailed


def half_line():
    """Return ``{x >= 1}`` in one dimension: unbounded."""
    return ConicForm(
        np.eye(1), np.zeros(1), sparse.csc_matrix(np.eye(1)), -np.ones(1), (Cone("nonnegative", 1),)
    )


def ball(n=3):
    A = sparse.csc_matrix(np.vstack([np.zeros((1, n)), np.eye(n)]))
    b = np.concatenate([[1.0], np.zeros(n)])
    return ConicForm(np.eye(n), np.zeros(n), A, b, (Cone("second-order", n + 1),))


def test_projection_and_distance_of_a_ball(rng):
    for p in 3 * rng.normal(size=(5, 3)):
        W = np.diag([1.0, 1.0, 1.0])
        projected, distant = conic_projection(ball(), p, W), conic_distance(ball(), p, W)
        exact = max(np.linalg.norm(p) - 1.0, 0.0)
        assert projected.value == pytest.approx(exact, abs=1e-6)
        assert distant.value == pytest.approx(exact, abs=1e-7)
        for solution in (projected, distant):
            assert solution.residual < 1e-7
            assert solution.gap < 1e-6
            assert solution.iterations > 0


def test_support_of_a_sum():
    solution = conic_support(minkowski_sum([ball(), ball(), ball()]), np.array([3.0, 4.0, 0.0]))
    assert solution.value == pytest.approx(15.0, abs=1e-6)


def test_unbounded_support_fails_with_the_best_point():
    with pytest.raises(SolveFailed, match="unbounded") as caught:
        conic_support(half_line(), np.array([1.0]))
    assert caught.value.best is not None


def test_empty_sets_fail():
    empty = ConicForm(
        np.eye(1),
        np.zeros(1),
        sparse.csc_matrix(np.array([[1.0], [-1.0]])),
        np.array([-1.0, 0.0]),
        (Cone("nonnegative", 2),),
    )
    with pytest.raises(SolveFailed, match="empty"):
        conic_projection(empty, np.zeros(1), np.eye(1))


def test_triangles_unpack_to_symmetric_matrices(rng):
    M = rng.normal(size=(4, 4))
    M = M + M.T
    packed = [M[i, j] * (1 if i == j else np.sqrt(2)) for j in range(4) for i in range(j + 1)]
    assert triangle_order(len(packed)) == 4
    assert (unpacking(4) @ np.array(packed)).reshape(4, 4) == pytest.approx(M)
