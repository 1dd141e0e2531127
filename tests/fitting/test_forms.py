import numpy as np
import pytest

from limitsurf.fitting.forms import form_basis


@pytest.mark.parametrize("degree", [2, 4])
class TestForms:
    def test_derivatives_are_those_of_the_values(self, degree, rng):
        basis, h = form_basis(degree), 1e-5
        x, c = rng.normal(size=(6, 3)), rng.normal(size=len(form_basis(degree).norm))
        for i, e in enumerate(h * np.eye(3)):
            slope = (basis.values(x + e) - basis.values(x - e)) / (2 * h)
            np.testing.assert_allclose(basis.gradients(x)[:, i], slope, rtol=1e-7, atol=1e-8)
            bend = (basis.gradients(x + e) - basis.gradients(x - e)) @ c / (2 * h)
            np.testing.assert_allclose(basis.hessians(x, c)[:, i], bend, rtol=1e-7, atol=1e-8)

    def test_euler(self, degree, rng):
        basis = form_basis(degree)
        x = rng.normal(size=(4, 3))
        along = np.einsum("ni,nik->nk", x, basis.gradients(x))
        np.testing.assert_allclose(along, degree * basis.values(x), rtol=1e-12)

    def test_ball(self, degree, rng):
        basis, x = form_basis(degree), rng.normal(size=(4, 3))
        np.testing.assert_allclose(basis.values(x) @ basis.ball, np.sum(x * x, 1) ** (degree / 2))

    def test_substitution(self, degree, rng):
        basis, x, M = form_basis(degree), rng.normal(size=(4, 3)), rng.normal(size=(3, 3))
        c = rng.normal(size=len(basis.norm))
        new = basis.substituted(c, M)
        np.testing.assert_allclose(basis.values(x) @ new, basis.values(x @ M.T) @ c, rtol=1e-10)

    def test_rotations_keep_the_norm(self, degree, rng):
        basis = form_basis(degree)
        Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        c = rng.normal(size=len(basis.norm))
        turned = basis.substituted(c, Q)
        assert basis.norm @ turned**2 == pytest.approx(basis.norm @ c**2, rel=1e-12)
