import json

import numpy as np
import pytest
import shapely

from limitsurf.errors import InputError, ModelError
from limitsurf.geometry.part import Part

L_SHAPE = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (0, 4)]


def svg(body, attributes='width="4mm" height="4mm" viewBox="0 0 4 4"'):
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def write(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text)
    return path


L_PATH = '<path d="M0 0 H3 V1 H1 V4 H0 Z"/>'


def test_svg_has_units_and_its_y_axis_turned_up(tmp_path):
    part = Part.from_file(write(tmp_path, "l.svg", svg(L_PATH)))
    assert part.area == pytest.approx(6e-6)
    expected = shapely.Polygon([(1e-3 * x, -1e-3 * y) for x, y in L_SHAPE])
    assert shapely.symmetric_difference(part.polygon, expected).area < 1e-15
    mirrored = Part(np.array(L_SHAPE) * 1e-3)
    assert part.unit_edges.mean() != pytest.approx(mirrored.unit_edges[:, 1].mean())


@pytest.mark.parametrize(
    ("attributes", "scale"),
    [
        ('width="40mm" height="40mm" viewBox="0 0 4 4"', 10e-3),
        ('width="1in" height="1in" viewBox="0 0 2 2"', 0.0127),
        ('width="4cm" height="8cm" viewBox="0 0 4 4"', 1e-2),
        ('width="96mm" height="96mm"', 0.0254 / 96),
    ],
)
def test_svg_scale(tmp_path, attributes, scale):
    part = Part.from_file(write(tmp_path, "l.svg", svg(L_PATH, attributes)))
    assert part.area == pytest.approx(6 * scale**2)


def test_svg_without_size_needs_a_unit(tmp_path):
    path = write(tmp_path, "l.svg", svg(L_PATH, 'width="400" height="400"'))
    with pytest.raises(ModelError, match="--unit mm"):
        Part.from_file(path)
    assert Part.from_file(path, unit="um").area == pytest.approx(6e-12)


def test_svg_curves_become_polygons_within_tolerance(tmp_path):
    path = write(tmp_path, "disk.svg", svg('<circle cx="2" cy="2" r="1.5"/>'))
    part = Part.from_file(path)
    assert part.area == pytest.approx(np.pi * 1.5e-3**2, rel=2e-3)
    assert part.circumradius == pytest.approx(1.5e-3, rel=1e-6)
    assert len(part.edges) < 200


def test_svg_holes_groups_and_transforms(tmp_path):
    body = (
        '<g transform="translate(1 0) scale(0.5)">'
        '<path d="M0 0 H4 V4 H0 Z M1 1 H2 V2 H1 Z"/></g>'
        '<path d="M0 0 L4 4" stroke="black"/>'
    )
    part = Part.from_file(write(tmp_path, "hole.svg", svg(body)))
    assert part.area == pytest.approx((4 - 0.25) * 1e-6)
    assert len(part.polygon.interiors) == 1


@pytest.mark.parametrize(
    ("body", "problem"),
    [
        ("", "empty"),
        ('<path d="M0 0 L4 4"/>', "no closed outline"),
        ('<path d="M0 0 L4 4 L4 0 L0 3 Z"/>', "no simple ring"),
    ],
)
def test_bad_drawings(tmp_path, body, problem):
    path = write(tmp_path, "bad.svg", svg(body))
    with pytest.raises(ModelError, match=problem) as caught:
        Part.from_file(path)
    assert str(path) in str(caught.value)


def test_svg_that_is_no_xml(tmp_path):
    with pytest.raises(ModelError, match="no XML"):
        Part.from_file(write(tmp_path, "bad.svg", "<svg"))


def test_wkt_and_geojson(tmp_path):
    polygon = shapely.Polygon(L_SHAPE)
    wkt = write(tmp_path, "l.wkt", polygon.wkt)
    geometry = json.loads(shapely.to_geojson(polygon))
    feature = {"type": "Feature", "properties": {}, "geometry": geometry}
    collection = {"type": "FeatureCollection", "features": [feature]}
    files = [wkt] + [
        write(tmp_path, f"{k}.geojson", json.dumps(shape))
        for k, shape in enumerate([geometry, feature, collection])
    ]
    for path in files:
        assert Part.from_file(path, unit="mm").area == pytest.approx(6e-6)
        with pytest.raises(ModelError, match="--unit"):
            Part.from_file(path)
        with pytest.raises(InputError, match="unknown unit"):
            Part.from_file(path, unit="parsnip")


TWO_PIECES = "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((2 0, 3 0, 3 1, 2 0)))"


def test_several_pieces_only_if_said(tmp_path):
    path = write(tmp_path, "two.wkt", TWO_PIECES)
    with pytest.raises(ModelError, match=r"outline: falls into 2 pieces; .*pieces=True") as caught:
        Part.from_file(path, unit="mm")
    assert str(path) in str(caught.value)
    assert Part.from_file(path, unit="mm", pieces=True).area == pytest.approx(1e-6)
    squares = write(tmp_path, "two.svg", svg('<path d="M0 0h1v1h-1zM3 0h1v1h-1z"/>'))
    with pytest.raises(ModelError, match="2 pieces"):
        Part.from_file(squares)
    one = write(tmp_path, "one.wkt", "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)))")
    assert Part.from_file(one, unit="mm").area == pytest.approx(0.5e-6)


def test_a_model_may_say_that_its_drawing_has_pieces(tmp_path):
    write(tmp_path, "two.wkt", TWO_PIECES)
    vertices = "vertices = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 4], [0, 4]]"
    assert vertices in PART_MODEL
    model = PART_MODEL.replace(vertices, 'file = "two.wkt"')
    path = write(tmp_path, "two.toml", model)
    with pytest.raises(ModelError, match="2 pieces"):
        Part.from_file(path)
    said = model.replace('file = "two.wkt"', 'file = "two.wkt"\npieces = true')
    path = write(tmp_path, "two.toml", said)
    assert shapely.get_num_geometries(Part.from_file(path).polygon) == 2


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("a.wkt", "POLYGON ((0 0, 1", "cannot be read"),
        ("a.wkt", "POLYGON EMPTY", "empty"),
        ("a.wkt", "LINESTRING (0 0, 1 1)", "not a polygon"),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 nan, 0 0))", "not finite|cannot be read"),
        ("a.wkt", "POLYGON ((0 0, 2 2, 2 0, 0 1, 0 0))", "Self-intersection"),
        ("a.geojson", "{}", "cannot be read"),
        ("a.dxf", "0", "unknown kind of file"),
    ],
)
def test_bad_files_are_named(tmp_path, name, text, problem):
    path = write(tmp_path, name, text)
    with pytest.raises(ModelError, match=problem) as caught:
        Part.from_file(path, unit="mm")
    assert str(path) in str(caught.value)


PART_MODEL = """
description = "L"
[outline]
unit = { value = "2 mm", assumed = "test" }
assumed = "test"
vertices = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 4], [0, 4]]
[areal_density]
value = "80 g/m^2"
source = "test"
"""


def test_part_models(tmp_path):
    part = Part.from_file(write(tmp_path, "l.toml", PART_MODEL))
    assert part.area == pytest.approx(24e-6)
    assert part.areal_density == pytest.approx(0.08)
    assert part.name == "l"
    heavier = Part.from_file(tmp_path / "l.toml", areal_density="1 kg/m^2")
    assert heavier.areal_density == 1.0
    with pytest.raises(ModelError, match="leave --unit out"):
        Part.from_file(tmp_path / "l.toml", unit="mm")


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ('"80 g/m^2"', '"-80 g/m^2"', "greater than 0"),
        ("vertices = [", "vertexes = [", "unknown key|exactly one of vertices"),
        ("[3, 1]", '[3, "a"]', "vertices"),
        ("[3, 1]", "[3, nan]", "not finite"),
        ('assumed = "test"\nvertices', "vertices", "exactly one of source"),
        ("vertices", 'file = "no.svg"\nvertices', "exactly one of vertices"),
    ],
)
def test_bad_part_models(tmp_path, old, new, problem):
    assert old in PART_MODEL
    path = write(tmp_path, "l.toml", PART_MODEL.replace(old, new, 1))
    with pytest.raises(ModelError, match=problem) as caught:
        Part.from_file(path)
    assert str(path) in str(caught.value)


def test_missing_file():
    with pytest.raises(ModelError, match="no such file or model"):
        Part.from_file("nowhere.svg")
