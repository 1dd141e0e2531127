import math

import pytest

from limitsurf.errors import InputError
from limitsurf.units import parse_quantity, unit_scale


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("50 um", "m", 50e-6),
        ("80 g/m^2", "kg/m^2", 0.08),
        ("50 V", "V", 50.0),
        ("5 deg", "rad", math.radians(5)),
        (0.08, "kg/m^2", 0.08),
        ("0.3", "", 0.3),
        ("1 inch", "m", 0.0254),
    ],
)
def test_quantities(text, unit, value):
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("unit", "others"),
    [
        ("m", ["um", "mm", "inch"]),
        ("kg/m^2", ["g/m^2", "mg/mm^2"]),
        ("V", ["mV", "kV"]),
        ("N*s/m", ["uN*s/m"]),
        ("Pa", ["GPa", "N/mm^2"]),
        ("rad", ["deg"]),
    ],
)
def test_round_trips(unit, others):
    for value in (1.0, 1.14e-6, -0.3, 7.96e10):
        assert parse_quantity(f"{value!r} {unit}", unit) == value
        for other in others:
            there = parse_quantity(f"{value!r} {unit}", other)
            assert parse_quantity(f"{there!r} {other}", unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit", "problem"),
    [
        ("50 parsnip", "m", "unknown unit"),
        ("50", "m", "has no unit"),
        ("50 kg", "m", "is not in a unit of"),
        ("nan m", "m", "finite"),
        (float("inf"), "m", "finite"),
        ("", "m", "no quantity"),
        ("5 +* m", "m", "no quantity"),
        (True, "m", "no quantity"),
    ],
)
def test_bad_quantities_name_the_argument(text, unit, problem):
    with pytest.raises(InputError, match=problem) as caught:
        parse_quantity(text, unit, name="width")
    assert caught.value.argument == "width"


def test_unit_scale():
    assert unit_scale("mm") == pytest.approx(1e-3)
    assert unit_scale("1.2 mm") == pytest.approx(1.2e-3)
    with pytest.raises(InputError, match="unit"):
        unit_scale("kg")
    with pytest.raises(InputError, match="unknown unit"):
        unit_scale("parsnip")
