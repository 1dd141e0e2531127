"""Loads as tables: values, rates, hulls, loads that are no loads."""

import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.kernels.load_table import load_at
from limitsurf.motion.load_table import LoadTable


def swinging(t):
    return np.sin(40 * t), 0.1 * np.cos(90 * t + 1), 1e-6 * np.sin(3 * t) ** 3


def rate_of_swinging(t):
    return 40 * np.cos(40 * t), -9 * np.sin(90 * t + 1), 9e-6 * np.sin(3 * t) ** 2 * np.cos(3 * t)


def test_a_table_agrees_with_its_load(rng):
    table = LoadTable(swinging, 2.0)
    for t in rng.uniform(0, 2, 200):
        assert table(t) == pytest.approx(swinging(t), rel=0, abs=1e-10)
        assert table(t)[2] == pytest.approx(swinging(t)[2], rel=0, abs=1e-16)


def test_rates_are_derivatives(rng):
    table = LoadTable(swinging, 2.0)
    for t in rng.uniform(0, 2, 100):
        assert load_at(table.kernel, t)[1] == pytest.approx(rate_of_swinging(t), rel=0, abs=1e-7)


def test_a_load_stays_within_its_bernstein_coefficients(rng):
    table = LoadTable(swinging, 2.0)
    rows, n = table.kernel.pieces, table.kernel.terms
    for row in rows[:: len(rows) // 10]:
        points = row[2 + 3 * n :].reshape(3, n)
        for t in np.linspace(row[0], row[1], 50):
            F = np.array(swinging(t))
            slack = 1e-9 * table.largest
            assert (points.min(axis=1) <= F + slack).all()
            assert (points.max(axis=1) >= F - slack).all()
    assert (table.largest >= [0.999, 0.1 * 0.999, 0.99e-6]).all()


def test_pieces_follow_one_another():
    pieces = LoadTable(swinging, 2.0).kernel.pieces
    assert pieces[0, 0] == 0.0
    assert pieces[-1, 1] == pytest.approx(2.0, rel=1e-15)
    assert pieces[1:, 0] == pytest.approx(pieces[:-1, 1], rel=1e-14)


def test_constant_loads_are_one_piece():
    assert LoadTable(None, 1.0).steady
    assert not LoadTable(None, 1.0)(0.3).any()
    assert LoadTable([1.0, 2.0, 3.0], 1.0)(0.3).tolist() == [1.0, 2.0, 3.0]
    assert LoadTable.of(LoadTable([1.0, 2.0, 3.0], 1.0), 5.0)(4.0).tolist() == [1.0, 2.0, 3.0]


def test_a_load_may_have_a_kink():
    table = LoadTable(lambda t: (abs(t - 0.3), 0.0, 0.0), 1.0)
    assert table(0.3)[0] == pytest.approx(0.0, abs=1e-9)
    assert table(0.31)[0] == pytest.approx(0.01, abs=1e-9)


def test_a_load_must_not_jump():
    with pytest.raises(InputError, match=r"not smooth near t = 0\.3.*split the motion"):
        LoadTable(lambda t: (float(t > 0.3), 0.0, 0.0), 1.0)


@pytest.mark.parametrize(
    ("load", "problem"),
    [
        (lambda t: (0.0, 0.0), "three"),
        (lambda t: "push", "three numbers"),
        (lambda t: (np.nan, 0.0, 0.0), "finite"),
        ([1.0, 2.0], "shape"),
        ([np.inf, 0.0, 0.0], "not finite"),
    ],
)
def test_loads_that_are_none(load, problem):
    with pytest.raises(InputError, match=problem):
        LoadTable(load, 1.0)


def test_a_table_must_be_long_enough():
    table = LoadTable(swinging, 1.0)
    assert LoadTable.of(table, 0.5) is table
    with pytest.raises(InputError, match=r"table of 1 s; make one for 2 s"):
        LoadTable.of(table, 2.0)
