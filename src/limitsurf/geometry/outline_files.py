"""Read part outlines: SVG, WKT, GeoJSON, and part models in TOML."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import shapely
from pydantic import model_validator
from shapely.errors import ShapelyError

from limitsurf.errors import InputError, ModelError
from limitsurf.geometry.outlines import as_polygon
from limitsurf.geometry.svg import read_svg
from limitsurf.modelfiles import Model, Sourced, find_model, load_model, number
from limitsurf.units import unit_scale

__all__ = ["OutlineFile", "read_part_file"]


@dataclass(frozen=True)
class OutlineFile:
    """What a part file holds: a polygon [m], an areal density [kg/m^2] or None, and a name."""

    polygon: shapely.Geometry
    areal_density: float | None
    name: str


class OutlineModel(Model):
    """Table ``[outline]`` of a part model: vertices or a drawing, and the length of one unit."""

    unit: Annotated[Sourced, number("m", above=0.0)]
    source: str | None = None
    assumed: str | None = None
    vertices: list[tuple[float, float]] | None = None
    file: str | None = None
    pieces: bool = False

    @model_validator(mode="after")
    def _one_of(self) -> OutlineModel:
        if (self.vertices is None) == (self.file is None):
            raise ValueError("needs exactly one of vertices, file")
        if (self.source is None) == (self.assumed is None):
            raise ValueError("needs exactly one of source, assumed")
        return self


class PartModel(Model):
    """Schema of a part model file."""

    description: str
    outline: OutlineModel
    areal_density: Annotated[Sourced, number("kg/m^2", above=0.0)] | None = None


def read_part_file(
    name_or_path: str | Path, unit: str | None = None, *, pieces: bool = False
) -> OutlineFile:
    """Read a drawing by its suffix, or a part model by path or name.

    A drawing that falls into several pieces is refused unless `pieces`, or the model, allows it.

    Raises
    ------
    ModelError
        Names the file, the field and what to do.
    """
    path = find_model("parts", name_or_path)
    scale = None if unit is None else unit_scale(unit)
    try:
        if path.suffix.lower() == ".toml":
            if unit is not None:
                raise InputError("unit", "a part model has its own", remedy="leave --unit out")
            return _read_model(path, pieces)
        return OutlineFile(_read_drawing(path, scale, pieces), None, path.stem)
    except ModelError:
        raise
    except InputError as error:
        raise ModelError(
            path, error.argument, error.problem, value=error.value, remedy=error.remedy
        ) from error


def _read_model(path: Path, pieces: bool) -> OutlineFile:
    model = load_model(path, PartModel)
    scale = model.outline.unit.value
    if model.outline.file is not None:
        pieces = pieces or model.outline.pieces
        polygon = _read_drawing(path.parent / model.outline.file, scale, pieces)
    else:
        polygon = _scaled(as_polygon(model.outline.vertices or [], name="outline.vertices"), scale)
    density = None if model.areal_density is None else model.areal_density.value
    return OutlineFile(polygon, density, path.stem)


def _read_drawing(path: Path, scale: float | None, pieces: bool) -> shapely.Geometry:
    shape = _read_shape(path, scale)
    number = shapely.get_num_geometries(shape)
    if number > 1 and not pieces:
        raise InputError(
            "outline",
            f"falls into {number} pieces",
            remedy="join them, or say pieces=True if they are rigidly connected",
        )
    return shape


def _read_shape(path: Path, scale: float | None) -> shapely.Geometry:
    text = _read_text(path)
    suffix = path.suffix.lower()
    if suffix == ".svg":
        return as_polygon(read_svg(text, scale))
    readers = {".wkt": shapely.from_wkt, ".geojson": shapely.from_geojson}
    readers[".json"] = shapely.from_geojson
    if suffix not in readers:
        raise InputError(
            "", f"unknown kind of file {suffix!r}", remedy="use .svg, .wkt, .geojson or .toml"
        )
    if scale is None:
        raise InputError("unit", f"{suffix} has no units", remedy="add --unit, such as --unit mm")
    try:
        with np.errstate(invalid="ignore"):  # NaN in a file: as_polygon says what to do
            shape = readers[suffix](text)
    except (ShapelyError, ValueError) as error:
        raise InputError("outline", f"cannot be read: {error}", remedy="check the file") from error
    if shape.geom_type == "GeometryCollection":
        parts = shapely.get_parts(shape)
        shape = parts[0] if len(parts) == 1 else shapely.union_all(parts)
    return _scaled(as_polygon(shape), scale)


def _read_text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ModelError(path, "", f"cannot be read: {error}", remedy="check the path") from error


def _scaled(shape: shapely.Geometry, scale: float) -> shapely.Geometry:
    return shapely.transform(shape, lambda points: points * scale)
