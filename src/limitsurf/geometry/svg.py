"""Outlines from SVG drawings, in metres, with the y axis turned upwards."""

from __future__ import annotations

import io
import re
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import shapely
from numpy.typing import NDArray

from limitsurf.errors import InputError
from limitsurf.tolerances import FLATTEN
from limitsurf.units import parse_quantity

__all__ = ["read_svg"]

Array = NDArray[np.float64]

_LENGTH = re.compile(r"\s*([-+0-9.eE]+)\s*(mm|cm|in|pt|pc|Q)\s*")
_UNITS = {"mm": "mm", "cm": "cm", "in": "inch", "pt": "inch/72", "pc": "inch/6", "Q": "mm/4"}


def read_svg(text: str, unit: float | None = None) -> shapely.Geometry:
    """Return the filled area of a drawing.

    Parameters
    ----------
    text : str
        The SVG document. Every closed path or shape counts; a path with several rings is filled
        by the even-odd rule, so rings inside rings are holes.
    unit : float, optional
        Length of one user unit [m]. Without it the document needs a physical size, such as
        ``width="4.8mm"``.

    Raises
    ------
    InputError
        No XML, no physical size, no closed outline, or a ring that crosses itself.
    """
    try:
        root = ET.fromstring(text)
    except ET.ParseError as error:
        raise InputError("svg", f"is no XML: {error}", remedy="save it again as SVG") from error
    scale = _user_unit(root) if unit is None else unit
    for name in ("width", "height", "viewBox", "preserveAspectRatio"):
        root.attrib.pop(name, None)  # leaves user units as they are
    shapes = [_filled(element) for element in _closed_elements(root)]
    area = shapely.union_all([shape for shape in shapes if not shapely.is_empty(shape)])
    if shapely.is_empty(area):
        raise InputError("outline", "no closed outline with an area", remedy="draw a closed path")
    return shapely.transform(area, lambda points: points * np.array([scale, -scale]))


def _user_unit(root: ET.Element) -> float:
    """Return the length of one user unit [m] from the size and viewBox of the document."""
    size = [_LENGTH.fullmatch(root.get(name, "")) for name in ("width", "height")]
    if size[0] is None or size[1] is None:
        raise InputError(
            "width, height",
            "the drawing has no physical size",
            remedy='give them a unit (width="4.8mm") or add --unit mm',
        )
    metres = [
        parse_quantity(f"{match[1]} {_UNITS[match[2]]}", "m", name="width, height")
        for match in size
        if match is not None
    ]
    box = [float(x) for x in re.split(r"[\s,]+", root.get("viewBox", "").strip()) if x]
    if not box:
        return 0.0254 / 96  # without a viewBox a user unit is a CSS pixel
    if len(box) != 4 or min(box[2:]) <= 0.0:
        raise InputError("viewBox", "must be four numbers, width and height positive", value=box)
    scales = [length / extent for length, extent in zip(metres, box[2:], strict=True)]
    if root.get("preserveAspectRatio", "").strip() == "none" and not np.isclose(
        scales[0], scales[1]
    ):
        raise InputError("viewBox", "stretches the drawing", remedy="use one scale for x and y")
    return min(scales)


def _closed_elements(root: ET.Element) -> list[list[Array]]:
    """Return, for every drawn element, its closed rings."""
    import svgelements

    document = svgelements.SVG.parse(io.StringIO(ET.tostring(root, encoding="unicode")))
    paths = [
        svgelements.Path(element)
        for element in document.elements()
        if isinstance(element, svgelements.Shape)
    ]
    boxes = [box for path in paths if (box := path.bbox()) is not None]
    if not boxes:
        raise InputError("outline", "the drawing is empty", remedy="draw a closed path")
    corners = np.array(boxes)
    diagonal = np.hypot(
        corners[:, 2].max() - corners[:, 0].min(), corners[:, 3].max() - corners[:, 1].min()
    )
    rings = [
        [_flatten(subpath, FLATTEN * diagonal) for subpath in path.as_subpaths()] for path in paths
    ]
    return [[r for r in element if _closes(r, FLATTEN * diagonal)] for element in rings]


def _closes(ring: Array, tolerance: float) -> bool:
    return len(ring) > 3 and bool(np.hypot(*(ring[0] - ring[-1])) <= tolerance)


def _flatten(subpath: Any, tolerance: float) -> Array:
    """Return the points of a subpath, curves replaced by chords that stay within `tolerance`."""
    points: list[Array] = []
    for segment in subpath:
        if segment.end is None:
            continue
        if type(segment).__name__ in ("Move", "Line", "Close") or segment.start is None:
            points.append(np.array([[segment.end.x, segment.end.y]]))
        else:
            points.append(_chords(segment, tolerance))
    return np.vstack(points) if points else np.empty((0, 2))


def _chords(segment: Any, tolerance: float) -> Array:
    """Return points on a curve, twice as many until no chord is farther off than `tolerance`."""
    n = 2
    while True:
        both = np.array(
            [[p.x, p.y] for p in (segment.point(k / (2 * n)) for k in range(2 * n + 1))]
        )
        ends, middles = both[::2], both[1::2]
        off = np.hypot(*(middles - 0.5 * (ends[1:] + ends[:-1])).T)
        if off.max() <= tolerance or n >= 4096:
            tail: Array = ends[1:]
            return tail
        n *= 2


def _filled(rings: list[Array]) -> shapely.Geometry:
    """Return the even-odd area of the rings of one element."""
    area = shapely.Polygon()
    for ring in rings:
        polygon = shapely.Polygon(ring)
        if not shapely.is_valid(polygon):
            raise InputError(
                "outline",
                f"a path is no simple ring: {shapely.is_valid_reason(polygon)}",
                remedy="untangle it",
            )
        area = shapely.symmetric_difference(area, polygon)
    return area
