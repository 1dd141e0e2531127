"""Measured pushes of a triangle on three feet (Zhou et al. 2016), replayed."""

import csv

import numpy as np
import pytest
from bench_pushes import STUCK, errors, finger_path, touched_path
from zhou2016 import read_pushes, rotation

from limitsurf.datasets.zhou2016 import CENTROID, MASS, SUPPORTS, three_feet
from tests.measured_data import measured_pushes


@pytest.fixture(scope="module")
def data():
    return measured_pushes()


@pytest.fixture(scope="module")
def replayed(data):
    return {support: errors(support, touched_path, lambda push: True) for support in SUPPORTS}


def mean_sizes(e):
    return np.abs(e).mean(axis=1)


@pytest.mark.parametrize("support", SUPPORTS)
def test_the_reader_agrees_with_the_published_pairs(data, support):
    """Displacements in the first body frame, which the authors averaged by their own code."""
    with (data / "pairs.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["support"] == support]
    pushes = read_pushes(support)
    assert len(rows) == len(pushes) == 50
    for row, push in zip(rows, pushes, strict=True):
        moved = rotation(push.before[2]).T @ (push.after[:2] - push.before[:2])
        assert moved == pytest.approx([float(row["dx_m"]), float(row["dy_m"])], abs=1e-7)
        assert push.rotation == pytest.approx(float(row["dtheta_rad"]), abs=1e-6)
        assert np.abs(push.point + CENTROID).max() <= 0.15


@pytest.mark.parametrize("support", SUPPORTS)
def test_feet_carry_the_triangle(support):
    contacts = three_feet(support)
    assert contacts.radius.sum() == pytest.approx(MASS * 9.80665)
    assert contacts.radius @ contacts.position == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("support", "mean", "median"),
    [
        ("10_130_10_10_10_130", 0.449, 0.318),
        ("10_90_10_10_30_130", 0.418, 0.322),
        ("30_63.33_43.33_30_43.33_63.33", 0.676, 0.347),
        ("30_90_30_30_30_90", 0.715, 0.312),
    ],
)
def test_rotations_are_predicted(replayed, support, mean, median):
    """The mean error is a tenth of the rotation, and below that of an ellipsoid for the feet."""
    e = replayed[support]
    three_feet, ellipsoid, none = mean_sizes(e)
    assert three_feet == pytest.approx(mean, abs=0.01)
    assert np.median(np.abs(e[0])) == pytest.approx(median, abs=0.01)
    assert three_feet < 0.12 * none
    assert three_feet < 0.85 * ellipsoid


def test_all_rotations_together(replayed):
    e = np.hstack(list(replayed.values()))
    three_feet, ellipsoid, none = mean_sizes(e)
    assert e.shape == (3, 200)
    assert three_feet < 0.6
    assert three_feet < 0.62 * ellipsoid
    assert three_feet < 0.1 * none


def test_the_finger_alone_predicts_pushes_in_which_it_sticks(data):
    found = [errors(s, finger_path, lambda push: push.slip < STUCK) for s in SUPPORTS]
    e = np.hstack(found)
    three_feet, ellipsoid, none = mean_sizes(e)
    assert e.shape[1] >= 50
    assert three_feet < 0.8 < 0.75 * ellipsoid
    assert three_feet < 0.15 * none


@pytest.mark.parametrize(
    ("ci", "outcome"), [("", pytest.skip.Exception), ("true", pytest.fail.Exception)]
)
def test_missing_data_are_named_and_fail_in_ci(monkeypatch, tmp_path, ci, outcome):
    monkeypatch.setenv("LIMITSURF_DATA", str(tmp_path))
    monkeypatch.setenv("CI", ci)
    with pytest.raises(outcome, match="set LIMITSURF_DATA"):
        measured_pushes()
