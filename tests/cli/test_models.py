"""``limitsurf models``: list, show, check, schema."""

import json
import tomllib

import jsonschema
import pytest

from limitsurf.cli.main import main
from limitsurf.cli.models import KINDS, entries, guess_kind, schemas
from limitsurf.modelfiles import find_model, list_models

SHIPPED = [(kind, name) for kind in KINDS for name in list_models(kind)]


def run(capsys, *arguments):
    code = main([str(argument) for argument in arguments])
    output = capsys.readouterr()
    return code, output.out, output.err


def test_list_names_every_model(capsys):
    for arguments in (("models",), ("models", "list")):
        code, out, _ = run(capsys, *arguments)
        assert code == 0
        assert all(name in out and f"{kind}:" in out for kind, name in SHIPPED)
    code, out, _ = run(capsys, "models", "list", "--kind", "resonators")
    assert code == 0
    assert "nano_sim" not in out


def test_show_gives_value_and_origin_of_every_number(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    code, out, _ = run(capsys, "models", "show", "resonator1994", "--kind", "resonators")
    assert code == 0
    for word in ("grid_width", "50 um", "1994 paper, section 5", "quality", "assumed", "79.6 GPa"):
        assert word in out
    code, out, _ = run(capsys, "models", "show", "resonator1994")
    assert "actuators/resonator1994" in out
    assert "resonators/resonator1994" in out
    code, out, _ = run(capsys, "models", "show", find_model("parts", "paper_t"))
    assert "outline.unit" in out


def test_check_accepts_all_shipped_models(capsys):
    code, out, err = run(capsys, "models", "check")
    assert (code, err) == (0, "")
    assert len(out.splitlines()) == len(SHIPPED)
    assert "ok  resonators/resonator1994: 19 numbers, 9 assumed" in out


def test_check_takes_names(capsys):
    code, out, _ = run(capsys, "models", "check", "Resonator1994", "paper_t")
    assert (code, out.count("ok  "), out.count("/resonator1994")) == (0, 3, 2)
    assert run(capsys, "models", "check", "paper_t", "--kind", "plans")[0] == 2


def test_check_names_file_field_and_problem(capsys, tmp_path):
    path = tmp_path / "mine.toml"
    text = find_model("resonators", "resonator1994").read_text()
    path.write_text(text.replace('value = "79.6 GPa"', 'value = "-79.6 GPa"'))
    code, out, err = run(capsys, "models", "check", path)
    assert (code, out) == (2, "")
    assert all(word in err for word in (str(path), "shear_modulus_tall", "greater than 0"))
    path.write_text(text.replace('value = "0 um"', 'value = "30 um"'))
    assert "rod_offset" in run(capsys, "models", "check", path)[2]
    path.write_text(text.replace('source = "silicon, CRC', 'note = "silicon, CRC'))
    assert "density" in run(capsys, "models", "check", path)[2]
    path.write_text(text.replace('assumed = "of a tip on a part"', 'assumed = " "'))
    assert "must say something" in run(capsys, "models", "check", path)[2]


@pytest.mark.parametrize(
    "arguments",
    [
        ("list", "--kind", "plans"),
        ("show", "resonator2094"),
        ("check", "no/such/file.toml"),
        ("check", "pyproject.toml"),
        ("schema", "plans"),
        ("bogus",),
    ],
)
def test_bad_input_is_one_line(capsys, arguments):
    code, out, err = run(capsys, "models", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)


@pytest.mark.parametrize(("kind", "name"), SHIPPED)
def test_kinds_are_guessed(kind, name):
    assert guess_kind(find_model(kind, name)) == kind


@pytest.mark.parametrize("kind", KINDS)
def test_shipped_models_satisfy_the_exported_schema(capsys, kind):
    code, out, _ = run(capsys, "models", "schema", kind)
    assert code == 0
    schema = json.loads(out)
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    for name in list_models(kind):
        table = tomllib.loads(find_model(kind, name).read_text())
        validator.validate(table)
        for key in (key for key, entry in table.items() if "value" in entry):
            for wrong in ({"value": table[key]["value"]}, 3.0, {**table[key], "colour": 1}):
                assert list(validator.iter_errors({**table, key: wrong})), key


def test_all_schemas_at_once(capsys):
    code, out, _ = run(capsys, "models", "schema")
    assert code == 0
    assert set(json.loads(out)) == set(KINDS) == set(schemas())


def test_entries_find_nested_numbers():
    table = {"outline": {"source": "me", "unit": {"value": "1 mm", "source": "you"}}, "name": "x"}
    assert [name for name, _ in entries(table)] == ["outline", "outline.unit"]
