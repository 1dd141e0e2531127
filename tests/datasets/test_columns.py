"""Columns by name and unit: in and out of data frames."""

import numpy as np
import pandas as pd
import pytest

from limitsurf.datasets.plausibility import DroppedRows
from limitsurf.datasets.sliding_data import SlidingData
from limitsurf.errors import InputError
from tests.datasets.pairs import NOTES, RHO, same


def test_a_frame_holds_everything_and_gives_it_back(data):
    frame = data.to_frame()
    assert list(frame.columns) == [
        *("fx [N]", "fy [N]", "m [N m]", "vx [m/s]", "vy [m/s]", "omega [rad/s]"),
        *("sd fx [N]", "sd fy [N]", "sd m [N m]"),
    ]
    assert frame.attrs == {"rho": "0.05 m", **NOTES}
    assert same(SlidingData.from_frame(frame), data)
    moved = SlidingData(data.loads, data.twists, RHO, twist_deviations=[1e-3, 1e-3, 0.02])
    assert "sd dtheta [rad]" in moved.to_frame()
    assert same(SlidingData.from_frame(moved.to_frame()), moved)


def test_units_are_converted_and_order_does_not_matter(data):
    si = data.to_frame()
    other = pd.DataFrame(
        {
            "omega [deg/s]": np.degrees(si["omega [rad/s]"]),
            "vy [m/min]": 60.0 * si["vy [m/s]"],
            "VX [mm/s]": 1e3 * si["vx [m/s]"],
            " m [N mm] ": 1e3 * si["m [N m]"],
            "fy[kN]": 1e-3 * si["fy [N]"],
            "fx [N]": si["fx [N]"],
        }
    )
    read = SlidingData.from_frame(other, rho="50 mm")
    assert read.loads == pytest.approx(data.loads, rel=1e-14)
    assert read.twists == pytest.approx(data.twists, rel=1e-14)
    assert read.load_deviations is None
    assert (read.rho, read.motion) == (RHO, "velocity")


def test_deviations_are_found_with_underscores_too(data):
    frame = data.to_frame().rename(columns=lambda title: title.replace("sd ", "sd_"))
    assert same(SlidingData.from_frame(frame), data)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, None])
def test_rows_that_are_not_finite_are_dropped_and_counted(data, bad):
    frame = data.to_frame()
    frame.loc[3, "fx [N]"] = bad
    frame.loc[[3, 7], "omega [rad/s]"] = bad
    with pytest.warns(DroppedRows) as caught:
        read = SlidingData.from_frame(frame)
    assert str(caught[0].message) == (
        "2 of 12 rows dropped, not finite in fx [N] (1), omega [rad/s] (2): row 3, 7"
    )
    assert same(read, data.take(np.delete(np.arange(12), [3, 7])))


def test_a_missing_deviation_drops_its_row(data):
    frame = data.to_frame()
    frame.loc[0, "sd m [N m]"] = np.nan
    with pytest.warns(DroppedRows, match=r"1 of 12 rows dropped, not finite in sd m"):
        assert len(SlidingData.from_frame(frame)) == 11


def test_nothing_left_is_an_error(data):
    frame = data.to_frame()
    frame["fx [N]"] = np.nan
    with pytest.warns(DroppedRows), pytest.raises(InputError, match="rows: are none"):
        SlidingData.from_frame(frame)


@pytest.mark.parametrize(
    ("change", "argument", "message"),
    [
        ({"fx [N]": "fx"}, "fx", "has no unit; write it like fx [N]"),
        ({"fx [N]": "fx [m]"}, "fx [m]", "not in a unit"),
        ({"fx [N]": "fx [Nn]"}, "fx [Nn]", "unknown unit"),
        ({"fx [N]": "fz [N]"}, "fz [N]", "unknown column"),
        ({"fx [N]": "FX [N"}, "FX [N", "unknown column"),
        ({"omega [rad/s]": "omega [rad]"}, "omega [rad]", "not in a unit"),
        ({"vx [m/s]": "dx [m]"}, "columns", "displacements and velocities"),
        ({"sd fx [N]": "fx [mN]"}, "fx [mN]", "twice"),
    ],
)
def test_wrong_titles_are_named(data, change, argument, message):
    with pytest.raises(InputError) as caught:
        SlidingData.from_frame(data.to_frame().rename(columns=change))
    assert caught.value.argument == argument
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("gone", "example"),
    [("m [N m]", r"m: is missing; add a column m \[N m\]"), ("sd fy [N]", "sd fy: is missing")],
)
def test_missing_columns_are_named(data, gone, example):
    with pytest.raises(InputError, match=example):
        SlidingData.from_frame(data.to_frame().drop(columns=gone))


def test_columns_can_be_ignored(data):
    frame = data.to_frame().assign(comment="none", push=range(12))
    with pytest.raises(InputError, match="comment: is an unknown column; ignore it, or name it"):
        SlidingData.from_frame(frame)
    assert same(SlidingData.from_frame(frame, ignore=["comment", "push"]), data)
    assert same(SlidingData.from_frame(frame.drop(columns="push"), ignore="comment"), data)
    with pytest.raises(InputError, match="frame: is no data frame"):
        SlidingData.from_frame([[1.0]])


def test_words_among_numbers_are_named_with_their_row(data):
    frame = data.to_frame().astype(object)
    frame.loc[4, "fy [N]"] = "much"
    with pytest.raises(InputError, match=r"fy \[N\]: is no number in row 4 \(got 'much'\)"):
        SlidingData.from_frame(frame)


def test_rho_must_be_known(data):
    frame = data.to_frame()
    assert SlidingData.from_frame(frame, rho=0.07).rho == 0.07
    frame.attrs = {}
    with pytest.raises(InputError, match="rho: is not known"):
        SlidingData.from_frame(frame)
    with pytest.raises(InputError, match="rho: is not in a unit"):
        SlidingData.from_frame(frame, rho="3 N")
