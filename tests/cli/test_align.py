"""The command: what it writes, and that bad input is one line and leaves nothing behind."""

import json
import re

import numpy as np
import pytest
import shapely
import xarray

from limitsurf.cli.align import _angles
from limitsurf.cli.main import main
from limitsurf.modelfiles import find_model
from limitsurf.planning.alignment import AlignmentPlan

FILES = ("plan.json", "runs.nc", "report.html")
T_SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="4.8mm" height="4.8mm" viewBox="0 0 4 4">'
    '<path d="M0 0 H4 V1 H2.5 V4 H1.5 V1 H0 Z"/></svg>'
)


def run(capsys, *arguments):
    code = main([str(argument) for argument in arguments])
    output = capsys.readouterr()
    return code, output.out, output.err


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Two runs of the same command."""
    folder = tmp_path_factory.mktemp("align")
    (folder / "t.svg").write_text(T_SVG)
    for name in ("one", "two"):
        arguments = ["align", folder / "t.svg", "--array", "resonator64", "--areal-density"]
        arguments += ["80 g/m^2", "--voltage", "50", "--samples", "6", "--seed", "5"]
        assert main([str(a) for a in [*arguments, "--out", folder / name]]) == 0
    return folder


def test_it_writes_plan_runs_and_report_and_nothing_else(finished):
    assert sorted(p.name for p in (finished / "one").iterdir()) == sorted(FILES)
    assert sorted(p.name for p in finished.iterdir()) == ["one", "t.svg", "two"]


def test_the_same_seed_gives_identical_files(finished):
    for name in FILES:
        first, second = ((finished / run / name).read_bytes() for run in ("one", "two"))
        assert first == second, name


def test_plan_and_runs_agree(finished):
    plan = AlignmentPlan.from_json(finished / "one/plan.json")
    with xarray.open_dataset(finished / "one/runs.nc", engine="scipy") as runs:
        assert runs.sizes["run"] == 6
        assert runs.line.values == pytest.approx(plan.lines)
        final = runs.pose.sel(coordinate="theta").isel(stage=-1).values
        error = np.mod(final - plan.final + plan.period / 2, plan.period) - plan.period / 2
        assert runs.orientation_error.values == pytest.approx(error)
        expected = (np.abs(error) <= np.radians(6)) & (runs.outcome.values == 1).all(axis=1)
        assert np.array_equal(runs.success.values, expected)
        assert runs.attrs["voltage_V"] == 50.0
    assert json.loads((finished / "one/plan.json").read_text())["period"] == plan.period


def test_the_report_is_one_page_that_loads_nothing(finished):
    page = (finished / "one/report.html").read_text()
    outside = page.replace(page[page.index("<script>") : page.index("</script>")], "", 1)
    assert not re.search(r'(src|href)="', outside)
    for figure in ("runs", "plan", "robustness", "part", "turn", "squeeze", "errors"):
        assert f'id="{figure}"' in page
    assert "critical angle" in page


def test_the_push_is_computed_or_the_models(capsys):
    table = {}
    for push in ("computed", "model"):
        code, table[push], _ = run(
            capsys, "align", "paper_t", "--array", "resonator64", "--samples", "2", "--push", push
        )
        assert code == 0
    assert "0.157 of friction" in table["computed"]
    assert "0.100 of friction" in table["model"]


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("0, 45, 90 deg", [0, 45, 90]),
        ("0 deg, 45 deg", [0, 45]),
        ("10deg,50deg", [10, 50]),
        ("10deg", [10]),
        ("0.1 rad", [np.degrees(0.1)]),
        ("0.1, 1e-1 rad, -.5e1, 20. degrees", [np.degrees(0.1)] * 2 + [-5, 20]),
        (" 0°, 45° ", [0, 45]),
    ],
)
def test_lists_of_angles(text, degrees):
    assert np.degrees(_angles(text)) == pytest.approx(degrees)


def read_plan(folder):
    return AlignmentPlan.from_json(folder / "plan.json")


def test_given_lines_goal_and_margin(capsys, tmp_path):
    """A plan of given lines ends where it is asked to, and the report says what is left of it."""
    options = ["--lines", "0, 45, 80 deg", "--goal", "170 deg", "--min-margin", "5deg"]
    code, out, _ = run(capsys, "align", "paper_t", *GOOD, *options, "--out", tmp_path / "x")
    assert code == 0
    plan = read_plan(tmp_path / "x")
    assert set(np.round(np.degrees(plan.lines), 9)) <= {0.0, 45.0, 80.0}
    assert np.degrees(plan.final) == pytest.approx(170.0)
    assert np.degrees(plan.least_margin) >= 5.0
    assert "modulo 180 deg" in out
    assert re.search(r"^1 .* (guaranteed|likely|lost) .* s ", out, re.MULTILINE)


@pytest.mark.parametrize("model", ["centred", "push-squeeze", "unknown-offset"])
def test_models(capsys, tmp_path, model):
    array = "resonator128" if model == "push-squeeze" else "resonator64"
    options = ["--array", array, "--samples", "1", "--model", model, "--out", tmp_path / "x"]
    code, out, _ = run(capsys, "align", "paper_t", *options)
    assert code == 0
    plan, page = read_plan(tmp_path / "x"), (tmp_path / "x/report.html").read_text()
    assert plan.model == model
    assert f"<td>{model}</td>" in page
    assert plan.period == pytest.approx(2 * np.pi if model == "push-squeeze" else np.pi)
    # lines of a push-squeeze pass by the centre, about which that error is measured
    assert ("direction error" in out) == (model != "push-squeeze")
    assert ("after centring" in page) == (model != "unknown-offset")


def test_pushes_off_the_normal_are_lost_and_their_time_is_not_known(capsys):
    code, out, _ = run(capsys, "align", "paper_t", *GOOD, "--method", "nearest")
    assert code == 0
    assert re.search(r"^2 .* lost +not known", out, re.MULTILINE)
    assert re.search(r"expected time to align +not known", out)


def test_pieces(capsys, tmp_path):
    part = wkt(tmp_path, TWO)
    code, out, _ = run(capsys, "align", part, "--pieces", *MM)
    assert code == 0
    assert "of 2 runs" in out


def test_the_table(capsys):
    code, out, err = run(
        capsys, "align", "paper-t", "--array", "resonator64", "--samples", "3", "--seed", "1"
    )
    assert code == 0
    for text in ("stable orientations", "margin", "33.67 deg", "success rate", "computing time"):
        assert text in out
    assert err == ""


def bad_model(tmp_path, kind, name, old, new):
    text = find_model(kind, name).read_text()
    assert old in text
    path = tmp_path / f"bad_{kind}.toml"
    path.write_text(text.replace(old, new, 1))
    return path


def wkt(tmp_path, text):
    path = tmp_path / "part.wkt"
    path.write_text(text)
    return path


GOOD = ("--array", "resonator64", "--samples", "2")
MM = ("--unit", "mm", "--areal-density", "80 g/m^2", *GOOD)

TWO = "MULTIPOLYGON (((0 0, 4 0, 4 1, 0 1, 0 0)), ((0 2, 1 2, 1 4, 0 4, 0 2)))"

BAD = {
    "missing file": lambda t: ("nowhere.svg", *GOOD),
    "folder as file": lambda t: (t, *GOOD),
    "self-intersecting": lambda t: (wkt(t, "POLYGON ((0 0, 2 2, 2 0, 0 1, 0 0))"), *MM),
    "empty": lambda t: (wkt(t, "POLYGON EMPTY"), *MM),
    "nan": lambda t: (wkt(t, "POLYGON ((0 0, 1 0, 1 nan, 0 0))"), *MM),
    "zero area": lambda t: (wkt(t, "POLYGON ((0 0, 1 0, 2 0, 0 0))"), *MM),
    "no unit": lambda t: (wkt(t, "POLYGON ((0 0, 1 0, 1 1, 0 0))"), *GOOD),
    "unknown unit": lambda t: (
        wkt(t, "POLYGON ((0 0, 1 0, 1 1, 0 0))"),
        "--unit",
        "parsec2",
        *GOOD,
    ),
    "no density": lambda t: (wkt(t, "POLYGON ((0 0, 4 0, 1 1, 0 0))"), "--unit", "mm", *GOOD),
    "bad density": lambda t: ("paper_t", "--areal-density", "80 parsnip", *GOOD),
    "negative density": lambda t: ("paper_t", "--areal-density=-80 g/m^2", *GOOD),
    "unknown array": lambda t: ("paper_t", "--array", "resonator65"),
    "negative friction": lambda t: (
        "paper_t",
        "--array",
        array_with(t, "value = 0.3", "value = -0.3"),
    ),
    "unknown key": lambda t: ("paper_t", "--array", array_with(t, "[friction]", "[frictoin]")),
    "array too small": lambda t: ("paper_t", "--array", "resonator32"),
    "too heavy": lambda t: ("paper_t", "--voltage", "10", *GOOD),
    "no samples": lambda t: ("paper_t", "--array", "resonator64", "--samples", "0"),
    "samples no number": lambda t: ("paper_t", "--array", "resonator64", "--samples", "many"),
    "voltage no number": lambda t: ("paper_t", "--voltage", "high", *GOOD),
    "margin": lambda t: ("paper_t", "--min-margin", "80 deg", *GOOD),
    "method": lambda t: ("paper_t", "--method", "best", *GOOD),
    "margin no angle": lambda t: ("paper_t", "--min-margin", "1 mm", *GOOD),
    "margin below zero": lambda t: ("paper_t", "--min-margin=-1 deg", *GOOD),
    "model": lambda t: ("paper_t", "--model", "2phase", *GOOD),
    "no lines": lambda t: ("paper_t", "--lines", "", *GOOD),
    "lines without unit": lambda t: ("paper_t", "--lines", "0, 90", *GOOD),
    "lines no list": lambda t: ("paper_t", "--lines", "0,,45 deg", *GOOD),
    "lines without commas": lambda t: ("paper_t", "--lines", "0 45 90 deg", *GOOD),
    "lines no angles": lambda t: ("paper_t", "--lines", "0, 45 mm", *GOOD),
    "lines not finite": lambda t: ("paper_t", "--lines", "nan deg", *GOOD),
    "line twice": lambda t: ("paper_t", "--lines", "0, 180 deg", *GOOD),
    "too few lines": lambda t: ("paper_t", "--lines", "0, 90 deg", *GOOD),
    "goal without unit": lambda t: ("paper_t", "--goal", "30", *GOOD),
    "goal not finite": lambda t: ("paper_t", "--goal", "nan deg", *GOOD),
    "goal out of reach": lambda t: ("paper_t", "--lines", "0, 45 deg", "--goal", "9 deg", *GOOD),
    "margin of a model": lambda t: (
        "paper_t",
        "--model",
        "unknown-offset",
        "--min-margin",
        "30 deg",
        *GOOD,
    ),
    "room for a push": lambda t: ("paper_t", "--model", "push-squeeze", *GOOD),
    "pieces not said": lambda t: (wkt(t, TWO), *MM),
    "neutral": lambda t: (wkt(t, shapely.Point(0, 0).buffer(2, 64).wkt), *MM),
    "no array": lambda t: ("paper_t",),
}


def array_with(tmp_path, old, new):
    pixel = bad_model(tmp_path, "actuators", "resonator1994", old, new)
    return bad_model(tmp_path, "arrays", "resonator64", '"resonator1994"', f'"{pixel.name}"')


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line_and_leaves_nothing(tmp_path, capsys, name):
    arguments = BAD[name](tmp_path)
    before = sorted(tmp_path.iterdir())
    code, _, err = run(capsys, "align", *arguments, "--out", tmp_path / "out")
    assert code == 2
    assert re.fullmatch(r"limitsurf: [^\n]+\n", err)
    assert "Traceback" not in err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("self-intersecting", ["part.wkt", "outline", "untangle"]),
        ("unknown unit", ["unit", "parsec2"]),
        ("negative friction", ["bad_actuators.toml", "friction", "at least 0"]),
        ("unknown key", ["bad_actuators.toml", "fric", "known here|is missing"]),
        ("array too small", ["resonator32", "larger array"]),
        ("too heavy", ["10 V", "16.7 V would lift it"]),
        ("no samples", ["samples", "whole number from 1 on"]),
        ("margin", ["min_margin", "33.67 deg is reachable"]),
        ("no density", ["areal_density"]),
        ("lines without unit", ["lines: ", "no unit", "0, 45, 90 deg"]),
        ("lines without commas", ["lines: ", "0 45 90 deg"]),
        ("lines no angles", ["lines: ", "45 mm", "rad"]),
        ("line twice", ["lines: ", "give each once"]),
        ("too few lines", ["never merge", "add a line"]),
        ("goal out of reach", ["goal: ", "90.00000, 135.00000 deg"]),
        ("goal without unit", ["goal: ", "no unit"]),
        ("margin of a model", ["min_margin", "19.31 deg is reachable"]),
        ("room for a push", ["larger array"]),
        ("neutral", ["cannot be aligned"]),
    ],
)
def test_errors_name_the_place_and_the_remedy(tmp_path, capsys, name, words):
    _, _, err = run(capsys, "align", *BAD[name](tmp_path))
    for word in words:
        assert re.search(word, err), err


def test_output_that_cannot_be_written_is_refused_first(tmp_path, capsys):
    taken = tmp_path / "file"
    taken.write_text("keep me")
    for out in (taken, taken / "below"):
        code, _, err = run(capsys, "align", "paper_t", *GOOD, "--out", out)
        assert code == 2
        assert "out: " in err
    assert taken.read_text() == "keep me"


def test_a_failed_report_leaves_old_results_alone(tmp_path, capsys, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    for name in FILES:
        (out / name).write_text("old")

    def fail(*arguments):
        raise RuntimeError("no page")

    monkeypatch.setattr("limitsurf.report.alignment.alignment_page", fail)
    with pytest.raises(RuntimeError, match="no page"):
        run(capsys, "align", "paper_t", *GOOD, "--out", out)
    assert [(out / name).read_text() for name in FILES] == ["old"] * 3
    assert list(tmp_path.iterdir()) == [out]


def test_models_are_listed(capsys):
    code, out, _ = run(capsys, "models")
    assert code == 0
    for name in ("nano_sim", "resonator64", "resonator1994", "longplan_L5"):
        assert name in out


def test_help_and_version(capsys):
    code, out, _ = run(capsys, "align", "--help")
    assert code == 0
    assert "--areal-density" in out
    code, out, _ = run(capsys, "--version")
    assert code == 0
    assert re.fullmatch(r"limitsurf \d+\.\d+\.\d+\n", out)
