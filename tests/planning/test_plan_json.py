"""Plans as JSON come back bit for bit, and malformed ones say which field is wrong."""

import json
import re

import numpy as np
import pytest
import shapely

from limitsurf.errors import ModelError
from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import AlignmentPlan, plan_alignment
from tests.reference_cases import CASES, NAMES

BLOB = np.array(CASES[NAMES.index("blob_m3")]["vertices"])


def with_hole_and_island(points):
    outline = shapely.Polygon(points)
    size = np.sqrt(outline.area)
    hole = outline.representative_point().buffer(0.05 * size, quad_segs=2)
    island = shapely.affinity.translate(hole, 5.0 * size)
    return shapely.union(outline.difference(hole), island)


PARTS = {
    "blob": Part(BLOB, "80 g/m^2", name="blob"),
    "tiny and far": Part(1e-6 * BLOB + np.array([0.3, -7.1]), 0.1 + 0.2),
    "large": Part(1e5 * BLOB / 3.0),
    "hole and island": Part(with_hole_and_island(BLOB)),
    "one line": Part(np.array([(0, 0), (3, 0), (0, 4)]) / 7.0),
}


@pytest.mark.parametrize("name", PARTS)
def test_plans_come_back_bit_for_bit(name, tmp_path):
    part = PARTS[name]
    plan = plan_alignment(part)
    text = plan.to_json()
    path = tmp_path / "plan.json"
    path.write_text(text, encoding="utf-8")
    for again in (AlignmentPlan.from_json(text), AlignmentPlan.from_json(path)):
        assert again.to_json() == text
        for field in ("lines", "margins", "final", "period", "model", "mobility_ratio"):
            assert np.array_equal(getattr(again, field), getattr(plan, field))
        for field in ("breaks", "ends", "images", "period", "modulus"):
            assert np.array_equal(getattr(again.squeeze, field), getattr(plan.squeeze, field))
        assert np.array_equal(again.part.edges, part.edges)
        assert (again.part.name, again.part.areal_density) == (part.name, part.areal_density)
        assert again.part.polygon.equals_exact(part.polygon, 0.0)


def test_infinite_margins_are_null():
    record = json.loads(plan_alignment(PARTS["blob"]).to_json())
    assert record["margins"][0] is None
    assert all(isinstance(margin, float) for margin in record["margins"][1:])
    assert record["unit"] == "rad"


BAD = {
    "format": (None, "limitsurf plan 7", 3),
    "unit": ("deg",),
    "lines": (None, 3, [], ["a"], [0.0, None], [float("nan")], [True]),
    "margins": (None, [None], [None, "wide"]),
    "final": (None, "up", [0.0]),
    "period": (None, 0.0, -1.0),
    "model": (None, "teleport", 3),
    "mobility_ratio": (None, -1.0),
    "squeeze": (None, 3, []),
    "squeeze.breaks": (None, [0.1], {}),
    "squeeze.images": ("?",),
    "squeeze.modulus": (None, -3.0),
    "part": (None, "T"),
    "part.outline": (None, {}, {"type": "Polygon"}, {"type": "Point", "coordinates": [0, 0]},
                     {"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [2, 2], [0, 0]]]},
                     {"type": "Polygon", "coordinates": "none"}),
    "part.areal_density": ("heavy", -1.0),
    "part.name": (None, 5),
}  # fmt: skip


@pytest.mark.parametrize("field", BAD)
def test_the_error_names_the_field(field):
    good = plan_alignment(PARTS["blob"]).to_json()
    *outer, inner = field.split(".")
    named = "squeeze." if field == "squeeze.breaks" else field  # compared with the others
    for bad in (*BAD[field], "missing"):
        record = json.loads(good)
        place = record[outer[0]] if outer else record
        place[inner] = bad
        if bad == "missing":
            del place[inner]
        with pytest.raises(ModelError, match=re.escape(named)):
            AlignmentPlan.from_json(json.dumps(record))


def test_what_is_no_plan_at_all(tmp_path):
    for text in ("", "[]", "3", "{", '{"lines": 3}'):
        with pytest.raises(ModelError, match="alignment plan"):
            AlignmentPlan.from_json(text)
    with pytest.raises(ModelError, match="nowhere"):
        AlignmentPlan.from_json(tmp_path / "nowhere.json")
    with pytest.raises(ModelError, match=r"format: is 1, .*plan again"):
        AlignmentPlan.from_json('{"format": "limitsurf alignment plan 1"}')
