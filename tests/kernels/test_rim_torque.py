import numpy as np
import pytest
from scipy.integrate import quad

from limitsurf.kernels.rim_torque import RimSide, rim_shape, strip_integral


@pytest.mark.parametrize(
    "u", [-0.99, -0.7, -0.0501, -0.0499, -1e-9, 0.0, 1e-4, 0.0499, 0.0501, 3.0]
)
def test_strip_integral_equals_quadrature(u):
    expected = quad(lambda x: x / (1 + u * x) ** 2, 0, 1, epsabs=0, epsrel=1e-13)[0]
    assert strip_integral(u) == pytest.approx(expected, rel=2e-12)


def test_rim_shape_is_the_torque_of_edge_and_strips():
    side = RimSide(20e-6, 50e-6, 3e-6)
    for tilt in (-0.1, 0.0, 0.07):
        strips = quad(lambda x: x / (3e-6 + x * tilt) ** 2, 0, 20e-6, epsrel=1e-12)[0]  # noqa: B023
        edge = 50e-6 * 20e-6 / (3e-6 + 20e-6 * tilt) ** 2
        assert rim_shape(side, tilt) == pytest.approx(edge + 2 * strips, rel=1e-10)


def test_torque_grows_as_the_gap_closes():
    side = RimSide(25e-6, 50e-6, 3e-6)
    torque = [rim_shape(side, -share * 3e-6 / 25e-6) for share in np.linspace(0, 0.99, 50)]
    assert np.all(np.diff(torque) > 0)
