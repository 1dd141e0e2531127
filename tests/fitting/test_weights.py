import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.weights import weights_from_noise
from limitsurf.sets.ellipsoid import Ellipsoid
from tests.fitting.simulated import pairs_of

RHO = 0.05


def test_formula_and_unknown_scatter():
    loads = [[3.0, 0.0, 0.2], [3.0, 0.0, 0.2], [0.0, 0.0, 0.0]]  # |F| = 5 N
    found = weights_from_noise(loads, [[0.0, 0.0, 0.05], [np.nan] * 3, [0.0] * 3], RHO, floor=0.1)
    np.testing.assert_allclose(found, [0.25 / (0.25 + 1.0), 1.0, 1.0])


def test_weights_help_where_the_noise_is_known():
    surface = Ellipsoid(np.zeros(3), np.diag([2.0, 1.0, 0.08]))
    loads, twists = pairs_of(surface, 40)
    deviations = np.zeros((40, 3))
    deviations[:20] = [0.5, 0.5, 0.025]
    noisy = loads + deviations * np.random.default_rng(5).normal(size=(40, 3))
    weight = weights_from_noise(noisy, deviations, RHO, floor=0.02)
    clean = pairs_of(surface, 200, seed=1)
    keep = (noisy * twists).sum(axis=1) > 0.0
    options = {"huber": np.inf, "motion_noise": 0.05, "load_noise": 0.05}
    plain = EllipsoidModel(RHO, **options).fit(noisy[keep], twists[keep])
    better = EllipsoidModel(RHO, **options).fit(noisy[keep], twists[keep], weight[keep])
    assert better.score(*clean) > 0.3 * plain.score(*clean)
    assert better.score(*clean) > -0.02


@pytest.mark.parametrize(
    ("deviations", "message"), [([[1.0, 1.0]], "shape"), ([[-1.0, 0.0, 0.0]], "negative")]
)
def test_bad_deviations(deviations, message):
    with pytest.raises(InputError, match=message):
        weights_from_noise([[1.0, 0.0, 0.0]], deviations, RHO)
