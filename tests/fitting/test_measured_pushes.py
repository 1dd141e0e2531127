"""Held-out errors on the measured pushes, against those that their authors published."""

import numpy as np
import pytest

from limitsurf.datasets.zhou2016 import RHO, SUPPORTS, load_zhou2016
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.quartic_model import QuarticModel
from tests.measured_data import measured_pushes

SPLITS, SIZES = 15, (5, 10, 20, 30)
PUBLISHED = {EllipsoidModel: (17.4, 15.7, 14.1, 13.7), QuarticModel: (16.3, 13.5, 12.2, 12.2)}


def supports():
    """Return loads and motions (50, 3) of each three-foot support."""
    triangles = load_zhou2016(measured_pushes(), SUPPORTS).values()
    return [(triangle.data.loads, triangle.data.twists) for triangle in triangles]


@pytest.mark.slow
@pytest.mark.parametrize("model", [EllipsoidModel, QuarticModel])
def test_held_out_errors_are_no_larger_than_the_published(model):
    errors = np.zeros((4, SPLITS, len(SIZES)))
    for k, (loads, twists) in enumerate(supports()):
        for split in range(SPLITS):
            order = np.random.default_rng([k, split]).permutation(50)
            held = order[30:]
            for j, n in enumerate(SIZES):
                fit = model(RHO).fit(loads[order[:n]], twists[order[:n]])
                errors[k, split, j] = -np.degrees(fit.score(loads[held], twists[held]))
    assert (errors.mean(axis=(0, 1)) < PUBLISHED[model]).all()


def test_five_pushes_that_leave_the_quartic_open_are_drawn_to_the_prior():
    loads, twists = supports()[0]
    seen = [27, 16, 32, 25, 33]
    fit = QuarticModel(RHO).fit(loads[seen], twists[seen])
    assert fit.shrinkage_ == 10.0
    assert -np.degrees(fit.score(loads, twists)) < 20.0
