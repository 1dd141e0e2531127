import tomllib

import pytest

from limitsurf.actuators.actuator_array import ArrayModel
from limitsurf.actuators.resonator_model import ResonatorModel
from limitsurf.actuators.resonator_pixel import PixelModel, load_pixel
from limitsurf.errors import ModelError
from limitsurf.geometry.outline_files import PartModel
from limitsurf.modelfiles import describe_models, find_model, list_models, load_model, models_folder

KINDS = {
    "parts": PartModel,
    "arrays": ArrayModel,
    "actuators": PixelModel,
    "resonators": ResonatorModel,
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_shipped_model_loads(kind):
    names = list_models(kind)
    assert names
    for name in names:
        model = load_model(find_model(kind, name), KINDS[kind])
        assert model.description == describe_models(kind)[name]


def numbers_without_origin(table, path=""):
    """Yield every number of a model file that has neither source nor assumed beside it."""
    for key, value in table.items():
        where = f"{path}.{key}"
        if isinstance(value, dict):
            if "value" in value or "vertices" in value:
                if not {"source", "assumed"} & set(value):
                    yield where
            else:
                yield from numbers_without_origin(value, where)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield where


def test_every_kind_of_model_has_a_schema():
    assert {p.name for p in models_folder().iterdir() if p.is_dir()} == set(KINDS)


def test_every_number_has_a_source_or_is_assumed():
    for path in models_folder().rglob("*.toml"):
        table = tomllib.loads(path.read_text())
        assert not list(numbers_without_origin(table)), path
    assert list(numbers_without_origin({"mu": 0.3})) == [".mu"]
    assert list(numbers_without_origin({"mu": {"value": 0.3}})) == [".mu"]


def test_names_ignore_case_and_dashes():
    assert find_model("parts", "Nano-SIM") == find_model("parts", "nano_sim")


def test_unknown_name_lists_the_known_ones():
    with pytest.raises(ModelError, match="nano_sim"):
        find_model("parts", "giga_sim")


@pytest.mark.parametrize(
    ("old", "new", "field", "problem"),
    [
        ("value = 0.3", "value = -0.3", "friction", "at least 0"),
        ('value = "200 um"', 'value = "200 parsnip"', "pixel_pitch", "unknown unit"),
        ('value = "200 um"', "value = 200", "pixel_pitch", "needs a unit"),
        ('value = "200 um"', 'value = "200 V"', "pixel_pitch", "not in a unit"),
        ("[friction]", "[fricton]", "friction", "is missing"),
        ("[friction]", "[colour]\nvalue = 1\n[friction]", "colour", "unknown key"),
        ("[friction]", "[friction]\nsoruce = 1", "friction", "unknown key"),
        ("value = 0.3\nassumed", "value = 0.3\nwhatever", "friction", "unknown key"),
        ('"+x", "+y"', '"+x", "+x"', "directions", "each direction once"),
        ('"+x", "+y"', '"+x", "up"', "directions", "'\\+x', '-x'"),
    ],
)
def test_a_bad_field_is_named(tmp_path, old, new, field, problem):
    text = find_model("actuators", "resonator1994").read_text()
    assert old in text
    path = tmp_path / "bad.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ModelError, match=problem) as caught:
        load_pixel(path)
    assert str(path) in str(caught.value)
    assert caught.value.field.startswith(field)


def test_broken_toml_and_unreadable_files(tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text("= 3")
    with pytest.raises(ModelError, match="no TOML"):
        load_pixel(broken)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ModelError, match="cannot be read"):
        load_pixel(binary)
