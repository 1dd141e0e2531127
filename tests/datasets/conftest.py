"""Fixtures of the datasets' tests."""

import numpy as np
import pytest

from limitsurf.datasets.sliding_data import SlidingData
from tests.datasets.pairs import NOTES, RHO


@pytest.fixture
def data(rng):
    scale = np.array([1.0, 1.0, RHO])
    loads = rng.normal(size=(12, 3)) * scale
    twists = rng.normal(size=(12, 3)) / scale
    sd = np.abs(loads) / 7.0
    return SlidingData(loads, twists, RHO, load_deviations=sd, motion="velocity", **NOTES)
