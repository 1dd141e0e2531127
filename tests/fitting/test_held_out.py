"""Held-out angles on the measured pushes: the published ones are beaten."""

import bench_held_out
import numpy as np
import pytest

from limitsurf.datasets.zhou2016 import RHO, SUPPORTS
from limitsurf.fitting.contact_model import ContactModel
from tests.measured_data import measured_pushes


@pytest.fixture(scope="module")
def data():
    measured_pushes()
    return bench_held_out.measured_pairs()


def held_out(model, data, n, splits):
    angles = []
    for name in SUPPORTS:
        for seed in range(splits):
            seen, held = bench_held_out.split(n, seed)
            loads, twists = data[name]
            model.fit(loads[seen], twists[seen])
            angles.append(bench_held_out.angle(model, loads[held], twists[held]))
    return np.mean(angles)


@pytest.mark.parametrize(("n", "best"), [(10, 13.5), (30, 12.0)])
def test_contacts_on_a_grid_beat_what_is_published(data, n, best):
    assert held_out(ContactModel(RHO), data, n, 4) < best


@pytest.mark.slow
def test_the_model_chosen_on_the_training_pushes_beats_what_is_published(data):
    for k, n in enumerate(bench_held_out.SIZES):
        angles = []
        for name in SUPPORTS:
            errors, _ = bench_held_out.errors_of_split(name, *data[name], n, 0)
            angles.append(errors[bench_held_out.CHOSEN])
        assert np.mean(angles) < min(row[k] for row in bench_held_out.PUBLISHED.values())
