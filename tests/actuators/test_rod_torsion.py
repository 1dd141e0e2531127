import numpy as np
import pytest
from scipy.sparse import diags, identity, kron
from scipy.sparse.linalg import spsolve

from limitsurf.actuators.rod_torsion import rod_stiffness, torsion_constant


@pytest.mark.parametrize(
    ("ratio", "coefficient"),
    [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (10.0, 0.312), (1e6, 1 / 3)],
)
def test_table_of_timoshenko_and_goodier(ratio, coefficient):
    """Theory of Elasticity, 3rd ed., section 109: k1 in k1 h w^3."""
    assert torsion_constant(1.0, ratio) / ratio == pytest.approx(coefficient, abs=5e-4)


def test_either_side_may_be_the_longer():
    assert torsion_constant(1.0, 3.0) == pytest.approx(float(torsion_constant(3.0, 1.0)), rel=1e-9)


def by_finite_differences(width, height, tall, flat, n):
    """Return the torque per twist: Prandtl's function of an orthotropic section on a grid."""
    dy, dz = width / n, height / n
    second = diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n - 1, n - 1))
    eye = identity(n - 1)
    operator = kron(second / dy**2, eye) / tall + kron(eye, second / dz**2) / flat
    phi = spsolve(operator.tocsc(), np.full((n - 1) ** 2, -2.0))
    return 2.0 * phi.sum() * dy * dz


@pytest.mark.parametrize(("tall", "flat"), [(79.6, 79.6), (79.6, 50.9), (50.9, 79.6)])
@pytest.mark.parametrize("height", [1.0, 3.0])
def test_crystals_equal_a_finite_difference_solution(tall, flat, height):
    coarse, fine = (by_finite_differences(1.0, height, tall, flat, n) for n in (40, 80))
    expected = fine + (fine - coarse) / 3  # errors go with the square of the mesh
    assert tall * torsion_constant(1.0, height, flat / tall) == pytest.approx(expected, rel=2e-5)


def test_stiffness_of_a_length():
    assert rod_stiffness(1.0, 3.0, 2.0, 5.0) == pytest.approx(2.5 * torsion_constant(1.0, 3.0))
