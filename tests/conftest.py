"""Fixtures that several tests share."""

import numpy as np
import pytest

from limitsurf.actuators.actuator_array import load_array
from limitsurf.geometry.part import Part


@pytest.fixture
def rng():
    return np.random.default_rng(20261122)


@pytest.fixture(scope="session")
def paper_t():
    return Part.from_file("paper_t")


@pytest.fixture(scope="session")
def array64():
    return load_array("resonator64")
