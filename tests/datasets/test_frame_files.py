"""CSV and parquet files of pairs: whole, exact, and with errors that say where."""

import sys

import numpy as np
import pandas as pd
import pytest

from limitsurf.datasets.plausibility import DroppedRows
from limitsurf.datasets.sliding_data import SlidingData, read_sliding_data
from limitsurf.errors import DataError, InputError
from tests.datasets.pairs import same

GOOD = """\
# rho: 50 mm
# name: three pushes
# drawn by hand
fx [N],fy [N], m [N mm],dx [mm],dy [mm],dtheta [deg]
1, 2, 3, 4, 5, 6

-1,0.5,1e1,0,2,1

0,1,2,3,4,5
"""


@pytest.fixture
def csv(tmp_path):
    def write(text):
        path = tmp_path / "pushes.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.mark.parametrize("suffix", ["csv", "parquet", "CSV"])
def test_files_give_back_the_very_same_numbers(data, tmp_path, suffix):
    path = tmp_path / f"pairs.{suffix}"
    data.write(path)
    assert same(read_sliding_data(path), data)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_file_by_hand(csv):
    read = read_sliding_data(csv(GOOD))
    assert read.loads.tolist() == [[1, 2, 0.003], [-1, 0.5, 0.01], [0, 1, 0.002]]
    assert read.twists == pytest.approx(
        np.array(
            [[4e-3, 5e-3, np.radians(6)], [0, 2e-3, np.radians(1)], [3e-3, 4e-3, np.radians(5)]]
        )
    )
    assert (read.rho, read.name, read.motion) == (0.05, "three pushes", "displacement")


def test_other_ends_of_lines_and_a_byte_order_mark(csv):
    path = csv("")
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert same(read_sliding_data(path), read_sliding_data(csv(GOOD)))


def test_gaps_are_dropped_by_line(csv):
    with pytest.warns(DroppedRows, match=r"2 of 3 rows dropped, not finite in .*: line 5, 7"):
        read = read_sliding_data(csv(GOOD.replace("1, 2, 3", "1, , 3").replace("0.5", "NaN")))
    assert read.loads.tolist() == [[0, 1, 0.002]]


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "message"),
    [
        ("1e1", "ten", 7, "m [N mm]", "is no number"),
        ("1e1", "1e1,7", 7, "", "has 7 entries, not 6"),
        ("1,2,3,4,5\n", "1,2,3,4\n", 9, "", "has 5 entries, not 6"),
        ("fy [N]", "fy", None, "fy", "has no unit"),
        ("50 mm", "50 mN", None, "rho", "is not in a unit"),
        ("# rho: 50 mm", "# rho is 50 mm", None, "rho", "is not known"),
        ("m [N mm]", "m [mm]", None, "m [mm]", "is not in a unit"),
    ],
)
def test_errors_say_where(csv, old, new, line, column, message):
    text = GOOD.replace(old, new)
    assert text != GOOD
    path = csv(text)
    with pytest.raises(DataError, match=message) as caught:
        read_sliding_data(path)
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(path), line, column)
    assert str(path) in str(caught.value)
    assert line is None or f"line {line}" in str(caught.value)


def test_ignored_columns_may_hold_words(csv):
    lines = GOOD.splitlines()
    lines[3:] = [line + (",who" if "fx" in line else ",me") if line else line for line in lines[3:]]
    text = "\n".join(lines)
    with pytest.raises(DataError, match="is no number"):
        read_sliding_data(csv(text))
    assert same(read_sliding_data(csv(text), ignore="who"), read_sliding_data(csv(GOOD)))


@pytest.mark.parametrize("text", ["", "# rho: 1 m\n", "\n\n"])
def test_files_without_a_table(csv, text):
    with pytest.raises(DataError, match="holds no table"):
        read_sliding_data(csv(text))


def test_titles_without_rows(csv):
    path = csv("# rho: 1 m\n" + GOOD.splitlines()[3] + "\n")
    with pytest.raises(DataError, match="rows: are none"):
        read_sliding_data(path)


def test_paths_that_cannot_be_read(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_sliding_data(tmp_path / "none.csv")
    with pytest.raises(DataError, match="cannot be read"):
        read_sliding_data(tmp_path / "none.parquet")
    with pytest.raises(DataError, match="must end in"):
        read_sliding_data(tmp_path / "pairs.xlsx")
    (tmp_path / "bad.parquet").write_bytes(b"no parquet, but some bytes all the same")
    with pytest.raises(DataError, match="is no parquet file"):
        read_sliding_data(tmp_path / "bad.parquet")
    (tmp_path / "bad.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DataError, match="cannot be read"):
        read_sliding_data(tmp_path / "bad.csv")


def test_paths_that_cannot_be_written(data, tmp_path):
    for path in (tmp_path / "pairs.txt", tmp_path / "none" / "pairs.csv", None):
        with pytest.raises(InputError) as caught:
            data.write(path)
        assert caught.value.argument == "path"


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_an_interrupted_write_leaves_the_file_before(data, tmp_path, monkeypatch, suffix):
    path = tmp_path / f"pairs.{suffix}"
    data.write(path)
    before = path.read_bytes()

    def half(frame, target=None, **options):
        if target is not None:
            target.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(pd.DataFrame, f"to_{suffix}", half)
    with pytest.raises(KeyboardInterrupt):
        data.take([0]).write(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_parquet_without_pyarrow_says_what_to_install(data, tmp_path, monkeypatch):
    path = tmp_path / "pairs.parquet"
    data.write(path)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(InputError, match=r"need pyarrow.*limitsurf\[fit\]"):
        data.write(path)
    with pytest.raises(DataError, match=r"need pyarrow.*limitsurf\[fit\]"):
        read_sliding_data(path)


def test_notes_are_one_line():
    with pytest.raises(InputError, match="source: must be one line"):
        SlidingData([[1, 0, 0]], [[1, 0, 0]], 1.0, source="two\nlines")
