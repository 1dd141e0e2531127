import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from limitsurf.fitting.base import angles_between
from limitsurf.fitting.bootstrap import bootstrap
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.sets.ellipsoid import Ellipsoid
from tests.fitting.simulated import pairs_of

BALL = Ellipsoid(np.zeros(3), np.diag([2.0, 2.0, 0.1]))


def blas_threads():
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_fits_use_one_thread_and_leave_the_number_as_it_was():
    seen = set()

    class Watched(EllipsoidModel):
        def _fit(self, pairs):
            seen.update(blas_threads())
            return super()._fit(pairs)

    loads, twists = pairs_of(BALL, 20)
    with threadpool_limits(2, "blas"):
        before = blas_threads()  # there may be a library that knows one thread only
        assert 2 in before
        Watched(0.05).fit(loads, twists)
        bootstrap(Watched(0.05), loads, twists, n=4, n_jobs=2)
        assert seen == {1}
        assert blas_threads() == before


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, np.pi / 2, np.pi - 1e-9, np.pi])
def test_angles_keep_their_digits(angle):
    turned = np.array([[3.0 * np.cos(angle), 3.0 * np.sin(angle), 0.0]])
    assert angles_between(np.array([[0.1, 0.0, 0.0]]), turned) == pytest.approx(angle, rel=1e-7)
